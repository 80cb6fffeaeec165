"""A camera with a sensor, in process: keys from Python, shapes, reruns. What the sensor does is tested in C++."""
import numpy as np
import pytest
from test_simulation import make

CAMERA = {"name": "camera", "frame": "eye_optical_frame", "width": 64, "height": 48, "horizontal_fov_rad": 1.0}
SCENE = {"background_rgb": [200, 120, 60],
         "models": [{"name": "target", "outlines_m": [[[-0.1, -0.05], [0.1, -0.05], [0.1, 0.05], [-0.1, 0.05]]],
                     "motion": {"type": "constant_velocity", "linear_m_per_s": [0.5, 0.1, 0.0]}}]}


def sensed(sensor, **camera):
    return make(cameras=[{**CAMERA, **camera, "sensor": sensor}], scene=SCENE)


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
        sim = make(cameras=pair, scene={**SCENE, "solids": [{"name": "box", "box_m": [0.3, 0.2, 0.1]}]})
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
