"""A target that is dragged where the arm cannot follow: the arm rests, says OUT_OF_REACH and where it would go on."""

import copy
import re

import numpy as np
import pytest

import aras_visual_servo as avs

#: The servo has begun before the target is moved, for so long [s].
BEGIN_S, DRAG_S = 3.0, 1.5
STILL_S = 1.0
JOINTS = ("gantry", "J1", "J2", "J3", "J5", "J6")


def dragged(name, ways, limit_s, servo=None):
    """(records of the servo, run record) of a scenario whose target is dragged along these ways from its place."""
    models = copy.deepcopy(avs.load_scenario(name).sim["scene"]["models"])
    here, turn = np.array(models[0]["position_m"]), models[0].get("rpy_rad", [0.0, 0.0, 0.0])
    points = [(0.0, here)]
    for begin_s, way in ways:
        points += [(begin_s, points[-1][1]), (begin_s + DRAG_S, here + way)]
    models[0]["motion"] = {"type": "waypoints", "waypoints": [
        {"time_s": t_s, "position_m": np.asarray(place).tolist(), "rpy_rad": turn} for t_s, place in points]}
    changes = {f"servo.{key}": value for key, value in (servo or {}).items()}
    scenario = avs.load_scenario(name, {"sim.scene.models": models, "servo.time_limit_s": limit_s, **changes})
    loop, records = avs.ServoLoop(scenario), []
    step = loop.sequence.step

    def told(observation):
        command, record = step(observation)
        if loop.sequence.servo_stamp_ns is not None:
            records.append(record)
        return command, record

    loop.sequence.step = told
    return records, loop.run(closing_s=0.0)


def named(text):
    """The directions that a text names, most missing first."""
    return re.search(r"would have to go on (.+?), as", text).group(1).split(" and ")


@pytest.mark.parametrize("name, way, servo", [
    ("experiment_1", [0.3, 0.0, 0.0], {}), ("experiment_1", [0.0, 0.0, -0.4], {}),
    ("experiment_1", [0.0, 0.0, 0.3], {}),
    ("experiment_1", [0.3, 0.0, 0.0], {"inverse.method": "plain"}),
    ("experiment_1", [0.3, 0.0, 0.0], {"inverse.at_limits": "saturate"}),
    ("experiment_1", [0.3, 0.0, 0.0], {"limits.joint_acceleration": dict.fromkeys(JOINTS, 3.0)}),
    ("experiment_1", [0.25, 0.0, 0.0], {"filter.noise": 0.001}),
    ("experiment_1", [0.25, 0.0, 0.0], {"feed_forward.part": 1.0}),
    ("experiment_1", [0.25, 0.0, 0.0], {"limits.camera_speed_m_s": 0.15}),
    ("six_dof_points", [-0.3, 0.0, 0.0], {}), ("six_dof_points", [0.0, 0.0, 0.3], {}),
    ("six_dof_qp", [-0.3, 0.0, 0.0], {})])
def test_the_arm_rests_and_names_the_direction(name, way, servo):
    records, _ = dragged(name, [(BEGIN_S, way)], 14.0, servo)
    end = records[-1]
    assert end.status == avs.Status.TIMED_OUT
    late = [record for record in records[:-1] if end.stamp_ns - record.stamp_ns < 1e9 * STILL_S]
    assert all(record.status == avs.Status.OUT_OF_REACH and not record.q_dot.any() for record in late)
    missing = named(late[-1].status_text)
    along = "forwards" if way[2] <= 0.0 else "backwards"
    assert missing[0] in (along, "up", "down") and named(end.status_text) == missing
    # The camera is above the target and looks down: it would go on along its axis towards a target that is too far.
    assert along in missing


def test_the_resting_place_is_the_nearest_in_what_the_arm_can_still_do():
    """Next to the stretched arm what is left of the law's twist is along the arm: both sideways errors are gone."""
    records, record = dragged("experiment_1", [(BEGIN_S, [0.3, 0.0, 0.0])], 14.0)
    e = dict(zip(records[-2].feature_names, records[-2].e))
    assert abs(e["xn"]) < 0.001 and abs(e["alpha"]) < 0.005 and e["an"] > 0.05 and e["yn"] > 0.03
    late = record.X_WC[record.servo_rows][-30:, :3, 3]
    assert np.ptp(late, axis=0).max() < 5e-4


def test_the_servo_goes_on_when_the_target_comes_back():
    records, record = dragged("experiment_1", [(BEGIN_S, [0.3, 0.0, 0.0]), (14.0, [0.0, 0.1, 0.0])], 25.0)
    assert avs.Status.OUT_OF_REACH in {record.status for record in records}
    assert records[-1].status == avs.Status.CONVERGED, records[-1].status_text
    assert avs.judge(record).final_error["angle_deg"] < 0.1


def test_a_slow_camera_is_not_out_of_reach():
    record = avs.ServoLoop(avs.load_scenario("experiment_1", {
        "servo.limits.camera_speed_m_s": 0.004, "servo.time_limit_s": 8.0})).run(closing_s=0.0)
    assert avs.Status.OUT_OF_REACH not in record.status


def test_a_joint_limit_that_other_joints_could_make_up_for_is_a_joint_limit(run):
    """As the scenario says, the goal is within reach; `at_limits: saturate` goes there."""
    record = run("naive_inverse")
    assert avs.Status.OUT_OF_REACH not in record.status
