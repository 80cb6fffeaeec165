"""When the servo has arrived: features, tilt and pose together; the published rule; the last images."""

import numpy as np
import pytest
from bench import Bench, DT_S
from toy_plant import GOAL, PERIOD_NS, START

from aras_visual_servo import (
    FEATURE_NAMES, FeatureSet, ParameterError, Reference, ServoSettings, ShapeError, Status, StopSettings)
from aras_visual_servo._kinematics import Arrival, between
from aras_visual_servo.servo.goal_pose import GoalPose
from aras_visual_servo.servo.stages import CreepCompensation, FASTEST
from aras_visual_servo.servo.stop_rule import StopRule
from aras_visual_servo.spatial import exponential, inverse, rotation, rotation_vector

#: Of the shipped experiments.
THRESHOLDS = {"xn": 0.00005, "yn": 0.00015, "an": 0.00005, "alpha": 0.0003}
STOP = {"tilt_rad": 0.0003, "position_m": 0.00009, "rotation_rad": 0.0004}
#: The pose of e is of first order: what is left is of the size of the displacement squared, over the depth of 0.6 m.
SECOND_ORDER = 4.0
NOISE_SEED = 5
#: The shipped start looks straight down; this one is tilted by 0.05 rad.
TILTED = {**START, "J5": START["J5"] + 0.05}


def true_error(bench):
    X_GC = inverse(bench.X_WG) @ bench.arm.pose(bench.q)
    return np.linalg.norm(X_GC[:3, 3]), np.linalg.norm(rotation_vector(X_GC[:3, :3]))


@pytest.mark.parametrize("tilt_gain_per_s", [0.5, 1.0, 12.0])
def test_converged_means_the_true_pose_however_slowly_the_tilt_is_held(tilt_gain_per_s):
    bench = Bench(start=TILTED, thresholds=THRESHOLDS, stop=STOP, gains_per_s=dict.fromkeys(FEATURE_NAMES, 6.0),
                  tilt_gain_per_s=tilt_gain_per_s, time_limit_s=40.0)
    assert bench.run(1500).status == Status.CONVERGED
    distance, angle = true_error(bench)
    assert distance < STOP["position_m"] and angle < STOP["rotation_rad"]


def test_a_tilt_that_is_left_ends_the_run_with_its_name():
    bench = Bench(start=TILTED, thresholds=THRESHOLDS, stop=STOP, tilt_gain_per_s=0.3, time_limit_s=12.0)
    last = bench.run()
    assert last.status == Status.TIMED_OUT and "tilt" in last.status_text
    assert bench.records[-2].tilt_rad > STOP["tilt_rad"]
    assert bench.records[-2].tilt_rad == pytest.approx(true_error(bench)[1], rel=0.01)


@pytest.mark.parametrize("held", [0.0, 1.0])
def test_the_pose_of_the_errors_is_the_displacement_of_the_camera(held):
    bench = Bench()
    pose_of = GoalPose(FeatureSet(), bench.servo.reference)
    rng = np.random.default_rng(1)
    for _ in range(5):
        displacement = 0.001 * rng.normal(size=6) * [1, 1, 1, held, held, 1]
        seen = bench.camera.features(bench.X_WG @ exponential(displacement))
        e = np.array(FeatureSet().error([seen.xn, seen.yn, seen.an, seen.alpha], bench.servo.reference.s_star, False))
        found = pose_of.of(e, displacement[3:5])
        bound = SECOND_ORDER * float(displacement @ displacement) / 0.6
        np.testing.assert_allclose(found, displacement, rtol=0.0, atol=bound)
        # Without the tilt the same errors stand for another place: 1 mrad is 0.6 mm.
        assert not held or np.abs(pose_of.of(e, np.zeros(2)) - displacement).max() > 3.0 * bound


def test_features_without_a_matrix_tell_no_pose():
    assert GoalPose(FeatureSet(), Reference(np.zeros(4))).of(np.zeros(4), None) is None


