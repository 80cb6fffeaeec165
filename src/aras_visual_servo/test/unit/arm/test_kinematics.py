"""Kinematics of an arm that carries the camera, and of one that carries the target."""

import re
import subprocess
import sys

import numpy as np
import pytest
from toy_plant import arm, GOAL, URDF

from aras_visual_servo import (
    Kinematics, kinematics_of, load_scenario, ModelError, NotFiniteError, ParameterError, ShapeError, TwistInverse,
    velocity_factor)
from aras_visual_servo.arm import reach as reaching
from aras_visual_servo.spatial import adjoint, inverse, pose_from_rpy

STEP = 1e-6  # of central differences [m, rad]
#: Truncation STEP^2 / 6 = 2e-13, rounding eps / STEP = 2e-10 on lengths near 1.6 m, times ten.
DIFFERENCE = 4e-9
ROUNDING = 1e-12  # of a product of nine transforms with entries near 1
SEEDS = range(5)


def random_joints(kinematics, seed):
    return np.random.default_rng(seed).uniform(-1.5, 1.5, len(kinematics.joint_names))


def test_limits_come_from_the_urdf_and_continuous_joints_have_none():
    kinematics = arm()
    np.testing.assert_array_equal(kinematics.lower, [-2.0943] * 4 + [-np.inf, -1.5])
    np.testing.assert_array_equal(kinematics.upper, [2.0943] * 4 + [np.inf, 1.5])
    np.testing.assert_array_equal(kinematics.velocity, [5.0] * 6)


def test_camera_pose_at_the_published_goal():
    kinematics = arm()
    X = kinematics.pose(kinematics.vector(GOAL))
    x = -0.25 * np.sin(0.09) - 0.16 * np.sin(0.045)
    z = 1.6263 - 0.02888 - 0.168 - 0.132 - 0.25 * np.cos(0.09) - 0.16 * np.cos(0.045) - 0.0718 - 0.0334
    np.testing.assert_allclose(X[:3, 3], [x, 0.05, z], atol=ROUNDING)
    np.testing.assert_allclose(X[:3, :3], np.diag([1.0, -1.0, -1.0]), atol=ROUNDING)


@pytest.mark.parametrize("seed", SEEDS)
def test_jacobian_is_the_derivative_of_the_pose_in_the_camera_frame(seed):
    kinematics = arm()
    q = random_joints(kinematics, seed)
    R = kinematics.pose(q)[:3, :3]
    J = kinematics.jacobian(q)
    for i, step in enumerate(np.eye(6) * STEP):
        dX = (kinematics.pose(q + step) - kinematics.pose(q - step)) / (2.0 * STEP)
        spin = R.T @ dX[:3, :3]
        twist = np.r_[R.T @ dX[:3, 3], spin[2, 1], spin[0, 2], spin[1, 0]]
        np.testing.assert_allclose(J[:, i], twist, atol=DIFFERENCE)


@pytest.mark.parametrize("seed", SEEDS)
def test_determinant_of_the_jacobian_is_the_known_product(seed):
    kinematics = arm()
    q = random_joints(kinematics, seed)
    q1, q2, q3, q5 = q[:4]
    expected = 0.25 * 0.16 * np.sin(q3) * np.cos(q1) * np.sin(q2 + q3 + q5)
    found = np.linalg.det(kinematics.jacobian(q))
    assert abs(found) == pytest.approx(abs(expected), abs=ROUNDING)


@pytest.mark.parametrize("speed", [0.2, 20.0])
@pytest.mark.parametrize("seed", SEEDS)
def test_held_velocities_are_slowed_and_then_corrected_bit_for_bit(seed, speed):
    kinematics = arm()
    q, wanted = random_joints(kinematics, seed), speed * random_joints(kinematics, seed + 100)
    J = kinematics.jacobian(q)
    inverse = TwistInverse((1.0,) * 6, 0.05, 0.02, 0.02)(J)
    found, factor = kinematics.held(inverse, J, q, wanted, 0.1, 0.25)
    assert factor == velocity_factor(wanted, kinematics.velocity) and (factor < 1.0) == (speed > 1.0)
    slowed = wanted * factor if factor < 1.0 else wanted
    added = inverse.turning(J, kinematics.jacobian(kinematics.moved(q, slowed, 0.05)), slowed, 0.25)
    np.testing.assert_array_equal(found, slowed + added)
    assert np.abs(added).max() > 1e-3
    with pytest.raises(ShapeError, match="q_dot: 5 values, expected 6"):
        kinematics.held(inverse, J, q, wanted[:5], 0.1, 0.25)


