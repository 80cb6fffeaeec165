"""One Frame for in-process use: the image and what was true when it was exposed."""
import gc

import numpy as np
import pytest
from test_simulation import make

from aras_visual_servo_sim import UnknownNameError

CAMERA = {"name": "camera", "frame": "eye_optical_frame", "width": 64, "height": 48, "horizontal_fov_rad": 1.0}
MOTION = {"type": "constant_velocity", "linear_m_per_s": [0.3, 0.1, 0.0]}
OUTLINE = [[[-0.1, -0.05], [0.1, -0.05], [0.1, 0.05], [-0.1, 0.05]]]
SCENE = {"models": [{"name": "target", "outlines_m": OUTLINE, "motion": MOTION}],
         "solids": [{"name": "crate", "box_m": [0.04, 0.04, 0.04], "position_m": [0.05, -0.05, 0.0]}]}


def moving(**camera):
    sim = make(cameras=[{**CAMERA, **camera}], scene=SCENE)
    sim.set_command(velocity={"pan": 0.5})
    return sim


def test_frame_has_what_the_functions_beside_it_return():
    sim, other = moving(), moving()
    for _ in range(3):
        stamp_ns = sim.step_to_image()
        frame = sim.frame("camera")
        other.step_to_image()
        assert frame.stamp_ns == stamp_ns
        np.testing.assert_array_equal(frame.image, other.render("camera"))
        np.testing.assert_array_equal(frame.joint_positions, other.joint_positions)
        np.testing.assert_array_equal(frame.joint_velocities, other.joint_velocities)
        np.testing.assert_array_equal(frame.camera_pose, other.camera_pose("camera"))
        np.testing.assert_array_equal(frame.camera_twist, other.camera_twist("camera"))
        assert sorted(frame.model_poses) == ["crate", "target"]
        for name, X_WM in frame.model_poses.items():
            np.testing.assert_array_equal(X_WM, other.model_pose(name))
    assert sim.run_hash == other.run_hash


def test_frame_of_a_late_camera_is_that_of_its_stamp():
    prompt, late = moving(), moving(latency_s=0.08)
    for _ in range(3):
        prompt.step_to_image()
        late.step_to_image()
        expected, found = prompt.frame(), late.frame()
        assert found.stamp_ns == expected.stamp_ns < late.time_ns
        np.testing.assert_array_equal(found.image, expected.image)
        np.testing.assert_array_equal(found.joint_positions, expected.joint_positions)
        np.testing.assert_array_equal(found.camera_pose, expected.camera_pose)
        np.testing.assert_array_equal(found.model_poses["target"], expected.model_poses["target"])


def test_frame_stays_what_it_was_when_time_goes_on():
    sim = moving()
    sim.step_to_image()
    frame = sim.frame()
    before = frame.stamp_ns, frame.joint_positions, frame.camera_pose, frame.model_poses["target"]
    sim.step(50)
    assert not np.array_equal(sim.joint_positions, before[1])
    assert not np.array_equal(sim.model_pose("target"), before[3])
    after = frame.stamp_ns, frame.joint_positions, frame.camera_pose, frame.model_poses["target"]
    for expected, found in zip(before, after):
        np.testing.assert_array_equal(found, expected)
    with pytest.raises(AttributeError):
        frame.stamp_ns = 0


def test_image_of_a_frame_is_a_read_only_view_that_keeps_the_simulation_alive():
    sim = moving()
    frame = sim.frame()
    assert frame.image.ctypes.data == sim.render().ctypes.data, "no copy is made"
    assert not frame.image.flags.writeable
    expected = frame.image.copy()
    del sim
    gc.collect()
    np.testing.assert_array_equal(frame.image, expected)


def test_frame_of_an_unknown_camera_names_those_there_are():
    with pytest.raises(UnknownNameError, match="camera"):
        make().frame("nose")
