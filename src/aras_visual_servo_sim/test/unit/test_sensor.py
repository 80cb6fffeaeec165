"""Images of the simulator: noise of the sensor, frames, lights."""

import gc
import pathlib

import numpy as np
import pytest
import yaml
from test_simulation import make

from aras_visual_servo_sim import light_entry, ModelError, ParameterError, Simulation, UnknownNameError

CAMERA = {"name": "camera", "frame": "eye_optical_frame", "width": 64, "height": 48, "horizontal_fov_rad": 1.0}
BARE_SCENE = {"background_rgb": [200, 120, 60],
              "models": [{"name": "target", "outlines_m": [[[-0.1, -0.05], [0.1, -0.05], [0.1, 0.05], [-0.1, 0.05]]],
                          "motion": {"type": "constant_velocity", "linear_m_per_s": [0.5, 0.1, 0.0]}}]}


def sensed(sensor, **camera):
    return make(cameras=[{**CAMERA, **camera, "sensor": sensor}], scene=BARE_SCENE)


def images(sim, count=4):
    frames = []
    for _ in range(count):
        sim.step_to_image()
        frames.append(sim.render().copy())
    return frames


def test_bayer_image_has_one_value_a_pixel():
    image = sensed({"shot_noise": False}, encoding="bayer_grbg8").render()
    assert image.shape == (48, 64)
    np.testing.assert_allclose(image[0, :2], [120, 200], atol=1)
    np.testing.assert_allclose(image[1, :2], [60, 120], atol=1)


@pytest.mark.parametrize("renderer", ["coverage", "opengl"])
def test_reruns_and_resets_give_the_same_bytes(renderer):
    everything = {"dark_noise_e": 10.0, "prnu": 0.02, "dsnu_e": 10.0, "gamma": 2.2, "vignetting_exponent": 4.0,
                  "defocus_px": 2.0, "row_time_s": 1.0e-4, "jpeg_quality": 80, "auto_exposure": {"speed": 1.0},
                  "auto_white_balance": {}}
    sim, other = (sensed(everything, exposure_s=0.004, exposure_samples=2, renderer=renderer) for _ in range(2))
    first = images(sim)
    assert np.array_equal(first, images(other)) and sim.run_hash == other.run_hash
    sim.reset()
    assert np.array_equal(first, images(sim)) and sim.run_hash == other.run_hash
    state = sim.save_state()
    went_on = images(sim)
    sim.restore_state(state)
    assert np.array_equal(went_on, images(sim))


@pytest.mark.parametrize("renderer", ["coverage", "opengl"])
@pytest.mark.parametrize("deep, coarse", [("mono16", "mono8"), ("rgb16", "rgb8")])
def test_sixteen_bits_are_what_eight_bits_round(renderer, deep, coarse):
    cameras = [{**CAMERA, "name": name, "encoding": name, "renderer": renderer} for name in (deep, coarse)]
    sensors = [{**camera, "sensor": {"adc_bits": 12, "shot_noise": False}} for camera in cameras]
    noisy = [{**camera, "noise_stddev": 3.0} for camera in cameras]
    for pair in (cameras, sensors, noisy):
        sim = make(cameras=pair, scene={**BARE_SCENE, "solids": [{"name": "box", "box_m": [0.3, 0.2, 0.1]}]})
        fine, image = sim.render(deep), sim.render(coarse)
        assert fine.dtype == np.uint16 and fine.shape == image.shape and not fine.flags.writeable
        if pair is sensors:  # twelve bits above four that are 0
            assert np.array_equal(fine >> 8, image) and not (fine & 15).any() and (fine & 0xf0).any()
        elif pair is cameras:
            assert np.abs(fine / 257.0 - image).max() <= 0.51  # half a level, and a unit of 1/257 on the way
            assert len(np.unique(fine)) >= len(np.unique(image)) > 2
        else:
            assert (fine / 257.0 - 128.0).std() == pytest.approx((image - 128.0).std(), rel=0.1)
            assert (fine % 257 != 0).mean() > 0.9  # noise finer than a level


def test_sixteen_bits_are_part_of_saved_states_and_of_late_frames():
    sim, other = (sensed({"adc_bits": 12, "auto_exposure": {"speed": 1.0}}, encoding="mono16", latency_s=0.05)
                  for _ in range(2))
    images(sim)
    state = sim.save_state()
    went_on = images(sim)
    other.restore_state(state)
    assert went_on[0].dtype == np.uint16 and np.array_equal(went_on, images(other)) and sim.run_hash == other.run_hash


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


FOLDER = pathlib.Path(__file__).resolve().parent.parent / "ros" / "robot"
SUN = {"name": "sun", "type": "directional", "direction": [0, 0, -1], "color_rgb": [40, 40, 40]}
LAMP = {"name": "lamp", "type": "point", "position_m": [0.0, 0.0, 0.4], "color_rgb": [255, 128, 0]}


def simulation():
    config = yaml.safe_load((FOLDER / "sim.yaml").read_text())["sim"]
    config["cameras"][0].update(renderer="opengl", encoding="rgb8")
    config["scene"]["solids"] = [{"name": "floor", "box_m": [2, 2, 0.01], "position_m": [0, 0, -0.1]}]
    config["scene"]["lighting"] = {"lights": [SUN]}
    return Simulation((FOLDER / "pan_lift.urdf").read_text(), config)


def test_lights_are_set_seen_and_deleted():
    sim = simulation()
    before = sim.render("camera").copy()
    sim.set_light(LAMP)
    assert sim.lights["lamp"]["position_m"] == [0.0, 0.0, 0.4] and sim.lights["lamp"]["type"] == "point"
    assert sim.lights["lamp"]["color_rgb"] == pytest.approx([255, 128, 0])
    lit = sim.render("camera").astype(int) - before
    assert lit[5, 5, 0] > lit[5, 5, 1] + 20 and lit[5, 5, 2] == 0, "orange light falls on the floor"
    sim.set_light(dict(sim.lights["lamp"], intensity=0.0))
    assert (sim.render("camera") == before).all()
    sim.delete_light("lamp")
    assert list(sim.lights) == ["sun"]


def test_sdf_is_read():
    entry = light_entry("<light name='1' type='spot'><spot><outer_angle>1</outer_angle></spot>"
                        "<cast_shadows>1</cast_shadows></light>")
    assert entry["name"] == "1" and entry["casts_shadows"] is True and entry["outer_angle_rad"] == 1.0
    sim = simulation()
    sim.set_light("<light name='1' type='spot'><spot><outer_angle>1</outer_angle></spot></light>")
    assert list(sim.lights) == ["sun", "1"]


@pytest.mark.parametrize("light, error, named", [
    (dict(LAMP, attached_to="nowhere"), ParameterError, "nowhere"),
    ({"name": "sun", "type": "directional"}, ParameterError, "direction"),
    ("<light name='a' type='laser'/>", ModelError, "laser"), ({"name": "a"}, ParameterError, "type")])
def test_what_cannot_be_is_named(light, error, named):
    sim = simulation()
    with pytest.raises(error, match=named):
        sim.set_light(light)
    with pytest.raises(UnknownNameError, match="lights: sun"):
        sim.delete_light("a")