def test_vector_takes_joints_by_name_in_any_order_and_ignores_others():
    kinematics = arm()
    q = kinematics.vector({"gripper": 7.0, "gantry": 6.0, "J6": 5.0, "J5": 4.0, "J3": 3.0, "J2": 2.0, "J1": 1.0})
    np.testing.assert_array_equal(q, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0])


def test_vector_names_the_missing_joint():
    with pytest.raises(ParameterError, match=r"missing \['J5'\]"):
        arm().vector({"gantry": 6.0, "J6": 5.0, "J3": 3.0, "J2": 2.0, "J1": 1.0})


def test_wrong_number_of_joints_is_a_shape_error():
    with pytest.raises(ShapeError, match="5 values, expected 6"):
        arm().pose(np.zeros(5))


@pytest.mark.parametrize("call", ["pose", "jacobian"])
def test_joint_position_that_is_not_finite_is_refused(call):
    with pytest.raises(NotFiniteError):
        getattr(arm(), call)(np.array([0, 0, np.nan, 0, 0, 0]))


@pytest.mark.parametrize(
    "old, new, cause",
    [
        ("</robot>", "", "URDF"),
        ('<child link="link3"/>', '<child link="link9"/>', "URDF"),
        ('type="continuous"', 'type="floating"', "joint 'J6': type"),
        ('lower="-1.5" upper="1.5"', 'lower="1.5" upper="-1.5"', "joint 'gantry': limits"),
    ],
)
def test_bad_model_is_refused_with_its_cause(old, new, cause):
    assert old in URDF
    with pytest.raises(ModelError, match=cause):
        Kinematics(URDF.replace(old, new, 1), "world", "camera_optical_frame")


@pytest.mark.parametrize("base, tip, cause", [
    ("world", "tool", "no link 'tool'.*camera_optical_frame"), ("camera_optical_frame", "world", "not below"),
    ("slider", "link0", "no moving joint")])
def test_a_chain_that_cannot_be_is_refused_with_its_cause(base, tip, cause):
    with pytest.raises(ModelError, match=cause):
        Kinematics(URDF, base, tip)


def test_vector_is_not_shared_with_the_caller():
    kinematics, q = arm(), np.zeros(6)
    vector = kinematics.vector(q)
    q[0] = 1.0
    assert vector[0] == 0.0


#: Of ln w and of image points: the same, with inverse depths and inverse singular values up to about 20.
SMALLER_DIFFERENCE = 1e-7
ARMS, EYE_TO_HAND_SEEDS = ("experiment_1", "six_dof_rectangle"), range(4)
SIX_ROWS = list(range(6))


def urdf_and_robot(arm, **more):
    scenario = load_scenario(arm)
    return scenario.urdf_xml(), {**scenario.robot, "tip_link": "stand_optical_frame", "target_link": "link6", **more}


def chain(arm, **more):
    return kinematics_of(*urdf_and_robot(arm, **more))


def posture(kinematics, seed):
    return np.random.default_rng(seed).uniform(-1.2, 1.2, len(kinematics.joint_names))


@pytest.mark.parametrize("arm", ARMS)
@pytest.mark.parametrize("seed", EYE_TO_HAND_SEEDS)
def test_jacobian_is_the_derivative_of_the_camera_s_pose_in_the_hand(arm, seed):
    kinematics = chain(arm)
    q = posture(kinematics, seed)
    R, J = kinematics.pose(q)[:3, :3], kinematics.jacobian(q)
    for i, step in enumerate(np.eye(len(q)) * STEP):
        dX = (kinematics.pose(q + step) - kinematics.pose(q - step)) / (2.0 * STEP)
        spin = R.T @ dX[:3, :3]
        twist = np.r_[R.T @ dX[:3, 3], spin[2, 1], spin[0, 2], spin[1, 0]]
        np.testing.assert_allclose(J[:, i], twist, atol=DIFFERENCE)


@pytest.mark.parametrize("arm", ARMS)
@pytest.mark.parametrize("seed", EYE_TO_HAND_SEEDS)
def test_jacobian_is_that_of_the_hand_seen_from_the_camera_with_a_minus(arm, seed):
    kinematics, (urdf, robot) = chain(arm), urdf_and_robot(arm)
    hand = kinematics_of(urdf, {**robot, "tip_link": "link6", "target_link": None})
    q = posture(kinematics, seed)
    X_CE = inverse(kinematics.pose(q))
    np.testing.assert_allclose(kinematics.jacobian(q), -adjoint(X_CE) @ hand.jacobian(q), atol=10.0 * ROUNDING)
    np.testing.assert_allclose(hand.pose(q) @ kinematics.pose(q), kinematics.camera(q), atol=ROUNDING)


