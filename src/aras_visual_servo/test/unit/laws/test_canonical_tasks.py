"""Published behaviour of the laws on the canonical tasks, on a camera that moves exactly as it is told.

Tasks: turn about the optical axis up to half a turn, pure retreat, tilt of the target's plane, general motion (N. Gans,
S. Hutchinson, P. Corke, "Performance tests for visual servo control systems, with application to partitioned approaches
to visual servo control", IJRR 22(10-11), 2003). What each law does: F. Chaumette, "Potential problems of stability
and convergence in image-based and position-based visual servoing", 1998; F. Chaumette and S. Hutchinson, "Visual servo
control, part I", IEEE RAM 13(4), 2006, section "A geometrical interpretation of IBVS"; E. Malis, F. Chaumette,
S. Boudet, IEEE T-RA 15(2), 1999; E. Malis, ICRA 2004 (mean of two matrices).
"""

import numpy as np
import pytest
from views import exponential, look_at, plane_of, tilted_pose, view

from aras_visual_servo import DegenerateFeature, FeatureSet, Reference
from aras_visual_servo.laws.base import LawSetup, make_law
from aras_visual_servo.spatial import rotation_vector

DT_S = 1.0 / 30.0
GAIN_PER_S = 2.0
Z_STAR_M = 0.5
ROUNDING = 1e-9
#: Of a twist held for DT_S while the camera turns: second order, lambda dt / 2 of each step's turn, summed up.
HELD = 0.04
SQUARE = np.array([[-0.08, -0.08], [0.08, -0.08], [0.08, 0.08], [-0.08, 0.08]])
POSE, HYBRID = ("tx", "ty", "tz", "rx", "ry", "rz"), ("xr", "yr", "zr", "rx", "ry", "rz")
GOAL = np.diag([1.0, -1.0, -1.0, 1.0])
GOAL[2, 3] = Z_STAR_M
LAWS = {"current": ("ibvs", ("points4",), {"interaction": "current"}),
        "desired": ("ibvs", ("points4",), {"interaction": "desired"}),
        "mean": ("ibvs", ("points4",), {"interaction": "mean"}),
        "pbvs": ("pbvs", POSE, {"pose_from": "points"}),
        "hybrid": ("hybrid", HYBRID, {"pose_from": "points"})}


def run(kind, displacement, seconds=6.0, dt_s=DT_S, goal=GOAL, outline=SQUARE):
    """Poses (n, 4, 4) of the camera in that of the goal, from exp(displacement), and the last `Answer`."""
    name, features, more = LAWS[kind]
    taught, count = view(goal, outline), len(FeatureSet(features))
    law = make_law(name, [GAIN_PER_S] * count, LawSetup(features, **more))
    law.reset(Reference(FeatureSet(features).values(taught), view=taught.features, plane_C=plane_of(goal)))
    X, path, answer = goal @ exponential(displacement, 1.0), [], None
    for _ in range(round(seconds / dt_s)):
        path.append(np.linalg.inv(goal) @ X)
        try:
            answer = law.step(look_at(view(X, outline).features, dt_s, plane_of(X), path[-1]))
            X = X @ exponential(answer.twist, dt_s)
        except (DegenerateFeature, AssertionError):  # matrix singular, or target behind the camera
            break
    return np.array(path), answer


def turn(degrees):
    return [0.0, 0.0, 0.0, 0.0, 0.0, np.radians(degrees)]


def arrives(path):
    return np.abs(path[-1] - np.eye(4)).max() < 1e-4  # exp(-2 * 6) of the start is 6e-6


# --- turn about the optical axis ------------------------------------------------------------------------------------


def test_points_with_the_current_matrix_retreat_to_infinity_at_half_a_turn():
    """Chaumette's conundrum: each point heads for its place on a straight line through the middle."""
    path, _ = run("current", turn(180.0))
    assert path[-1][2, 3] < -20.0 * Z_STAR_M
    np.testing.assert_allclose(path[:, 1, 0], 0.0, atol=ROUNDING)  # and never turn


