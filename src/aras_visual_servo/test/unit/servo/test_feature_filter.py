"""The filter of features: through outages, dropped images, latency and noise, on exact pictures."""

from dataclasses import replace

import numpy as np
import pytest
from bench import Bench, resting
from test_feed_forward import evenly, MovingBench
from toy_plant import PERIOD_NS
from views import assert_same, differences, plane_of, tilted_pose, view

from aras_visual_servo import expand, Features, FeatureSet, Status
from aras_visual_servo.servo.feature_filter import FeatureFilter, FilterSettings, matrix_of_pose
from aras_visual_servo.spatial import exponential, rotation, rotation_vector

#: The features move along curves between two looks: of a motion of 0.05 m and 0.1 rad in all, a fiftieth.
CURVED = 0.02
POINTS = expand(["points5"])


class Outages(Bench):
    """The target is not seen between two times, images may be dropped, and answers may come late."""

    def __init__(self, begin_s=0.0, end_s=0.0, dropped=(), late=0, noise=0.0, **changes):
        super().__init__(**changes)
        self.gap_ns, self.dropped, self.late = (1e9 * begin_s, 1e9 * end_s), dropped, late
        self.noise, self.random, self.waiting = noise, np.random.default_rng(0), []

    def look(self):
        seen = super().look()
        if self.gap_ns[0] <= self.stamp_ns < self.gap_ns[1]:
            return replace(seen, features=Features())
        if self.noise:
            seen.features.xn += self.noise * self.random.normal()
        return seen

    def step(self, observation=None):
        frame = self.stamp_ns // PERIOD_NS
        self.waiting.append(self.look())
        if frame in self.dropped or len(self.waiting) <= self.late:
            command, record = None, None
        else:
            observation = self.waiting.pop(0)
            command, record = self.servo.step(observation, 1e-9 * PERIOD_NS)
            self.records.append(record)
            self.velocity = command.velocity
        for i, name in enumerate(self.arm.joint_names):
            self.set_point[i] += getattr(self, "velocity", {}).get(name, 0.0) * 1e-9 * PERIOD_NS
        if frame in self.dropped:
            self.waiting.clear()
        self.stamp_ns += PERIOD_NS
        return command, record


def test_the_camera_goes_on_through_an_outage_as_if_it_had_seen_the_target():
    seen, hidden, alone = Outages(), Outages(0.3, 0.9, filter={"outage_s": 1.0}), Outages(0.3, 0.9)
    for _ in range(27):
        for bench in (seen, hidden, alone):
            bench.step()
    assert hidden.records[-1].status == Status.SERVOING
    assert hidden.records[-1].status_text == "servoing on foreseen features, target not seen for 0.57 s"
    assert alone.records[-1].status == Status.TARGET_LOST
    first = np.abs(seen.errors()[0]).max()
    assert np.abs(hidden.errors()[-1] - seen.errors()[-1]).max() < CURVED * first
    assert np.abs(hidden.q - seen.q).max() < CURVED < np.abs(alone.q - seen.q).max()
    hidden.run()
    hidden.assert_at_goal()


def test_after_the_time_allowed_the_arm_rests_and_the_status_says_so():
    bench = Outages(0.3, 5.0, filter={"outage_s": 0.5})
    for _ in range(30):
        command, record = bench.step()
    assert record.status == Status.TARGET_LOST and resting(command)
    assert [record.status for record in bench.records].count(Status.SERVOING) == 10 + 15


def test_a_target_that_was_never_seen_is_not_foreseen():
    bench = Outages(0.0, 1.0, filter={})
    assert bench.step()[1].status == Status.TARGET_LOST


def test_nothing_converges_on_foreseen_features():
    bench = Outages(0.03, 8.0, filter={"outage_s": 10.0}, thresholds=dict.fromkeys(("xn", "yn", "an", "alpha"), 0.01))
    for _ in range(150):
        bench.step()
    assert {record.status for record in bench.records} == {Status.SERVOING}
    assert np.abs(bench.errors()[-1]).max() < 0.01


@pytest.mark.parametrize("filtered", [True, False])
def test_a_moving_target_is_followed_while_it_is_not_seen(filtered):
    class Hidden(MovingBench):
        def look(self):
            seen = super().look()
            return replace(seen, features=Features()) if 4e9 < self.stamp_ns < 5e9 else seen

    more = {"filter": {"outage_s": 2.0, "acceleration": 0.3}} if filtered else {}
    bench = Hidden(evenly, feed_forward={}, **more)
    while bench.stamp_ns < 5e9:
        bench.step()
    if filtered:
        assert bench.off[-1] < 0.003  # a tenth of the target's way in that time
    else:
        assert bench.off[-1] > 0.02