class Watched:
    """A stop rule of two features, fed image by image."""

    def __init__(self, hold_s=0.2, follows=False, taught_images=10**6, **settings):
        self.rule = StopRule(("a", "b"), (0.001, 0.001), hold_s, StopSettings(**settings), follows, taught_images)
        self.stamp_ns, self.X_BC = 0, np.eye(4)

    def look(self, e=(0.0, 0.0), tilt=None, pose=None):
        arrived = self.rule.arrived(self.stamp_ns, e, tilt, pose, self.X_BC)
        self.stamp_ns += PERIOD_NS
        return arrived and not self.rule.uncertain

    def looks_until_arrived(self, most, **seen):
        for count in range(1, most + 1):
            if self.look(**{name: value() if callable(value) else value for name, value in seen.items()}):
                return count
        return None


def test_arrived_after_the_hold_time_and_not_before():
    assert Watched(hold_s=0.2).looks_until_arrived(20, pose=np.zeros(6)) == 8  # 7 periods of 33.3 ms: 0.2333 s
    assert Watched(hold_s=0.5, follows=True).looks_until_arrived(30, pose=np.zeros(6)) == 17


@pytest.mark.parametrize("seen, lacking", [
    ({"e": (0.002, 0.0)}, ("a",)), ({"tilt": np.array([0.0, 0.001])}, ("tilt",)),
    ({"pose": np.array([0.001, 0.0, 0.0, 0.0, 0.0, 0.0])}, ("position",)),
    ({"pose": np.array([0.0, 0.0, 0.0, 0.0, 0.004, 0.0])}, ("rotation",))])
def test_each_thing_that_is_judged_keeps_the_servo_from_having_arrived(seen, lacking):
    watched = Watched()
    assert watched.looks_until_arrived(100, **seen) is None
    assert watched.rule.lacking == lacking


def test_noise_of_the_pose_does_not_pass_for_arrival_and_is_averaged_out():
    rng = np.random.default_rng(NOISE_SEED)
    noise = 0.002  # 2.5 times position_m
    watched = Watched()
    count = watched.looks_until_arrived(300, pose=lambda: rng.normal(size=6) * [noise, 0, 0, 0, 0, 0])
    # Two standard errors are below position_m from (2 noise / position_m)^2 images on.
    assert 20 < count < 120


def test_images_that_noise_takes_far_off_do_not_make_the_rest_forgotten():
    watched, rng = Watched(), np.random.default_rng(NOISE_SEED)
    noise = 4.0 * 0.001  # of single images, in the feature: every fifth is more than five thresholds off

    close = []
    for error in noise * rng.normal(size=300):
        watched.look(e=(float(error), 0.0), pose=np.array([0.1 * error, 0, 0, 0, 0, 0]))
        close.append(watched.rule.close)
    assert all(close[3:])
    looks = [watched.look(e=(0.006, 0.0), pose=np.zeros(6)) for _ in range(31)]  # for LEAVE_S
    assert not any(looks[7:]) and not watched.rule.close and watched.rule.lacking == ("a",)


def test_noise_of_the_taught_view_counts_too():
    rng = np.random.default_rng(NOISE_SEED)
    watched = Watched(taught_images=4)
    assert watched.looks_until_arrived(300, pose=lambda: rng.normal(size=6) * [0.002, 0, 0, 0, 0, 0]) is None


