"""Arms next to a stop, and an arm that is not ours: six axes on a table, the camera on the flange."""

import numpy as np
import pytest

import aras_visual_servo as avs

STOP_M = 1.49  # gantry limit, margin taken off


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


#: Published Denavit-Hartenberg parameters of the UR5e: a [m], d [m], alpha [rad], from base to flange.
DH = [(0.0, 0.1625, np.pi / 2), (-0.425, 0.0, 0.0), (-0.3922, 0.0, 0.0), (0.0, 0.1333, np.pi / 2),
      (0.0, 0.0997, -np.pi / 2), (0.0, 0.0996, 0.0)]
CHAIN = ("shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint", "wrist_1_joint", "wrist_2_joint", "wrist_3_joint")
CAMERA_M = 0.04  # of the optical centre before the flange
#: Angles of the URDF are written with ten digits; eight rotations at a metre.
ROUNDING_M = 1e-8


def flange(angles):
    """X_BE of the published table."""
    X = np.eye(4)
    for angle, (a, d, alpha) in zip(angles, DH):
        c, s, ca, sa = np.cos(angle), np.sin(angle), np.cos(alpha), np.sin(alpha)
        X = X @ np.array([[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0.0, sa, ca, d],
                          [0.0, 0.0, 0.0, 1.0]])
    return X


def test_the_kinematics_are_the_published_ones():
    scenario = avs.load_scenario("six_axis_flange")
    kinematics = avs.Kinematics(scenario.urdf_xml(), scenario.robot["base_link"], scenario.robot["tip_link"])
    assert set(kinematics.joint_names) == set(CHAIN)
    for angles in np.random.default_rng(5).uniform(-3.0, 3.0, size=(20, 6)):
        X = flange(angles)
        X[:3, 3] += CAMERA_M * X[:3, 2]
        np.testing.assert_allclose(kinematics.pose(kinematics.vector(dict(zip(CHAIN, angles)))), X, atol=ROUNDING_M)


def test_it_arrives_judged_by_the_true_camera_pose(run):
    record = run("six_axis_flange")
    judgement = avs.judge(record)
    assert judgement.passed, judgement.faults
    assert judgement.initial_error["angle_deg"] > 10.0 and abs(judgement.initial_error["x_mm"]) > 30.0
    assert record.joint_names == tuple(sorted(CHAIN))
    for axis in ("x_mm", "y_mm", "z_mm"):
        assert judgement.final_error[axis] == pytest.approx(0.0, abs=0.5)
