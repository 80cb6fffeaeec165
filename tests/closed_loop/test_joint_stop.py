"""Next to a joint's stop: the plain pseudo-inverse stalls, redundancy arrives. Judged by the true camera pose."""
import numpy as np
import pytest

import aras_visual_servo as avs


STOP_M = 1.49  # gantry limit, margin taken off
DIFFER = {"name", "description", "servo.inverse.method", "servo.inverse.at_limits",
          "servo.null_space.posture_gain_per_s", "servo.null_space.joint_limit_gain_per_s",
          "servo.null_space.max_speed"}


def leaves(tree, path=""):
    if not isinstance(tree, dict):
        return {path: tree}
    found = {}
    for key, value in tree.items():
        found.update(leaves(value, f"{path}.{key}" if path else key))
    return found


def test_the_two_scenarios_differ_in_the_inverse_alone():
    one, other = (leaves(avs.load_scenario(name).as_dict()) for name in ("naive_inverse", "redundant"))
    assert {key for key in one.keys() | other.keys() if one.get(key) != other.get(key)} <= DIFFER


def test_the_naive_inverse_runs_into_the_stop_and_stands_still(run):
    record = run("naive_inverse")
    judgement = avs.judge(record)
    assert not judgement.converged and record.status[record.servo_rows[-1]] == avs.Status.TIMED_OUT
    gantry = record.q[record.servo_rows, record.joint_names.index("gantry")]
    assert gantry.max() == pytest.approx(STOP_M, abs=2e-3)  # sag of the joint controller below 2 mm
    status = record.status[record.servo_rows]
    assert (status == avs.Status.JOINT_LIMIT).mean() > 0.9
    late = record.X_WC[record.servo_rows][-60:, :3, 3]
    assert np.ptp(late, axis=0).max() < 1e-3  # two seconds, less than a millimetre
    assert np.linalg.norm([judgement.final_error[axis] for axis in ("x_mm", "y_mm", "z_mm")]) > 20.0


def test_redundancy_takes_the_arm_past_the_stop_to_its_goal(run):
    record = run("redundant")
    judgement = avs.judge(record)
    assert judgement.passed, judgement.faults
    assert avs.Status.JOINT_LIMIT in record.status[record.servo_rows]  # it was at the stop as well
    assert np.nanmax(record.q[:, record.joint_names.index("gantry")]) < 1.5