def test_a_camera_that_swings_about_the_goal_has_not_arrived():
    watched = Watched()
    for i in range(300):
        swing = 0.0015 * (-1) ** (i // 4)
        watched.X_BC = exponential(np.array([swing, 0.0, 0.0, 0.0, 0.0, 0.0]))
        assert not watched.look(pose=np.array([swing, 0.0, 0.0, 0.0, 0.0, 0.0]))


def test_images_from_before_a_move_tell_where_the_camera_is_now():
    watched = Watched()
    rng = np.random.default_rng(NOISE_SEED)
    for i in range(200):  # creeps away from the goal; each image is noisy, the joints know the way
        place = np.array([0.00001 * i, 0.0, 0.0, 0.0, 0.0, 0.0])
        watched.X_BC = exponential(place)
        watched.look(pose=place + rng.normal(size=6) * [0.0003, 0, 0, 0, 0, 0])
    # The standard error of 200 images is 0.02 mm, and twice that counts as distance.
    assert watched.rule.judged[1] == pytest.approx(0.00199, abs=0.0001)


def test_a_small_error_that_stands_for_a_large_displacement_is_no_arrival():
    # Both features hardly move with the camera: 1e-4 of them, a tenth of the threshold, is 5 mm.
    assert Watched().looks_until_arrived(100, e=(0.0001, 0.0), pose=np.array([0.005, 0, 0, 0, 0, 0])) is None


def test_the_published_rule_ends_by_its_own_status_and_never_as_converged():
    bench = Bench(start=TILTED, thresholds=THRESHOLDS, stop={"rule": "published"}, tilt_gain_per_s=0.1)
    last = bench.run()
    assert last.status == Status.STOPPED_BY_RULE and last.status_text == "stopped by the published rule"
    assert not last.converged and bench.servo.finished
    assert true_error(bench)[1] > STOP["rotation_rad"]  # which is what it cannot see


def test_the_rule_is_a_choice_and_its_thresholds_are_checked():
    base = {"law": "decoupled", "mode": "continuous", "gains_per_s": dict.fromkeys(FEATURE_NAMES, 1.0),
            "thresholds": THRESHOLDS, "time_limit_s": 1.0}
    with pytest.raises(ParameterError) as error:
        ServoSettings.from_dict({**base, "stop": {"rule": "other", "tilt_rad": 0.0}})
    assert "rule" in str(error.value) and "tilt_rad" in str(error.value)


def creeping(compensated, creep_m_s=0.0002, gain_per_s=2.0):
    """Error after 5 s of a camera that moves by itself, servoed at a gain, in metres."""
    compensation, x, stamps = CreepCompensation(2.0 if compensated else 0.0), 0.0, int(5.0 / DT_S)
    for _ in range(stamps):
        twist = np.array([-gain_per_s * x, 0.0, 0.0, 0.0, 0.0, 0.0])
        X_BC = exponential(np.array([x, 0.0, 0.0, 0.0, 0.0, 0.0]))
        x += DT_S * (float((twist + compensation.correction(twist, X_BC, DT_S))[0]) + creep_m_s)
    return x


def test_creep_leaves_an_error_of_creep_over_gain_and_compensation_none():
    assert creeping(False) == pytest.approx(0.0001, rel=0.01)
    assert abs(creeping(True)) < 1e-6


@pytest.mark.parametrize("rate_per_s", [0.5, 2.0])
def test_compensation_is_bounded_and_forgets(rate_per_s):
    compensation = CreepCompensation(rate_per_s)
    for _ in range(200):  # a joint that sticks: told to go, and does not
        correction = compensation.correction(np.full(6, 0.01), np.eye(4), DT_S)
    np.testing.assert_allclose(correction, FASTEST)
    compensation.rest(None)
    assert (compensation.correction(np.zeros(6), np.eye(4), DT_S) == 0.0).all()


def test_close_to_the_goal_for_long_the_servo_calms_down():
    watched = Watched()
    for i in range(150):  # never arrives
        watched.look(pose=np.array([0.002, 0.0, 0.0, 0.0, 0.0, 0.0]))
        if i * DT_S < 1.9:
            assert watched.rule.calm(8.0) == 1.0
    assert watched.rule.calm(8.0) == pytest.approx(1.0 / (1.0 + 149 * DT_S - 2.0), rel=1e-6)
    assert watched.rule.calm(0.5) == 1.0  # slower than CALM_PER_S as it is


def test_the_servo_rests_where_there_is_nothing_to_correct():
    bench = Bench(thresholds=THRESHOLDS, stop=STOP, start={**GOAL, "gantry": 0.05002})
    _, record = bench.step()
    assert record.status_text == "resting" and not record.twist.any()


@pytest.mark.parametrize("row, most", [(0, "position_m"), (1, "position_m"), (2, "position_m"), (3, "rotation_rad"),
                                       (4, "rotation_rad"), (5, "rotation_rad")])
def test_close_is_within_five_times_each_threshold(row, most):
    rule = StopRule(("a",), (0.1,), 0.2, StopSettings(**STOP), False)
    for part, close in ((0.99, True), (1.01, False)):
        pose = np.zeros(6)
        pose[row] = -part * 5.0 * STOP[most]
        assert rule._is_close((0.0,), 0.0, pose) == close
        assert rule._is_close((-part * 0.5,), 0.0, None) == close
        assert rule._is_close((0.0,), part * 5.0 * STOP["tilt_rad"], None) == close


#: Rounding of some tens of operations on numbers of size 1.
ROUNDING = 1e-14
#: Near half a turn the quaternion gives the axis; it loses a few digits more.
HALF_TURN_ROUNDING = 1e-12
HOLD_NS, KEPT_NS, POSITION_M, ROTATION_RAD, TILT_RAD = 200, 1000, 0.001, 0.01, 0.002
HERE = np.zeros(6)


def arrival(taught_images=4, sure=2.0, edges=np.zeros((6, 6)), planes=(np.eye(6),)):
    return Arrival([0.1, 0.2], HOLD_NS, KEPT_NS, POSITION_M, ROTATION_RAD, TILT_RAD, sure, taught_images, edges, planes)


def pose(turn, position):
    X = np.eye(4)
    X[:3, :3], X[:3, 3] = rotation(turn), position
    return X


@pytest.mark.parametrize("angle", [0.0, 1e-12, 1e-5, 0.3, 2.0, 3.0, 3.14159])
def test_between_is_the_translation_and_the_rotation_vector_in_the_first_frame(angle):
    rng = np.random.default_rng(7)
    X_A, axis = exponential(rng.normal(size=6)), rng.normal(size=3)
    X_AB = pose(angle * axis / np.linalg.norm(axis), rng.normal(size=3))
    found = between(X_A, X_A @ X_AB)
    tolerance = HALF_TURN_ROUNDING if angle > 2.5 else ROUNDING
    np.testing.assert_allclose(found[:3], X_AB[:3, 3], rtol=0.0, atol=10.0 * ROUNDING)
    expected = rotation_vector((inverse(X_A) @ X_A @ X_AB)[:3, :3])
    np.testing.assert_allclose(found[3:], expected, rtol=0.0, atol=tolerance)


def test_features_are_judged_by_their_mean_over_hold_s_and_the_tilt_by_its_largest():
    judged = arrival()
    judged.features(0, (9.0, 9.0), 0.9, HERE)  # out of the window at the last stamp
    judged.features(100, (0.3, -0.1), 0.001, HERE)
    means, tilt = judged.features(300, (-0.12, -0.1), 0.0005, HERE)
    np.testing.assert_allclose(means, [0.9, 0.5], rtol=ROUNDING)
    assert tilt == 0.5
    with pytest.raises(ShapeError, match="e: 1 values, expected 2"):
        judged.features(400, (1.0,), 0.0, HERE)


def test_where_noise_makes_the_mean_of_hold_s_large_all_images_of_the_place_are_asked():
    rng, judged, found, wanted = np.random.default_rng(2), arrival(), [], []
    errors = 0.2 * rng.normal(size=60) + 0.05
    for k, error in enumerate(errors):
        (part, steady), _ = judged.features(100 * k, (error, 1.0), 0.0, HERE)
        assert steady == 5.0  # no noise: the mean of hold_s stands
        last = errors[max(k - KEPT_NS // 100, 0):k + 1]
        held = abs(last[-3:].mean())
        noise = 2.0 * np.sqrt(0.5 * np.mean(np.diff(last)**2)) if k else 0.0
        of_all = abs(last.mean()) + noise / np.sqrt(len(last))
        wanted.append(held if held < 0.1 else min(held, max(of_all, held - noise / np.sqrt(len(last[-3:])))))
        found.append(0.1 * part)
    np.testing.assert_allclose(found, wanted, rtol=1e3 * ROUNDING)
    away = np.array([2.0 * POSITION_M, 0.0, 0.0, 0.0, 0.0, 0.0])  # images of another place tell nothing
    (part, _), _ = judged.features(100 * len(errors), (0.9, 0.0), 0.0, away)
    assert part == pytest.approx(np.append(errors[-2:], 0.9).mean() / 0.1, rel=1e3 * ROUNDING)


def test_the_place_is_the_mean_pose_of_the_images_near_the_camera_and_its_uncertainty_counts():
    rng, judged = np.random.default_rng(3), arrival()
    moved = [np.array([x, 0.0, 0.0, 0.0, 0.0, 0.0]) for x in (0.0, 0.01, 0.0102, 0.0104)]
    poses = [1e-4 * rng.normal(size=6) + motion for motion in moved]
    for k, (motion, seen) in enumerate(zip(moved, poses)):
        found = judged.place(100 * k, motion, seen, 0.0)
    near = np.array([seen - motion for motion, seen in zip(moved[1:], poses[1:])])  # the first is 10 mm away
    where = near.mean(axis=0) + np.array(moved[1:])  # of the last 200 ns
    seen = np.sqrt(where**2 + 4.0 / 3.0 * near.var(axis=0))
    unsure = np.sqrt(where**2 + 4.0 * (1.0 / 3.0 + 1.0 / 4.0) * near.var(axis=0))

    def parts(places):
        return (np.linalg.norm(places[:, :3], axis=1).max() / POSITION_M,
                np.linalg.norm(places[:, 3:], axis=1).max() / ROTATION_RAD)

    off, way, position, turn, known, left_open, position_m, rotation_rad = found
    np.testing.assert_allclose(off, max(parts(where)), rtol=1e3 * ROUNDING)
    np.testing.assert_allclose(way, 0.0004 / POSITION_M, rtol=1e3 * ROUNDING)
    np.testing.assert_allclose((position, turn), parts(seen), rtol=1e3 * ROUNDING)
    np.testing.assert_allclose(known, max(parts(unsure)), rtol=1e3 * ROUNDING)
    np.testing.assert_allclose(left_open, max(parts(near.std(axis=0)[None])), rtol=1e3 * ROUNDING)  # 4 / 4 images
    last = np.linalg.norm(unsure[-1, :3]), np.linalg.norm(unsure[-1, 3:])
    np.testing.assert_allclose((position_m, rotation_rad), last, rtol=1e3 * ROUNDING)


def test_clear_forgets_every_image():
    judged = arrival()
    judged.features(0, (9.0, 9.0), 0.9, HERE)
    judged.place(0, np.zeros(6), np.ones(6), 0.0)
    judged.clear()
    means, tilt = judged.features(1, (0.1, 0.2), 0.001, HERE)
    assert means == [1.0, 1.0] and tilt == 0.5
    assert judged.place(1, np.zeros(6), np.zeros(6), 0.0)[0] == 0.0


def test_what_the_sides_leave_open_counts_as_distance_and_does_not_shrink():
    edges = np.diag([4.0, 0.0, 0.0, 0.0, 0.0, 9.0])
    judged = arrival(edges=edges)
    for k in range(5):
        _, _, position, turn, known, left_open, position_m, rotation_rad = judged.place(
            k, np.zeros(6), np.zeros(6), 1e-8)
    assert position == turn == 0.0
    np.testing.assert_allclose((position_m, rotation_rad), (2.0 * 2e-4, 2.0 * 3e-4))  # two standard deviations
    assert known == left_open == pytest.approx(max(4e-4 / POSITION_M, 6e-4 / ROTATION_RAD))


def test_a_displacement_counts_as_large_as_it_is_by_the_worst_plane():
    planes = (np.eye(6), np.diag([3.0, 1.0, 1.0, 1.0, 1.0, 1.0]))
    seen = np.array([2e-4, 0.0, 0.0, 0.0, 0.0, 0.0])
    off, _, position, _, known, left_open, position_m, _ = arrival(planes=planes).place(0, np.zeros(6), seen, 0.0)
    np.testing.assert_allclose((off, known), 6e-4 / POSITION_M)
    assert position == pytest.approx(2e-4 / POSITION_M) and position_m == pytest.approx(6e-4) and left_open == 0.0
