"""The Python binding of the simulator: shapes, units, errors. What it computes is tested in C++."""
import gc
import pathlib
import threading

import numpy as np
import pytest
import yaml

from aras_visual_servo_sim import ParameterError, Simulation, StateError, UnknownNameError

FOLDER = pathlib.Path(__file__).resolve().parent.parent / "ros" / "robot"
URDF = (FOLDER / "pan_lift.urdf").read_text()
CONTROLLERS = yaml.safe_load((FOLDER / "controllers.yaml").read_text())
ROUNDING = 1e-12  # a few operations on numbers of order one


def make(**changes):
    config = yaml.safe_load((FOLDER / "sim.yaml").read_text())["sim"]
    config.update(changes)
    return Simulation(URDF, config, CONTROLLERS)


def test_joint_vectors_are_copies_in_the_order_of_joint_names():
    sim = make(initial_positions={"pan": 0.25})
    assert sim.joint_names == ["lift", "pan"]
    positions = sim.joint_positions
    assert positions.dtype == np.float64 and positions.shape == (2,)
    np.testing.assert_array_equal(positions, [0.0, 0.25])
    positions[:] = 7.0
    np.testing.assert_array_equal(sim.joint_positions, [0.0, 0.25])


def test_urdf_may_be_a_path_too():
    assert Simulation(str(FOLDER / "pan_lift.urdf"), {}, CONTROLLERS).joint_names == ["lift", "pan"]


def test_image_is_a_read_only_view_that_keeps_the_simulation_alive():
    sim = make()
    image = sim.render()
    assert image.shape == (48, 64, 3) and image.dtype == np.uint8
    assert not image.flags.writeable and not image.flags.owndata
    again = sim.render()
    assert again.ctypes.data == image.ctypes.data, "no copy is made"
    expected = image.copy()
    del sim, again
    gc.collect()
    np.testing.assert_array_equal(image, expected)


def test_mono_image_has_two_dimensions():
    camera = {"name": "camera", "frame": "eye_optical_frame", "width": 8, "height": 6, "horizontal_fov_rad": 1.0,
              "encoding": "mono8"}
    assert make(cameras=[camera]).render("camera").shape == (6, 8)


def test_target_in_the_middle_is_seen_in_the_middle():
    image = make().render()[:, :, 0].astype(float)
    darkness = 230.0 - image
    rows, columns = np.mgrid[0:48, 0:64]
    half_grey_level = 0.5 * image.size / darkness.sum() * 64  # rounding of every pixel to 8 bits, all one way
    assert abs((darkness * columns).sum() / darkness.sum() - 31.5) < half_grey_level
    assert abs((darkness * rows).sum() / darkness.sum() - 23.5) < half_grey_level
    assert image.min() == 20.0 and image.max() == 230.0


def test_camera_pose_looks_down_and_twist_is_zero_at_rest():
    sim = make()
    X_WC = sim.camera_pose("camera")
    np.testing.assert_allclose(X_WC, [[1, 0, 0, 0], [0, -1, 0, 0], [0, 0, -1, 0.5], [0, 0, 0, 1]], atol=ROUNDING)
    np.testing.assert_array_equal(sim.camera_twist("camera"), np.zeros(6))


def test_camera_info_has_the_shapes_of_the_message():
    info = make().camera_info("camera")
    assert (info["width"], info["height"], info["frame_id"]) == (64, 48, "eye_optical_frame")
    assert [len(info[key]) for key in ("K", "R", "P")] == [9, 9, 12]
    assert info["K"][2] == 31.5 and info["K"][5] == 23.5
    assert info["K"][0] == pytest.approx(32.0 / np.tan(0.5), abs=100 * ROUNDING)


def test_unknown_joint_raises_and_names_those_there_are():
    with pytest.raises(UnknownNameError, match="lift"):
        make().set_command(position={"elbow": 0.0})


def test_numpy_values_are_accepted_in_configurations():
    assert make(period_s=np.float64(0.002), gravity_m_s2=np.zeros(3)).period_ns == 2_000_000


def test_model_pose_round_trip():
    sim = make()
    sim.set_model_pose("target", [0.1, 0.2, 0.3], [0.0, 0.0, np.sin(0.25), np.cos(0.25)])
    expected = [[np.cos(0.5), -np.sin(0.5), 0, 0.1], [np.sin(0.5), np.cos(0.5), 0, 0.2], [0, 0, 1, 0.3], [0, 0, 0, 1]]
    np.testing.assert_allclose(sim.model_pose("target"), expected, atol=ROUNDING)


def test_saved_state_restores_the_run():
    sim = make()
    sim.set_command(position={"lift": 0.1})
    sim.step(100)
    state = sim.save_state()
    sim.step(100)
    later, hash_later = sim.joint_positions, sim.run_hash
    sim.restore_state(state)
    assert sim.ticks == 100
    sim.step(100)
    np.testing.assert_array_equal(sim.joint_positions, later)
    assert sim.run_hash == hash_later
    with pytest.raises(StateError):
        sim.restore_state(b"not a state")


