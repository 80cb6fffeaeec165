"""Moving targets: the filter, the estimate, and what feeding it forward is worth, on exact pictures."""

import numpy as np
import pytest
from bench import Bench, config, DT_S, resting
from synthetic import make_record
from toy_plant import arm, Camera, GOAL, PERIOD_NS

from aras_visual_servo import (
    FEATURE_NAMES, Features, FeatureSet, goal_pose, judge, Observation, ParameterError, plane_from_pose, pose_error,
    Reference, Servo, Status, tracking, View)
from aras_visual_servo.servo.feed_forward import ConstantVelocity, FeedForwardSettings, POSE_FEATURES, TargetMotion
from aras_visual_servo.spatial import exponential

BENT = {"gantry": 0.0, "J1": 0.0, "J2": -0.5, "J3": 0.9, "J5": -0.4, "J6": 0.0}
LAMBDA = 3.0


class MovingBench(Bench):
    """The target moves: X_WT(t) = X_WT(0) moved by `motion(t)`, (x, y, z [m], angle about z [rad])."""

    def __init__(self, motion, **changes):
        self.motion = None
        super().__init__(goal=BENT, start=BENT, track=True, time_limit_s=8.0, **changes)
        self.motion, self.X_WT0, self.off = motion, self.camera.X_WT.copy(), []

    def look(self):
        if self.motion is not None:
            x, y, z, angle = self.motion(self.stamp_ns * 1e-9)
            self.camera.X_WT = self.X_WT0.copy()
            self.camera.X_WT[:3, :3] = exponential(np.array([0, 0, 0, 0, 0, angle]))[:3, :3] @ self.X_WT0[:3, :3]
            self.camera.X_WT[:3, 3] += [x, y, z]
            X_WG = self.camera.X_WT @ np.linalg.solve(self.X_WT0, self.X_WG)
            self.off.append(np.linalg.norm(np.linalg.solve(X_WG, self.arm.pose(self.q))[:3, 3]))
        return super().look()

    def rms(self):
        """Of the true way to the moving goal, over the second half [m]."""
        self.run()
        return float(np.sqrt(np.mean(np.square(self.off[len(self.off) // 2:]))))


def evenly(t):
    return np.array([0.004, 0.03, -0.003, 0.05]) * t


def circle(t):
    return np.array([0.03 * np.sin(0.8 * t), 0.03 * (1.0 - np.cos(0.8 * t)), 0.0, 0.0])


def random_walk(seed):
    steps = np.random.default_rng(seed).normal(size=(30, 4)) * [0.02, 0.02, 0.003, 0.05] * 0.5  # a velocity each 0.5 s
    places = np.vstack([np.zeros(4), np.cumsum(steps, axis=0)])

    def motion(t):
        k = int(t / 0.5)
        return places[k] + (places[k + 1] - places[k]) * (t / 0.5 - k)

    return motion


def test_without_feed_forward_the_camera_lags_by_the_speed_over_the_gain():
    speed = np.linalg.norm(evenly(1.0)[:3])
    # (1 - exp(-lambda dt)) / dt of a sampled loop, and the camera's own radius about the turning target
    assert MovingBench(evenly).rms() == pytest.approx(speed / LAMBDA, rel=0.15)


@pytest.mark.parametrize("motion, factor", [
    (evenly, 50.0), (circle, 8.0), (random_walk(1), 2.0), (random_walk(2), 2.0)])
def test_feed_forward_follows_closer(motion, factor):
    without, fed = MovingBench(motion).rms(), MovingBench(motion, feed_forward={}).rms()
    assert fed * factor < without


def test_a_part_of_the_motion_fed_forward_leaves_the_rest_of_the_lag():
    half = MovingBench(evenly, feed_forward={"part": 0.5}).rms()
    assert half == pytest.approx(0.5 * MovingBench(evenly).rms(), rel=0.05)


def test_a_target_at_rest_is_reached_as_without():
    bench = Bench(feed_forward={})
    assert bench.run().status == Status.CONVERGED
    bench.assert_at_goal()


def test_a_goal_that_is_followed_to_the_end_counts_as_converged():
    bench = MovingBench(evenly, feed_forward={}, thresholds=dict.fromkeys(FEATURE_NAMES, 1e-3))
    last = bench.run()
    assert (last.status, bench.stamp_ns - PERIOD_NS) == (Status.CONVERGED, pytest.approx(8e9, abs=PERIOD_NS))
    assert MovingBench(evenly).run().status == Status.TIMED_OUT


def test_nothing_is_fed_forward_while_the_target_is_lost_or_the_image_late():
    bench = MovingBench(evenly, feed_forward={})
    bench.run(60)
    lost = bench.look()
    lost.features.target_visible = False
    command, record = bench.step(lost)
    assert resting(command) and record.status == Status.TARGET_LOST
    command, record = bench.step(Observation(bench.stamp_ns, None, bench.q))
    assert resting(command) and record.status == Status.STALE_INPUT
    command, record = bench.step()  # and what was known of the target is still known
    assert np.linalg.norm(record.twist[:3]) == pytest.approx(np.linalg.norm(evenly(1.0)[:3]), rel=0.2)


def test_gains_are_those_of_the_kalman_filter():
    found = ConstantVelocity(0.5, 3e-4, 0.1)
    P, H, R = np.diag([9e-8, 0.01]), np.array([[1.0, 0.0]]), 9e-8
    for dt_s in (0.03, 0.03, 0.1, 0.03, 0.5):
        F, noise = np.array([[1.0, dt_s], [0.0, 1.0]]), np.array([[0.5 * dt_s * dt_s], [dt_s]])
        P = F @ P @ F.T + 0.25 * noise @ noise.T
        K = P @ H.T / (H @ P @ H.T + R)
        P = (np.eye(2) - K @ H) @ P
        np.testing.assert_allclose(found.gains(dt_s), K[:, 0], rtol=1e-9)


# --- what the error says about the goal -----------------------------------------------------------------------------

NORMAL = np.array([0.15, -0.1, 1.0]) / np.linalg.norm([0.15, -0.1, 1.0])
Z_STAR = 0.6


def seen(X_CT, star=None):
    """Features of the toy outline at X_CT."""
    camera = Camera(X_CT)
    camera.star = star or (Z_STAR, camera.features(np.eye(4)).area)
    return camera.features(np.eye(4)), camera.star


def target(tilted):
    """X_GT of a goal, and the normal of the target's plane there."""
    normal = NORMAL if tilted else np.array([0.0, 0.0, 1.0])
    turn = np.cross([0.0, 0.0, 1.0], normal)
    X_GT = exponential(np.concatenate([np.zeros(3), turn * (np.arcsin(np.linalg.norm(turn)) / np.linalg.norm(turn))
                                       if tilted else np.zeros(3)]))
    X_GT[:3, 3] = [0.02, -0.01, Z_STAR]
    return X_GT, normal


def estimator(names, X_GT, normal):
    features = FeatureSet(names)
    view, star = seen(X_GT)
    plane = plane_from_pose(normal, Z_STAR * np.array([view.xg, view.yg, 1.0]))
    motion = TargetMotion(FeedForwardSettings(), features)
    s_star = np.zeros(6) if names == POSE_FEATURES else np.array(features.values(View(view)))
    motion.set_reference(Reference(s_star, view=Features.from_object(view), plane_C=plane))
    return motion, features, s_star, star


DISPLACEMENTS = [([0.05, -0.03, 0.04, 0.0, 0.0, 0.4], FEATURE_NAMES, 1e-9),
                 # first order in a displacement of 1e-3: second order is 1e-6 times the curvature of sx, sy, about 1e2
                 ([1e-3, -5e-4, 8e-4, 1e-3, -2e-3, 1e-3], ("xn", "yn", "an", "sx", "sy", "alpha"), 3e-4),
                 ([0.05, -0.03, 0.04, 0.1, -0.2, 0.3], POSE_FEATURES, 1e-9)]


@pytest.mark.parametrize("displacement, names, tolerance", DISPLACEMENTS)
def test_goal_in_the_camera_frame_is_where_it_is(displacement, names, tolerance):
    X_GT, normal = target(tilted=names != FEATURE_NAMES)
    motion, features, s_star, star = estimator(names, X_GT, normal)
    X_GC = exponential(np.array(displacement))
    view, _ = seen(np.linalg.solve(X_GC, X_GT), star)
    if names == POSE_FEATURES:
        s = np.concatenate([X_GC[:3, 3], displacement[3:]])
    else:
        s = np.array(features.values(View(view)))
    R_CG, p_CP = motion.goal_and_point(s, features.error(tuple(s), tuple(s_star), False))
    X_CG = np.linalg.inv(X_GC)
    np.testing.assert_allclose(R_CG, X_CG[:3, :3], atol=tolerance)
    taught, _ = seen(X_GT, star)
    point_G = np.array([taught.xn, taught.yn, taught.an])
    # the centroid of the picture is not that of the plate where it is seen tilted: 1e-9 only where it is parallel
    np.testing.assert_allclose(p_CP, (X_CG @ np.append(point_G, 1.0))[:3], atol=tolerance)


def test_a_turning_camera_sees_the_same_motion_of_the_target():
    X_GT, normal = target(tilted=False)
    motion, features, s_star, star = estimator(FEATURE_NAMES, X_GT, normal)
    velocity = np.array([0.02, -0.01, 0.005])
    for k in range(90):  # the camera swings about its axis and moves, the target moves evenly in B
        t = k * DT_S
        X_BC = exponential(np.array([0.01 * np.sin(t), 0.02 * t, 0.0, 0.0, 0.0, 0.3 * np.sin(2.0 * t)]))
        X_BT = X_GT.copy()
        X_BT[:3, 3] += velocity * t
        view, _ = seen(np.linalg.solve(X_BC, X_BT), star)
        s = features.values(View(view))
        twist = motion.twist(round(t * 1e9), X_BC, s, features.error(s, tuple(s_star), False))
    np.testing.assert_allclose(motion.velocity, velocity, atol=1e-5)  # 1e-3 of it after 3 s
    np.testing.assert_allclose(motion.turn, 0.0, atol=1e-4)
    np.testing.assert_allclose(twist[:3], velocity @ X_BC[:3, :3], atol=1e-4)


# --- judged against where the target is ------------------------------------------------------------------------------


def test_the_goal_moves_with_the_target():
    record = make_record()
    X = np.tile(np.eye(4), (len(record), 1, 1))
    moved = exponential(np.array([0.1, -0.2, 0.05, 0.1, 0.2, -0.3]))
    last = record.servo_rows[-1]
    X[last] = moved @ X[last]
    object.__setattr__(record, "target_poses", X)
    np.testing.assert_allclose(goal_pose(record, last), moved @ record.X_WC[record.taught_row], atol=1e-12)
    assert goal_pose(record, record.servo_rows[0]) is not None
    still = judge(make_record()).final_error
    record.X_WC[last] = moved @ record.X_WC[last]  # the camera went along: the same error
    assert judge(record).final_error == pytest.approx(still, abs=1e-9)
    assert abs(pose_error(record.X_WC[record.taught_row], record.X_WC[last])["x_mm"]) > 50.0


def test_tracking_is_the_rms_of_the_second_half():
    found, record = tracking(make_record()), make_record()
    rows = record.servo_rows[len(record.servo_rows) // 2:-1]
    assert found["e"]["xn"] == pytest.approx(np.sqrt(np.mean(record.e[rows, 0]**2)), rel=1e-12)
    assert found["position_mm"] > 0.0 and found["angle_deg"] > 0.0


def test_a_reference_without_a_view_is_refused():
    servo = Servo(arm(), config(feed_forward={}))
    with pytest.raises(ParameterError, match="feed_forward"):
        servo.set_reference(Reference(np.zeros(4), posture=GOAL))


@pytest.mark.parametrize("axis", range(3))
def test_a_turning_target_is_followed_by_a_camera_that_turns_about_it(axis):
    """v - w x p of the followed point p, all in the camera; gains of zero keep the estimate as it was set."""
    motion = TargetMotion(FeedForwardSettings(part=1.0), FeatureSet(POSE_FEATURES))
    X_BC = exponential(np.array([0.1, -0.2, 0.3, 0.4, -0.5, 0.6]))
    motion._point_G = np.array([0.02, -0.03, 0.5])
    s, e = np.array([0.01, 0.02, -0.03, 0.1, -0.05, 0.2]), np.zeros(6)
    motion.twist(0, X_BC, s, e)
    motion.velocity, motion.turn = np.array([0.01, -0.02, 0.03]), np.eye(3)[axis]
    motion._places.gains = motion._turns.gains = lambda dt_s: (0.0, 0.0)
    found = motion.twist(PERIOD_NS, X_BC, s, e)
    v, w, p = motion.velocity @ X_BC[:3, :3], motion.turn @ X_BC[:3, :3], motion.goal_and_point(s, e)[1]
    np.testing.assert_allclose(found, np.concatenate([v - np.cross(w, p), w]), atol=1e-12)
