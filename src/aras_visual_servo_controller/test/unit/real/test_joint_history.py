"""A real arm: joint positions between joint states, and features predicted ahead."""

import numpy as np
import pytest
from toy_plant import Camera

from aras_visual_servo import DegenerateFeature, ParameterError, plane_from_pose
from aras_visual_servo.spatial import exponential, inverse, rotation_rpy
from aras_visual_servo_controller.real.joint_history import JointHistory, Latency
from aras_visual_servo_controller.real.prediction import predicted

MS = 1_000_000
#: Positions on a straight line are interpolated exactly but for rounding: some eps.
ROUNDING = 1e-12


def history(*stamps_ms, speed=2.0):
    """Two joints that move along straight lines, seen at these times."""
    found = JointHistory(("a", "b"), max_gap_s=0.05, max_extrapolation_s=0.01)
    for stamp in stamps_ms:
        assert found.add(stamp * MS, line(stamp, speed))
    return found


def line(t_ms, speed=2.0):
    return np.array([speed * t_ms * 1e-3, 1.0 - t_ms * 1e-3])


@pytest.mark.parametrize("t_ms", [101, 110, 119.5])
def test_between_two_joint_states_it_is_their_line(t_ms):
    then = history(80, 100, 120).at(round(t_ms * MS))
    assert then.q == pytest.approx(line(t_ms), abs=ROUNDING)
    assert (then.gap_s, then.extrapolation_s, then.refusal) == (pytest.approx(0.02), 0.0, "")


def test_a_joint_state_of_that_very_stamp_is_taken_as_it_is():
    assert (history(80, 100).at(100 * MS).q == line(100)).all()


def test_a_little_beyond_the_newest_the_line_goes_on():
    then = history(80, 100).at(108 * MS)
    assert then.q == pytest.approx(line(108), abs=ROUNDING) and then.extrapolation_s == pytest.approx(0.008)


@pytest.mark.parametrize("stamps, at_ms, waits, reason", [
    ((80, 100), 111, True, "0.011 s older than the image, allowed 0.01"),
    ((80, 140), 100, False, "0.060 s apart, allowed 0.05 s"), ((80, 100), 70, False, "later than the image")])
def test_without_joint_states_beside_it_an_image_waits_or_is_refused_for_good(stamps, at_ms, waits, reason):
    then = history(*stamps).at(at_ms * MS)
    assert then.q is None and then.wait == waits and reason in then.refusal


@pytest.mark.parametrize("stamps", [(), (100,)])
def test_with_too_few_joint_states_it_waits(stamps):
    assert history(*stamps).at(101 * MS).wait


def test_a_stamp_that_is_not_newer_is_left_out():
    found = history(80, 100)
    assert not found.add(100 * MS, line(7)) and not found.add(90 * MS, line(7))
    assert found.at(90 * MS).q == pytest.approx(line(90), abs=ROUNDING)


def part(t_ms, joint, speed=2.0):
    """The position of one joint, as a driver of its own tells it."""
    q = np.full(2, np.nan)
    q[joint] = line(t_ms, speed)[joint]
    return q


def test_joints_of_two_drivers_are_interpolated_each_between_its_own_stamps():
    found = JointHistory(("a", "b"), max_gap_s=0.05, max_extrapolation_s=0.01)
    for stamp in (80, 100, 120):
        assert found.add(stamp * MS, part(stamp, 0)) == ["a"]
        assert found.add((stamp + 7) * MS, part(stamp + 7, 1)) == ["b"]
    then = found.at(110 * MS)
    assert then.q == pytest.approx(line(110), abs=ROUNDING) and then.gap_s == pytest.approx(0.02)
    assert found.newest == pytest.approx([line(120)[0], line(127)[1]]) and found.newest_ns == 120 * MS
    assert found.at(129 * MS).extrapolation_s == pytest.approx(0.009)


def test_a_joint_without_states_is_named_and_nothing_is_made_up_for_it():
    found = JointHistory(("a", "b"), max_gap_s=0.05, max_extrapolation_s=0.01)
    for stamp in (80, 100):
        found.add(stamp * MS, part(stamp, 0))
    then = found.at(90 * MS)
    assert then.q is None and then.wait and then.refusal.startswith("b: ")
    assert found.newest is None and found.newest_ns == -1
    for stamp in (20, 140):
        found.add(stamp * MS, part(stamp, 1))
    then = found.at(90 * MS)
    assert then.q is None and not then.wait and then.refusal.startswith("b: ") and "0.120 s apart" in then.refusal