@pytest.mark.parametrize("arm", ARMS)
@pytest.mark.parametrize("seed", EYE_TO_HAND_SEEDS)
def test_gradient_of_the_manipulability_is_its_derivative(arm, seed):
    kinematics = chain(arm)
    q = posture(kinematics, seed)
    w, gradient = kinematics.manipulability(q, 0.05, SIX_ROWS)
    assert w > 0.0
    for i, step in enumerate(np.eye(len(q)) * STEP):
        after, before = (kinematics.manipulability(at, 0.05, SIX_ROWS)[0] for at in (q + step, q - step))
        assert gradient[i] == pytest.approx((np.log(after) - np.log(before)) / (2.0 * STEP), abs=SMALLER_DIFFERENCE,
                                            rel=1e-6)


@pytest.mark.parametrize("arm", ARMS)
def test_joints_limits_and_their_order_are_those_of_the_arm(arm):
    scenario, kinematics = load_scenario(arm), chain(arm)
    plain = kinematics_of(scenario.urdf_xml(), scenario.robot)
    assert kinematics.joint_names == plain.joint_names
    for name in ("lower", "upper", "velocity"):
        np.testing.assert_array_equal(getattr(kinematics, name), getattr(plain, name))


def test_the_camera_stands_where_the_urdf_has_it_at_every_posture():
    kinematics = chain("experiment_1")
    for seed in EYE_TO_HAND_SEEDS:
        camera = kinematics.camera(posture(kinematics, seed))
        np.testing.assert_allclose(camera, pose_from_rpy([0.03, 0.05, 0.17], [0.0, 0.0, 0.0]), atol=ROUNDING)


@pytest.mark.parametrize("name", ["experiment_1", "iiwa7"])
def test_offsets_of_the_joints_move_the_camera_as_the_joints_do(name):
    scenario = load_scenario(name)
    plain, random = scenario.kinematics(), np.random.default_rng(3)
    offsets = dict(zip(plain.joint_names, random.uniform(-0.1, 0.1, len(plain.joint_names)).tolist()))
    off = scenario.with_overrides({"robot.joint_offsets": offsets})
    q = scenario.goal_posture(plain)
    np.testing.assert_allclose(off.kinematics().pose(q), plain.pose(q + plain.vector(offsets)), atol=1e-12)
    np.testing.assert_array_equal(off.kinematics(calibrated=False).pose(q), plain.pose(q))
    with pytest.raises(ParameterError, match="joint_offsets"):
        scenario.with_overrides({"robot.joint_offsets": {"nobody": 0.1}})


def test_a_calibrated_camera_stands_where_the_calibration_has_it():
    place = {"link": "world", "position_m": [0.3, 0.2, 0.1], "rpy_rad": [0.1, -0.2, 0.3]}
    kinematics = chain("experiment_1", hand_eye=place)
    expected = pose_from_rpy(place["position_m"], place["rpy_rad"])
    np.testing.assert_allclose(kinematics.camera(posture(kinematics, 1)), expected, atol=ROUNDING)


@pytest.mark.parametrize("changes, cause", [
    ({"tip_link": "link1"}, "camera 'link1': .*J1, gantry"),
    ({"tip_link": "camera_optical_frame"}, "'link6' and 'camera_optical_frame'"),
    ({"target_link": "tool"}, "no link 'tool'"),
    ({"target_link": "rail"}, "no moving joint between 'world' and 'rail'"),
    ({"base_link": "link6", "target_link": "slider"}, "'slider' is not below link 'link6'")])
def test_a_camera_or_a_target_that_cannot_be_is_refused_by_name(changes, cause):
    with pytest.raises(ModelError, match=cause):
        chain("experiment_1", **changes)


# --- joint positions for a pose of the camera -------------------------------------------------------------------------


def gantry(limit=100.0):
    """Joints x, y and z along the axes of the base, and one about x: its Jacobian is 1 where nothing is turned."""
    text, names = '<link name="0"/>', ("x", "y", "z", "z_roll")
    for i, (name, axis) in enumerate(zip(names, ("1 0 0", "0 1 0", "0 0 1", "1 0 0"))):
        text += (f'<link name="{i + 1}"/><joint name="{name}" type="{"revolute" if i == 3 else "prismatic"}">'
                 f'<parent link="{i}"/><child link="{i + 1}"/><axis xyz="{axis}"/>'
                 f'<limit lower="{-limit}" upper="{limit}" velocity="1" effort="1"/></joint>')
    return Kinematics(f'<robot name="gantry">{text}</robot>', "0", "4")


