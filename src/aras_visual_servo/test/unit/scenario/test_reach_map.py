"""The map of the reach, against the inverse kinematics that tries other postures too."""

import numpy as np
import pytest

from aras_visual_servo import Kinematics, Servo, load_scenario, reach, reach_map, spatial
from aras_visual_servo.arm.reach import outside_limits
from aras_visual_servo.scenario import reach_map as module

SIDE = 9
#: Places that are nearer to the limit of the reach than this are left out: both searches end somewhere there [m].
NEAR_M = 0.003


@pytest.fixture(scope="module")
def scenario():
    return load_scenario("experiment_1")


def map_of(scenario, monkeypatch, turn=0.0, side=SIDE):
    monkeypatch.setattr(module, "SIDE", side)
    kinematics = scenario.kinematics(calibrated=False)
    q = scenario.goal_posture(kinematics)
    X_WC, model = kinematics.pose(q), scenario.sim["scene"]["models"][0]
    X_WT = spatial.pose_from_rpy(model["position_m"], model["rpy_rad"])
    turned = X_WT @ spatial.transform(spatial.rotation([0.0, 0.0, turn]), np.zeros(3))
    servo = Servo(kinematics, scenario.servo)
    return kinematics, q, X_WT, X_WC, reach_map(scenario, kinematics, servo, X_WC, X_WT, turned, q)


def places(found):
    """Each place: its pose in the world, and what is missing [m]."""
    for y, row in enumerate(found.missing_m):
        for x, missing_m in enumerate(row):
            at = found.first_m + found.step_m * (x, y)
            yield found.X_WP @ spatial.transform(np.eye(3), [*at, 0.0]), missing_m


@pytest.mark.parametrize("turn", [0.0, 1.0])
def test_the_camera_comes_to_the_places_within_reach_and_to_no_others(scenario, monkeypatch, turn):
    kinematics, q, X_WT, X_WC, found = map_of(scenario, monkeypatch, turn)
    counts = {True: 0, False: 0}
    for X, missing_m in places(found):
        joints, _ = reach(kinematics, q, X @ spatial.inverse(X_WT) @ X_WC)
        can = joints is not None and not outside_limits(kinematics, joints)
        if missing_m == 0.0 or missing_m > NEAR_M:
            assert can == (missing_m == 0.0), (X[:3, 3], missing_m)
            counts[can] += 1
    assert min(counts.values()) > SIDE


def test_the_map_goes_beyond_the_reach_on_every_side(scenario, monkeypatch):
    missing_m = map_of(scenario, monkeypatch)[4].missing_m
    assert (missing_m == 0.0).any()
    for edge in (missing_m[0], missing_m[-1], missing_m[:, 0], missing_m[:, -1]):
        assert (edge > 0.0).all()


def test_limits_count(scenario, monkeypatch):
    """A gantry that ends at 0.5 m takes the places beyond it away."""
    urdf = scenario.urdf_xml()
    wide = map_of(scenario, monkeypatch, side=19)[4]
    short = Kinematics(urdf, "world", "camera_optical_frame")
    short.upper = np.where(np.array(short.joint_names) == "gantry", 0.5, short.upper)
    q = scenario.goal_posture(short)
    X_WT, X_WC = wide.X_WP, short.pose(q)
    found = reach_map(scenario, short, Servo(short, scenario.servo), X_WC, X_WT, X_WT, q)
    reached = [max(X[1, 3] for X, missing_m in places(one) if missing_m == 0.0) for one in (wide, found)]
    assert 0.3 < reached[1] < 0.6 < 1.2 < reached[0]