def test_old_joint_states_are_forgotten():
    found = JointHistory(("a", "b"), 0.05, 0.01, kept_s=0.1)
    for stamp in range(0, 400, 20):
        found.add(stamp * MS, line(stamp))
    assert found.at(200 * MS).q is None and found.at(300 * MS).q is not None


def test_latency_is_that_of_the_last_messages():
    latency = Latency(count=3)
    assert np.isnan(latency.summary().mean_s)
    for age_s in (9.0, 0.02, 0.04, 0.06):
        latency.add(age_s)
    summary = latency.summary()
    assert (summary.mean_s, summary.least_s, summary.most_s) == (pytest.approx(0.04), 0.02, 0.06)
    assert "40.0 ms old" in summary.text("images")


NAMES = ("xg", "yg", "alpha", "xn", "yn", "an", "area")
#: Half the motion leaves a quarter of the error; higher orders may add to it.
SECOND_ORDER = 0.35
#: Of the motion of a feature, so much at most is left: the object fills a fifth of its distance.
LEFT = 0.03


def scene(seed):
    """(camera, X_WC, plane in its frame, a twist): tilted views of the target, and a motion of a few centimetres."""
    random = np.random.default_rng(seed)
    X_WT = np.eye(4)
    X_WC = np.eye(4)
    X_WC[:3, :3] = rotation_rpy([np.pi, 0.0, 0.0]) @ rotation_rpy(random.uniform(-0.3, 0.3, 3))
    X_WC[:3, 3] = [0.0, 0.0, 0.6]
    X_WC[:3, 3] = X_WC[:3, :3] @ [0.05, -0.04, -0.6]
    camera = Camera(X_WT)
    camera.star = (0.6, 0.03)
    X_CT = inverse(X_WC) @ X_WT
    twist = np.concatenate([random.uniform(-0.04, 0.04, 3), random.uniform(-0.08, 0.08, 3)])
    return camera, X_WC, plane_from_pose(X_CT[:3, 2], X_CT[:3, 3]), twist


def values(features):
    return np.array([getattr(features, name) for name in NAMES])


@pytest.mark.parametrize("seed", range(4))
def test_the_prediction_is_right_to_second_order(seed):
    camera, X_WC, plane_C, twist = scene(seed)
    before, errors = camera.features(X_WC), []
    for part in (1.0, 0.5):
        X = exponential(part * twist)
        after = camera.features(X_WC @ X)
        found = predicted(before, plane_C, X)
        errors.append(np.abs(values(found) - values(after)).max())
        moved = np.abs(values(before) - values(after)).max()
        assert errors[-1] < LEFT * moved
        assert found.mu == pytest.approx(after.mu, abs=0.2 * max(np.abs(np.array(before.mu) - after.mu)) + 1e-9)
    assert errors[1] < SECOND_ORDER * errors[0] + ROUNDING


@pytest.mark.parametrize("seed", range(4))
def test_points_are_mapped_exactly(seed):
    camera, X_WC, plane_C, twist = scene(seed)
    X = exponential(twist)
    found, after = predicted(camera.features(X_WC), plane_C, X), camera.features(X_WC @ X)
    assert found.point_x == pytest.approx(after.point_x, abs=ROUNDING)
    assert found.point_y == pytest.approx(after.point_y, abs=ROUNDING)


def test_a_camera_at_rest_sees_the_same():
    camera, X_WC, plane_C, _ = scene(0)
    before = camera.features(X_WC)
    assert values(predicted(before, plane_C, np.eye(4))) == pytest.approx(values(before), abs=ROUNDING)
    assert predicted(before, plane_C, np.eye(4)).m == pytest.approx(before.m, abs=ROUNDING)


def test_a_camera_beyond_the_target_is_refused():
    camera, X_WC, plane_C, _ = scene(0)
    with pytest.raises(DegenerateFeature, match="behind the camera"):
        predicted(camera.features(X_WC), plane_C, exponential(np.array([0.0, 0.0, 1.0, 0.0, 0.0, 0.0])))


def test_kernel_projections_are_refused():
    camera, X_WC, plane_C, _ = scene(0)
    features = camera.features(X_WC)
    features.kernel_x = (1.0,)
    with pytest.raises(ParameterError, match="kernel"):
        predicted(features, plane_C, np.eye(4))