def test_a_search_takes_sixty_damped_steps_of_at_most_three_tenths():
    q, error = reaching._solve(gantry(), pose_from_rpy([20.0, 10.0, 0.0], [0.0] * 3), np.zeros(4))
    np.testing.assert_allclose(q, [18.0, 9.0, 0.0, 0.0], rtol=1e-12)
    np.testing.assert_allclose(error, [2.3, 1.15, 0.0, 0.0, 0.0, 0.0], rtol=1e-12)  # where the last step begins
    q, error = reaching._solve(gantry(), pose_from_rpy([0.0, 0.2, 0.0], [0.0] * 3), np.zeros(4))
    assert q[1] == pytest.approx(0.2 / (1.0 + 0.01**2), rel=1e-12) and error[1] == pytest.approx(0.2 - q[1])


@pytest.mark.parametrize("index, size, there", [  # the search ends exactly where `reach` takes what it found
    (0, 0.99e-4, True), (0, 1e-4, False), (2, 1.01e-4, False), (3, 4.9e-4, True), (3, 5e-4, False), (3, 5.1e-4, False)])
def test_a_pose_is_reached_within_a_tenth_of_a_millimetre_and_half_a_milliradian(index, size, there, monkeypatch):
    place, near = size * np.eye(6)[index], np.zeros(4)
    X = pose_from_rpy(place[:3], place[3:])
    assert np.array_equal(reaching._solve(gantry(), X, near)[0], near) is there
    monkeypatch.setattr(reaching, "_solve", lambda kinematics, X_BC, q: (q, place))
    assert (reaching.reach(gantry(), near, X)[0] is not None) is there


def test_a_solution_within_the_limits_is_looked_for_from_six_other_postures_nearby(monkeypatch):
    begun, beyond = [], np.array([2.0, 0.0, 0.0, 0.0])

    def solve(kinematics, X_BC, q):
        begun.append(q)
        return (np.full(4, 0.5) if len(begun) == last else beyond + len(begun)), np.zeros(6)

    monkeypatch.setattr(reaching, "_solve", solve)
    near = np.array([0.1, 0.2, 0.3, 0.4])
    for last, found in ((1, 0.5), (7, 0.5), (8, 3.0)):  # where there is none, the first solution is what there is
        begun.clear()
        joints, why_not = reaching.reach(gantry(1.0), near, np.eye(4))
        assert joints["x"] == found and why_not == "" and len(begun) == min(7, last)
    off = np.array(begun) - near
    assert not off[0].any() and 0.6 < np.abs(off[1:]).max() <= 0.8 and off[1:].min() < 0.0 < off[1:].max()
    assert (np.abs(off[1:]).sum(axis=1) > 0.0).all()


def test_of_several_searches_in_vain_the_nearest_is_told(monkeypatch):
    left = iter([3.0, 1.0, 2.0, 4.0, 5.0, 6.0, 7.0])
    monkeypatch.setattr(reaching, "_solve", lambda kinematics, X_BC, q: (
        q, next(left) * np.array([0.003, 0.0, 0.004, 0.0, 0.01, 0.0])))
    joints, why_not = reaching.reach(gantry(), np.zeros(4), np.eye(4))
    assert joints is None and next(left, None) is None
    assert list(map(float, re.findall(r"[0-9.]+", why_not))) == [5.0, pytest.approx(np.degrees(0.01), rel=1e-2)]


def test_joints_outside_their_limits_are_named():
    joints = {"x": 1.1, "y": -1.1, "z": 1.0, "z_roll": -1.0}
    assert reaching.outside_limits(gantry(1.0), {**joints, "x": 0.0, "y": 0.0}) == ""
    text = reaching.outside_limits(gantry(1.0), joints)
    assert "x 1.1 " in text and "y -1.1 " in text and "z" not in text


def test_no_ros_library_is_loaded():
    program = ("import aras_visual_servo_camera, aras_visual_servo_sim, aras_visual_servo._kinematics; "
               "print(open('/proc/self/maps').read())")
    loaded = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout
    assert "liborocos-kdl" in loaded
    assert set(re.findall("lib(?:ros|log4cxx|kdl_parser)[a-z0-9_]*", loaded)) == set()
