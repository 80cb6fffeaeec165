"""Keypoints with depths of the depth image: scenes that are no plane, planes that nobody told, and no depth."""

import numpy as np
import pytest

from aras_visual_servo import load_scenario, ServoLoop, Status

PICTURE = "package://aras_description/targets/photo.png"
#: A picture on the floor of the scene, and two that stand before it, one of them aslant.
STEPS = [{"name": "target", "image": {"file": PICTURE, "size_m": [1.6, 1.2]}, "position_m": [0.057549, 0.05, 0.225455],
          "rpy_rad": [0.0, 0.0, 1.5707963]},
         {"name": "step", "image": {"file": PICTURE, "size_m": [0.32, 0.24]}, "position_m": [0.15, 0.0, 0.375455]},
         {"name": "ramp", "image": {"file": PICTURE, "size_m": [0.32, 0.24]}, "position_m": [-0.05, 0.15, 0.345455],
          "rpy_rad": [0.5, 0.0, 1.0]}]
#: Three quarters as wide as the scenario's own, so that a run takes two thirds of the time.
CAMERA = {"name": "camera", "frame": "camera_optical_frame", "width": 480, "height": 360, "horizontal_fov_rad": 1.41,
          "rate_hz": 30.0, "encoding": "rgb8"}
DEPTH = {"vision.matches": {"detector": "orb", "depth": {}}}
#: Nobody knows the plane: the normal and the depth that the scenario tells are wrong.
UNKNOWN = {"servo.target_normal_C": [0.6, 0.0, 0.8], "experiment.z_star_m": 2.0}
PBVS = {"servo.law": "pbvs", "servo.features": ["tx", "ty", "tz", "rx", "ry", "rz"], "servo.pose_from": "depth",
        "servo.gains_per_s": dict.fromkeys(("tx", "ty", "tz", "rx", "ry", "rz"), 2.0),
        "servo.thresholds": dict.fromkeys(("tx", "ty", "tz", "rx", "ry", "rz"), 0.002)}


@pytest.mark.parametrize("changes", [{}, {"sim.scene.models": STEPS}, {"sim.scene.models": STEPS, **PBVS}],
                         ids=["plane", "steps", "steps pbvs"])
def test_the_camera_comes_home_without_being_told_where_anything_is(changes):
    pytest.importorskip("aras_visual_servo_sim")
    import aras_visual_servo as avs
    from aras_visual_servo.runs.judge import judge
    record = avs.run(load_scenario("six_dof_matches", {"sim.cameras": [CAMERA], **DEPTH, **UNKNOWN, **changes}))
    judgement = judge(record)
    assert judgement.passed, judgement.faults


def to_servo(changes):
    there = load_scenario("six_dof_matches").experiment["goal"]["joints"]  # so that servoing begins soon
    loop = ServoLoop(load_scenario("six_dof_matches", {
        "experiment.settle_s": 0.1, "sim.initial_positions": there, **DEPTH, **changes}))
    loop.start()
    while loop.sequence.phase != "servo":
        assert loop.sequence.phase != "done", loop.sequence.result.reason
        loop.step()
    return loop


def test_the_four_points_are_where_the_camera_moved_to():
    pytest.importorskip("aras_visual_servo_sim")
    loop = to_servo({"sim.scene.models": STEPS})
    goal = loop.servo.reference.view
    X_WCg = loop.kinematics.pose(loop.kinematics.vector(loop.servo.reference.posture))
    loop.step()
    seen = loop.servo_extractor.features
    P = np.array([goal.point_x, goal.point_y, np.ones(4)]) * goal.point_z
    there = (np.linalg.inv(loop.camera_pose()) @ X_WCg @ np.r_[P, np.ones((1, 4))])[:3]
    np.testing.assert_allclose([seen.point_x, seen.point_y], there[:2] / there[2], atol=3.0 / 376.0)  # ORB: some px
    np.testing.assert_allclose(seen.point_z, there[2], rtol=0.01)
    assert seen.inliers > 100 and seen.rms_px < 2.0 and 0.4 < goal.point_z[0] < 0.7


@pytest.mark.parametrize("value, text", [
    (float("nan"), "the depth image has holes: of"), (None, "no depth image came with the image")])
def test_depth_that_is_gone_stops_the_arm_with_the_reason(value, text):
    pytest.importorskip("aras_visual_servo_sim")
    loop = to_servo({})

    class Spoilt:
        def __getattr__(self, name):
            return getattr(loop_sim, name)

        def render_depth(self, camera):
            return None if value is None else np.full_like(loop_sim.render_depth(camera), value)

    loop_sim, loop.sim = loop.sim, Spoilt()
    record, _, _ = loop.step()
    assert record.status == Status.TARGET_LOST
    assert text in record.status_text
    assert np.array_equal(record.q_dot, np.zeros(len(record.q_dot)))
