"""The servo on followed points, each law: home on the arm; still on points that are not there or not numbers."""

import numpy as np
import pytest
from bench import Bench
from toy_plant import pose_error

from aras_visual_servo import expand, Status

POINTS = expand(["points5"])
POSE, HYBRID = ("tx", "ty", "tz", "rx", "ry", "rz"), ("xr", "yr", "zr", "rx", "ry", "rz")
LAWS = {
    "ibvs": ("ibvs", POINTS, {"interaction": "mean"}),
    "ibvs at the goal's depth": ("ibvs", POINTS, {"interaction": "current", "point_depth": "goal"}),
    "pbvs": ("pbvs", POSE, {"pose_from": "points"}),
    "hybrid": ("hybrid", HYBRID, {"pose_from": "points"}),
    "sliding": ("sliding", POINTS, {"sliding": {"switching_per_s": 2.0, "boundary": dict.fromkeys(POINTS, 0.01)}}),
    "broyden": ("broyden", POINTS, {}),
    "broyden from test moves": ("broyden", POINTS, {"broyden": {"initial": "moves"}}),
}


def bench_of(kind):
    law, features, more = LAWS[kind]
    return Bench(law=law, features=list(features), gains_per_s=dict.fromkeys(features, 2.0),
                 thresholds=dict.fromkeys(features, 1e-5), time_limit_s=30.0, **more)


@pytest.mark.parametrize("kind", [kind for kind in LAWS if "test moves" not in kind])
def test_camera_comes_home(kind):
    """The five-axis arm cannot tilt about one axis: it is right again at the goal, where the features are."""
    bench = bench_of(kind)
    assert bench.run(900).status == Status.CONVERGED, bench.records[-1].status_text
    distance, angle = pose_error(bench.X_WG, bench.arm.pose(bench.q))
    assert distance < 1e-3 and angle < 2e-3  # thresholds of 1e-5 over the smallest singular value, about 0.01


def still(command):
    return not command.position and set(command.velocity.values()) == {0.0}


@pytest.mark.parametrize("kind", LAWS)
def test_points_that_are_not_there_leave_the_arm_still_until_they_are(kind):
    bench = bench_of(kind)
    bench.step()
    for x, y in (((), ()), ((0.1,), (0.1,)), ((0.1, 0.2, 0.3, 0.4, 0.5), ())):
        view = bench.look()
        view.features.point_x, view.features.point_y = x, y
        command, record = bench.step(view)
        assert record.status == Status.TARGET_LOST and still(command), (x, record.status_text)
    _, record = bench.step()
    assert record.status in (Status.SERVOING, Status.NEAR_SINGULARITY)


@pytest.mark.parametrize("bad", [np.nan, np.inf])
@pytest.mark.parametrize("kind", LAWS)
def test_points_that_are_no_numbers_are_a_fault_with_the_arm_still(kind, bad):
    bench = bench_of(kind)
    bench.step()
    view = bench.look()
    view.features.point_y[2] = bad
    command, record = bench.step(view)
    assert record.status == Status.FAULT and "not finite" in record.status_text and still(command)


@pytest.mark.parametrize("kind", ["pbvs", "hybrid"])
def test_points_in_another_order_are_refused(kind):
    bench = bench_of(kind)
    bench.step()
    view = bench.look()
    view.features.point_x, view.features.point_y = (
        [p[k] for k in (1, 0, 2, 4, 3)] for p in (view.features.point_x, view.features.point_y))
    command, record = bench.step(view)
    assert record.status == Status.TARGET_LOST and "no pose explains" in record.status_text and still(command)