@pytest.mark.parametrize("kind", ["mean", "pbvs", "hybrid"])
def test_these_turn_about_the_axis_and_nothing_else(kind):
    path, _ = run(kind, turn(120.0))
    assert arrives(path)
    np.testing.assert_allclose(path[:, :3, 3], 0.0, atol=1e-6)
    np.testing.assert_allclose(path[:, 2, :3], np.outer(np.ones(len(path)), [0.0, 0.0, 1.0]), atol=1e-6)


@pytest.mark.parametrize("kind", ["pbvs", "hybrid"])
def test_half_a_turn_is_no_trouble_where_rotation_is_measured(kind):
    path, _ = run(kind, turn(180.0))
    assert arrives(path)
    np.testing.assert_allclose(path[:, :3, 3], 0.0, atol=1e-6)


@pytest.mark.parametrize("degrees", [45.0, 90.0, 135.0])
def test_the_advance_with_the_matrix_of_the_goal_has_a_closed_form(degrees):
    """Of a square about the optical axis: Z / Z* = 1 - (a - b) tan(b / 2), a the whole turn, b what is left of it.

    The twist is v_z = -gain Z* (Z* / Z cos b - 1), w_z = gain Z* / Z sin b, the other four are zero. With u = Z / Z*,
    du / db = (u - cos b) / sin b, which this solves. Its least value is how near the camera comes.
    """
    dt_s = DT_S / 16.0
    held = 2.5 * GAIN_PER_S * dt_s  # what holding a twist adds, measured 1.1 to 2.1 times gain and period
    path, _ = run("desired", turn(degrees), 8.0, dt_s)
    left, advance = np.array([rotation_vector(X[:3, :3])[2] for X in path]), path[:, 2, 3] / Z_STAR_M
    np.testing.assert_allclose(advance, (np.radians(degrees) - left) * np.tan(left / 2.0), atol=held)
    b = np.linspace(0.0, np.radians(degrees), 100001)
    nearest = Z_STAR_M * ((b[-1] - b) * np.tan(b / 2.0)).max()
    assert path[:, 2, 3].max() == pytest.approx(nearest, rel=held)
    assert 1e3 * nearest == pytest.approx({45.0: 39.06, 90.0: 163.19, 135.0: 402.85}[degrees], abs=0.01)


@pytest.mark.parametrize("degrees", [45.0, 90.0, 135.0])
def test_the_retreat_with_the_matrix_of_each_view_has_a_closed_form(degrees):
    """Z / Z* = cos(b - a / 2) / cos(a / 2), a the whole turn, b what is left of it: points go straight in the image."""
    path, _ = run("current", turn(degrees), 8.0, DT_S / 16.0)
    left, half = np.array([rotation_vector(X[:3, :3])[2] for X in path]), np.radians(degrees) / 2.0
    height = 1.0 - path[:, 2, 3] / Z_STAR_M
    np.testing.assert_allclose(height, np.cos(left - half) / np.cos(half), rtol=HELD / 4.0)
    assert 1e3 * Z_STAR_M * (1.0 / np.cos(half) - 1.0) == pytest.approx(
        {45.0: 41.20, 90.0: 207.11, 135.0: 806.56}[degrees], abs=0.01)


# --- pure retreat, tilt, general motion ------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", LAWS)
def test_pure_retreat_goes_straight_in_and_does_not_turn(kind):
    path, _ = run(kind, [0.0, 0.0, -0.5, 0.0, 0.0, 0.0], 12.0)
    assert arrives(path)
    np.testing.assert_allclose(path[:, :2, 3], 0.0, atol=1e-6)
    np.testing.assert_allclose(path[:, :3, :3], np.broadcast_to(np.eye(3), (len(path), 3, 3)), atol=1e-6)