def test_other_threads_run_while_it_steps():
    sim = make()
    seen = []
    stop = threading.Event()

    def watch():
        while not stop.is_set():
            seen.append(1)

    thread = threading.Thread(target=watch)
    thread.start()
    before = len(seen)
    sim.step(20000)
    during = len(seen) - before
    stop.set()
    thread.join()
    assert during > 0, "the GIL was held"


def test_models_move_by_themselves():
    sim = make()
    assert sim.model_names == ["target"]
    sim.set_model_motion("target", {"type": "constant_velocity", "linear_m_per_s": [0.1, 0.0, 0.0]})
    sim.step(500)
    np.testing.assert_allclose(sim.model_pose("target")[:3, 3], [0.05, 0.0, 0.0], atol=ROUNDING)
    np.testing.assert_array_equal(sim.model_twist("target"), [0.1, 0, 0, 0, 0, 0])
    sim.set_model_motion("target", None)
    np.testing.assert_array_equal(sim.model_twist("target"), np.zeros(6))
    with pytest.raises(ParameterError, match="dance"):
        sim.set_model_motion("target", {"type": "dance"})
    with pytest.raises(UnknownNameError, match="target"):
        sim.set_model_motion("moon", None)


def test_depth_and_segmentation_say_what_the_middle_sees():
    sim = make()
    depth, ids = sim.render_depth(), sim.render_segmentation("camera")
    assert depth.shape == ids.shape == (48, 64)
    assert depth.dtype == np.float32 and ids.dtype == np.uint16
    assert ids[24, 32] == sim.segmentation_ids["target"]
    height = sim.camera_pose()[2, 3] - sim.model_pose("target")[2, 3]
    assert abs(depth[24, 32] - height) < 1e-6 * height  # float32
    assert np.array_equal(np.isnan(depth), ids == 0) and ids[0, 0] == 0
    with pytest.raises(UnknownNameError):
        sim.render_depth("eye")


def test_triggered_camera_takes_what_was_asked_for():
    camera = {"name": "camera", "frame": "eye_optical_frame", "width": 8, "height": 6, "horizontal_fov_rad": 1.0,
              "triggered": True, "rate_hz": 100.0}
    sim = make(cameras=[camera])
    with pytest.raises(ParameterError, match="triggered"):
        sim.step_to_image("camera")
    sim.trigger("camera")
    assert sim.step_to_image("camera") == 10_000_000
    assert sim.dropped_frames == 0


def test_a_free_body_of_the_scene_falls_on_the_ground_and_starts_again_after_reset():
    solids = [{"name": "crate", "box_m": [0.1, 0.1, 0.1], "position_m": [0.5, 0.5, 0.2]}]
    sim = make(contacts={"ground_plane": {"z_m": 0.0, "friction": 0.5}, "free_bodies": {"crate": 1.0}},
               scene={"solids": solids})
    assert sim.model_pose("crate")[2, 3] == 0.2
    sim.step(1500)
    depth = 9.81 / 1e6 / 4  # four corners, each a spring of 1e6 N/m
    assert sim.model_pose("crate")[2, 3] == pytest.approx(0.05 - depth, abs=1e-8)
    state = sim.save_state()
    sim.set_model_pose("crate", [0.5, 0.5, 0.3], [0, 0, 0, 1])
    sim.step(50)
    fallen = sim.model_pose("crate")
    assert 0.27 < fallen[2, 3] < 0.3
    sim.restore_state(state)
    assert sim.model_pose("crate")[2, 3] == pytest.approx(0.05 - depth, abs=1e-8)
    sim.reset()
    assert sim.model_pose("crate")[2, 3] == 0.2


def test_a_spawned_body_touches_is_seen_touching_and_is_gone_after_reset():
    sim = make(contacts={"ground_plane": {"z_m": 0.0}})
    sim.spawn_model({"name": "ball", "sphere_m": 0.05, "mass_kg": 2.0, "position_m": [0.5, 0.5, 0.1]})
    assert sim.contacts == []
    sim.step(1500)
    (contact,) = sim.contacts
    assert (contact["a"], contact["b"]) == ("ball", "ground_plane")
    assert contact["force_n"] == pytest.approx([0, 0, 2.0 * 9.81], abs=1e-5)
    assert contact["normal"] == pytest.approx([0, 0, 1])
    sim.reset()
    assert "ball" not in sim.model_names


DRIVEN = {"base": "driven", "base_pose": {"position_m": [0.1, -0.2, 1.0], "rpy_rad": [3.0, 0.2, 0.4]},
          "cameras": [{"name": "camera", "frame": "eye_optical_frame", "width": 8, "height": 6,
                       "horizontal_fov_rad": 1.0, "rate_hz": 50.0}]}


def driven():
    return Simulation((FOLDER.parent.parent / "urdf" / "driven_camera.urdf").read_text(), DRIVEN)


CONE = {"name": "cone", "cone_m": [0.1, 0.2], "color_rgb": [0, 0, 0], "position_m": [0.5, 0.0, 0.12]}


