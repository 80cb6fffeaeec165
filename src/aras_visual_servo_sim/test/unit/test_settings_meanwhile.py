"""Settings of cameras and light that change while time goes on."""
import numpy as np
import pytest
from test_simulation import make

from aras_visual_servo_sim import ParameterError

CAMERA = {"name": "camera", "frame": "eye_optical_frame", "width": 64, "height": 48, "horizontal_fov_rad": 1.0}
SCENE = {"background_rgb": [200, 120, 60],
         "models": [{"name": "target", "outlines_m": [[[-0.1, -0.05], [0.1, -0.05], [0.1, 0.05], [-0.1, 0.05]]],
                     "motion": {"type": "constant_velocity", "linear_m_per_s": [0.5, 0.1, 0.0]}}]}
SENSOR = {"dark_noise_e": 10.0, "auto_exposure": {"speed": 1.0}}


def config(scene=None, **camera):
    return {"cameras": [{**CAMERA, **camera}], "scene": {**SCENE, **(scene or {})}}


def simulation(scene=None, **camera):
    return make(**config(scene, **camera))


def images(sim, count):
    frames = []
    for _ in range(count):
        stamp_ns = sim.step_to_image()
        frames.append((stamp_ns, sim.render().copy()))
    return frames


def same(some, others):
    return len(some) == len(others) and all(a[0] == b[0] and np.array_equal(a[1], b[1]) for a, b in zip(some, others))


@pytest.mark.parametrize("setting", [
    {"noise_stddev": 5.0}, {"noise_mean": 9.0, "noise_stddev": 1.0}, {"sampling": "center"},
    {"renderer": "opengl", "exact_targets": False}, {"drop_probability": 0.5}, {"sensor": {"dark_noise_e": 30.0}}])
def test_from_the_next_image_on_it_is_as_if_it_had_always_been_so(setting):
    sim, always = simulation(), simulation(**setting)
    images(sim, 3)
    sim.set_cameras(config(**setting))
    now_ns = sim.time_ns
    after = images(sim, 4)
    assert same(after, [frame for frame in images(always, 14) if frame[0] > now_ns][:4])
    plain = simulation()
    images(plain, 3)
    assert not same(after, images(plain, 4))
    sim.reset()
    always.reset()
    assert same(images(sim, 3), images(always, 3)), "a reset keeps what was set"


def test_an_exposure_begins_anew():
    sim, sharp = simulation(), simulation()
    images(sim, 3), images(sharp, 3)
    sim.set_cameras(config(exposure_s=0.02, exposure_samples=8))
    (_, blurred), (_, clear) = images(sim, 1)[0], images(sharp, 1)[0]
    assert len(np.unique(blurred)) > len(np.unique(clear)) and sim.time_ns == sharp.time_ns
    sim.set_cameras(config())
    assert np.array_equal(images(sim, 1)[0][1], images(sharp, 1)[0][1])


def test_images_come_later_from_then_on_and_in_time_again():
    sim = simulation()
    images(sim, 3)
    sim.set_cameras(config(latency_s=0.05))
    late = []
    for _ in range(4):
        stamp_ns = sim.step_to_image()
        late.append((stamp_ns, sim.time_ns - stamp_ns))
    assert {delay_ns for _, delay_ns in late} == {50_000_000}
    sim.set_cameras(config())
    after = [(stamp_ns, sim.time_ns) for stamp_ns, _ in (images(sim, 1)[0] for _ in range(3))]
    assert all(stamp_ns == now_ns for stamp_ns, now_ns in after) and after[0][0] > late[-1][0]


def test_frames_on_their_way_come_as_the_new_latency_lets_them():
    sim, plain = simulation(latency_s=0.1), simulation()
    truth = dict(images(plain, 12))
    images(sim, 2)  # two more are on their way
    sim.set_cameras(config(latency_s=0.12))
    frames = images(sim, 4)
    assert [b[0] - a[0] < 40_000_000 for a, b in zip(frames, frames[1:])] == [True] * 3, "none is lost"
    assert all(np.array_equal(truth[stamp_ns], image) for stamp_ns, image in frames)


def test_a_sensor_keeps_what_it_has_set_by_itself():
    sim, other = simulation(sensor=SENSOR), simulation(sensor=SENSOR)
    images(sim, 6), images(other, 6)
    sim.set_cameras(config(sensor=SENSOR))
    assert same(images(sim, 3), images(other, 3))


def test_what_an_image_shows_stays_where_it_is():
    sim = simulation()
    sim.step_to_image()
    image = sim.render()
    before = image.copy()
    sim.set_cameras(config(noise_stddev=3.0))
    assert np.array_equal(image, before)


@pytest.mark.parametrize("camera, named", [
    ({"width": 80}, "size"), ({"height": 50}, "size"), ({"horizontal_fov_rad": 1.1}, "intrinsics"),
    ({"rate_hz": 20.0}, "rate_hz"), ({"encoding": "mono8"}, "encoding"), ({"name": "other"}, "name"),
    ({"distortion_model": "plumb_bob", "distortion": [0.01, 0.0, 0.0, 0.0, 0.0]}, "distortion"),
    ({"noise_stddev": -1.0}, "noise_stddev"), ({"baseline_m": 0.1}, "baseline_m")])
def test_what_camera_info_tells_stays(camera, named):
    sim = simulation()
    images(sim, 2)
    with pytest.raises(ParameterError, match=named):
        sim.set_cameras(config(**camera))
    other = simulation()
    images(other, 2)
    assert same(images(sim, 2), images(other, 2))


def test_the_number_of_cameras_stays():
    sim = simulation()
    with pytest.raises(ParameterError, match="found 0, allowed 1"):
        sim.set_cameras({"cameras": []})


@pytest.mark.parametrize("renderer", ["coverage", "opengl"])
def test_background_and_lights_change_and_stay_after_a_reset(renderer):
    lit = {"background_rgb": [10, 20, 30], "lighting": {"ambient_rgb": [90, 90, 90]}}
    sim, always = simulation(renderer=renderer), simulation(lit, renderer=renderer)
    images(sim, 2), images(always, 2)
    sim.set_lighting(config(lit, renderer=renderer))
    assert same(images(sim, 2), images(always, 2))
    sim.reset()
    always.reset()
    assert same(images(sim, 2), images(always, 2))


def test_lights_that_were_set_otherwise_stay():
    sim = simulation({"lighting": {"lights": [{"name": "sun", "type": "directional", "direction": [0, 0, -1]}]}},
                     renderer="opengl")
    sim.set_light({"name": "lamp", "type": "point", "position_m": [0.0, 0.0, 0.4]})
    moon = {"name": "moon", "type": "directional", "direction": [0, 1, -1]}
    sim.set_lighting(config({"lighting": {"lights": [moon]}}))
    assert sorted(sim.lights) == ["lamp", "moon"]
    sim.reset()
    assert sorted(sim.lights) == ["moon"]