def test_latency_that_makes_the_plain_loop_swing_is_compensated():
    late, gain = 6, {"gains_per_s": dict.fromkeys(("xn", "yn", "an", "alpha"), 8.0)}
    swings = Outages(late=late, **gain)
    steady = {"rate": 0.001, "acceleration": 0.001}
    calm = Outages(late=late, filter={"latency_s": late * 1e-9 * PERIOD_NS, **steady}, **gain)
    for _ in range(90):
        swings.step()
        calm.step()
    assert np.abs(swings.errors()[-20:]).max() > 0.1 * np.abs(swings.errors()[0]).max()
    assert np.abs(calm.errors()[-20:]).max() < 0.02 * np.abs(calm.errors()[0]).max()


@pytest.mark.parametrize("late", [1, 2, 6])
def test_the_camera_s_own_motion_in_the_latency_is_not_fed_forward_as_motion_of_the_target(late):
    more = {"filter": {"latency_s": late * 1e-9 * PERIOD_NS}, "track": True}
    alone, together = Outages(late=late, **more), Outages(late=late, feed_forward={}, **more)
    for _ in range(150):
        alone.step()
        together.step()
    first = np.abs(together.errors()[0]).max()
    assert np.abs(together.errors()[-30:]).max() < max(0.01 * first, 2.0 * np.abs(alone.errors()[-30:]).max())


def test_dropped_images_are_gone_over_with_the_time_that_has_passed():
    bench = Outages(dropped=range(6, 60, 2), filter={})
    for _ in range(60):
        bench.step()
    assert {record.status for record in bench.records} == {Status.SERVOING}
    assert np.abs(bench.records[-1].e).max() < CURVED * np.abs(bench.records[0].e).max()


def test_noise_of_the_features_becomes_smaller():
    def spread(**more):
        bench = Outages(noise=0.002, thresholds=dict.fromkeys(("xn", "yn", "an", "alpha"), 1e-9), **more)
        for _ in range(240):
            bench.step()
        return np.std(bench.errors()[120:, 0])

    assert spread(filter={"noise": 0.002, "acceleration": 0.01, "rate": 0.01}) < 0.6 * spread()


def test_foreseen_points_are_those_of_the_moved_camera():
    features, X = FeatureSet(POINTS), tilted_pose(2)
    filter, step = FeatureFilter(FilterSettings(), features, False), exponential(np.array([2, -1, 1, 1, 2, 3.0]) * 1e-3)
    filter.at(0, X, view(X).features, plane_of(X)).corrected(features.values(view(X)), view(X))
    for k in range(1, 21):
        X = X @ step
        s = filter.at(k * PERIOD_NS, X, None, plane_of(X)).foreseen()
    true = np.array(features.values(view(X)))
    assert np.abs(s - true).max() < CURVED * np.abs(true - features.values(view(tilted_pose(2)))).max()
    np.testing.assert_allclose(filter.features.point_x, s[0::2])


def test_the_pose_is_foreseen_by_the_joints():
    names = ("tx", "ty", "tz", "rx", "ry", "rz")
    more = {"law": "pbvs", "features": list(names), "pose_from": "points", "gains_per_s": dict.fromkeys(names, 3.0),
            "thresholds": dict.fromkeys(names, 1e-6)}
    seen, hidden = Outages(**more), Outages(0.3, 0.9, filter={"outage_s": 1.0}, **more)
    for _ in range(27):
        seen.step()
        hidden.step()
    assert hidden.records[-1].status_text.startswith("servoing on foreseen features")
    assert np.abs(hidden.q - seen.q).max() < CURVED


@pytest.mark.parametrize("angle", [1e-6, 0.3, 2.0])
def test_the_matrix_of_the_pose_is_its_derivative(angle):
    s = np.array([0.1, -0.2, 0.3, *(angle * np.array([0.6, 0.0, -0.8]))])
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = rotation(s[3:]), s[:3]
    assert_same(matrix_of_pose(s), differences(lambda X: np.concatenate([X[:3, 3], rotation_vector(X[:3, :3])]), pose))