def test_a_cone_stands_on_its_base():
    sim = make(contacts={"ground_plane": {"z_m": 0.0}}, scene={"solids": [{**CONE, "mass_kg": 1.0}]})
    sim.step(1500)
    assert sim.model_pose("cone")[2, 3] == pytest.approx(0.1, abs=1e-5)
    assert sim.model_pose("cone")[2, 2] == pytest.approx(1.0, abs=1e-9)


def test_a_cone_is_drawn_with_its_tip_up():
    camera = {"name": "camera", "frame": "eye_optical_frame", "width": 120, "height": 120, "horizontal_fov_rad": 0.5,
              "rate_hz": 50.0}
    sim = Simulation('<robot name="eye"><link name="eye_optical_frame"/></robot>', {
        "base_pose": {"position_m": [0.5, -1.0, 0.12], "rpy_rad": [-np.pi / 2.0, 0.0, 0.0]}, "cameras": [camera],
        "scene": {"background_rgb": [255, 255, 255], "solids": [CONE]}})
    widths = [int(row.sum()) for row in sim.render()[..., 0] < 128]
    seen = [width for width in widths if width]
    assert seen[0] <= 3 and len(seen) == pytest.approx(120 * 0.2 / (2 * np.tan(0.25)), abs=3)
    assert np.argmax(seen) >= len(seen) - 8 and max(seen) == pytest.approx(len(seen), abs=4)  # as wide as it is high


def test_a_driven_base_has_six_coordinates_in_the_place_of_joints():
    sim = driven()
    assert sim.joint_names == ["px", "py", "pz", "rx", "ry", "rz"] == sorted(sim.joint_names)
    np.testing.assert_array_equal(sim.joint_positions[:3], [0.1, -0.2, 1.0])
    sim.set_command(velocity={"px": 0.5, "rz": 1.0})
    sim.step(10)
    np.testing.assert_array_equal(sim.joint_velocities, [0.5, 0.0, 0.0, 0.0, 0.0, 1.0])
    sim.set_joint_positions({"rx": 0.0, "ry": np.pi, "rz": 0.0})
    np.testing.assert_allclose(sim.base_pose[:3, :3], np.diag([-1.0, 1.0, -1.0]), atol=ROUNDING)
    assert not sim.joint_velocities.any()


def test_a_twist_in_optical_axes_is_the_twist_of_the_camera():
    sim, twist = driven(), [0.1, -0.2, 0.3, 0.4, -0.5, 0.6]
    sim.set_twist(twist, "eye_optical_frame", stamp_ns=sim.time_ns)
    sim.step(5)
    np.testing.assert_allclose(sim.camera_twist(), twist, atol=ROUNDING)
    with pytest.raises(ParameterError, match="a link that the driven base carries"):
        sim.set_twist(twist, "world")
    sim.step()
    assert sim.refused_commands == 1 and not sim.camera_twist().any(), "a refused command holds"
    with pytest.raises(ParameterError, match="not driven"):
        make().set_twist(twist)


def test_a_driven_base_is_reset_and_restored_to_the_bit():
    def fly(sim, images):
        for _ in range(images):
            sim.step_to_image()
            sim.set_twist([0.1, 0.0, 0.0, 3.0, 2.0, 1.0])
        return sim.run_hash

    sim = driven()
    start, state = fly(sim, 5), sim.save_state()
    end = fly(sim, 60)
    sim.restore_state(state)
    assert sim.run_hash == start and fly(sim, 60) == end
    sim.reset()
    assert fly(sim, 5) == start and fly(driven(), 65) == end


def test_frames_that_are_taken_together():
    side = {"frame": "eye_optical_frame", "width": 400, "height": 400, "horizontal_fov_rad": 1.0, "rate_hz": 50.0}
    cameras = [dict(side, name="a"), dict(side, name="b", encoding="mono8")]
    together, in_turn = make(cameras=cameras), make(cameras=cameras)
    frames = together.take_frames([("a", True, True), ("b", False, False)])
    assert list(frames) == ["a", "b"] and frames["b"] == (None, None)
    in_turn.step_to_image("a")
    np.testing.assert_array_equal(frames["a"][0], in_turn.render("a"))
    np.testing.assert_array_equal(frames["a"][1], in_turn.render_depth("a"))
    in_turn.step_to_image("b")
    assert together.run_hash == in_turn.run_hash
    with pytest.raises(ParameterError, match="'a'"):
        together.take_frames([("a", True, False)])
    with pytest.raises(UnknownNameError):
        together.take_frames([("nobody", True, False)])


def test_a_frame_that_cannot_be_drawn_says_why():
    camera = {"name": "camera", "frame": "eye_optical_frame", "width": 16384, "height": 20, "horizontal_fov_rad": 1.0,
              "renderer": "opengl", "quality": "high"}  # drawn twice as wide, which is more than OpenGL can
    frames = make(cameras=[camera]).take_frames([("camera", True, False)])
    assert "32768" in frames["camera"]