@pytest.mark.parametrize("kind", LAWS)
def test_tilt_of_the_plane_is_undone_from_thirty_degrees(kind):
    there = exponential([0.0, 0.0, Z_STAR_M, 0.0, 0.0, 0.0], 1.0)  # about the target's middle
    start = there @ exponential([0.0, 0.0, 0.0, 0.35, -0.4, 0.0], 1.0) @ np.linalg.inv(there)
    assert arrives(run(kind, logarithm(start), 12.0)[0])


GENERAL = [0.12, -0.08, -0.15, 0.15, -0.2, 0.6]


@pytest.mark.parametrize("kind", LAWS)
def test_general_motion_arrives(kind):
    assert arrives(run(kind, GENERAL, 12.0)[0])


def logarithm(X):
    """Twist (6,) whose exponential over one second is X."""
    w = rotation_vector(X[:3, :3])
    columns = np.array([exponential([*axis, *w], 1.0)[:3, 3] for axis in np.eye(3)]).T
    return [*np.linalg.solve(columns, X[:3, 3]), *w]


def off_line(points):
    """Largest distance of points (n, k) from the line from the first to the last, by its length."""
    way = points[-1] - points[0]
    along = (points - points[0]) @ way / (way @ way)
    return np.linalg.norm(points - points[0] - np.outer(along, way), axis=1).max() / np.linalg.norm(way)


def image_of_middle(path):
    """Image (n, 2) of the target's middle."""
    middle = np.array([np.linalg.inv(X) @ [0.0, 0.0, Z_STAR_M, 1.0] for X in path])
    return middle[:, :2] / middle[:, 2:3]


def test_camera_is_straight_with_pbvs_and_the_reference_point_with_hybrid():
    """PBVS: the camera on a line in space, its image is not; 2 1/2-D the other way round."""
    for kind, straight, curved in (("pbvs", lambda path: path[:, :3, 3], image_of_middle),
                                   ("hybrid", image_of_middle, lambda path: path[:, :3, 3])):
        path, _ = run(kind, GENERAL)
        assert off_line(straight(path)) < 0.01 < 0.03 < off_line(curved(path)), kind


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_twist_of_hybrid_moves_each_feature_at_its_rate(seed):
    """Central differences at tilted poses; gains that differ, so that no two rows can stand in for each other."""
    goal, gains = tilted_pose(seed), np.array([1.0, 2.0, 3.0, 1.5, 2.5, 0.5])
    taught, start = view(goal), goal @ exponential(GENERAL, 1.0)
    law = make_law("hybrid", gains, LawSetup(HYBRID, pose_from="points"))
    law.reset(Reference(FeatureSet(HYBRID).values(taught), view=taught.features, plane_C=plane_of(goal)))

    def features(X):
        answer = law.step(look_at(view(X).features, X_CgC=np.linalg.inv(goal) @ X))
        return np.array(answer.s), np.array(answer.e), answer.twist

    _, e, twist = features(start)
    h = 1e-5
    slope = (features(start @ exponential(twist, h))[0] - features(start @ exponential(twist, -h))[0]) / (2.0 * h)
    wanted = -gains * e
    np.testing.assert_allclose(slope[:3], wanted[:3], atol=1e-6)  # h^2, and rounding over h
    # theta u: the rates of the three parts differ, so only its own axis says -lambda of it (T30)
    np.testing.assert_allclose(twist[3:], wanted[3:], atol=ROUNDING)


def test_each_of_the_six_of_hybrid_decays_at_its_gain():
    path, last = run("hybrid", GENERAL, 1.0)
    first = [*(image_of_middle(path)[0]), np.log((np.linalg.inv(path[0]) @ [0, 0, Z_STAR_M, 1])[2] / Z_STAR_M)]
    angle = rotation_vector(path[0][:3, :3])
    np.testing.assert_allclose(last.e, np.exp(-GAIN_PER_S * 29 * DT_S) * np.array([*first, *angle]), atol=HELD * 0.2)
