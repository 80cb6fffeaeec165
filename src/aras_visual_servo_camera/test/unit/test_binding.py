"""Python binding: shapes, errors and names; the numbers are judged by the C++ tests."""

import math
import re
import subprocess
import sys

import numpy as np
import pytest

import aras_visual_servo_camera as camera

INFO = {
    "width": 320,
    "height": 240,
    "K": [195.05, 0.0, 159.5, 0.0, 195.05, 119.5, 0.0, 0.0, 1.0],
    "D": [0.0] * 5,
    "distortion_model": "plumb_bob",
    "P": [0.0] * 12,
    "R": [1.0, 0, 0, 0, 1, 0, 0, 0, 1],
    "frame_id": "camera_optical_frame",
}
VISION = {"object": "dark", "segmentation": "coverage"}
ROUNDING = 1e-12  # sums of some thousand terms of order 1e-5


def image_with_wedge(shape=(240, 320), u0=100, v0=80):
    """A right-angled staircase, 60 x 30 pixels: asymmetric."""
    image = np.full(shape, 230, np.uint8)
    for row in range(30):
        image[v0 + row, u0 : u0 + 2 * (row + 1)] = 20
    return image


def test_features_are_those_of_the_pixels():
    features = camera.MomentExtractor(INFO, VISION).process(image_with_wedge())
    v, u = np.nonzero(image_with_wedge() == 20)
    assert features.target_visible and features.valid and not features.touches_border
    assert features.components == 1
    assert features.area == pytest.approx(len(u) / 195.05**2, rel=ROUNDING)
    assert features.xg == pytest.approx((u.mean() - 159.5) / 195.05, abs=ROUNDING)
    assert features.yg == pytest.approx((v.mean() - 119.5) / 195.05, abs=ROUNDING)
    assert features.moment_names == ["00", "10", "01", "20", "11", "02", "30", "21", "12", "03"]
    assert len(features.m) == len(features.mu) == 10


def test_first_channel_is_red():
    rgb = np.zeros((240, 320, 3), np.uint8)
    rgb[..., 0] = 255  # grey 76
    config = {"object": "dark", "segmentation": "fixed", "threshold": 50}
    assert not camera.MomentExtractor(INFO, config).process(rgb).target_visible
    assert camera.MomentExtractor(INFO, config).process(rgb[..., ::-1].copy()).target_visible


def test_read_only_and_row_sliced_images_are_accepted():
    image = np.full((480, 400), 230, np.uint8)
    image[::2, :320] = image_with_wedge()
    view = image[::2, :320]
    view.flags.writeable = False
    a = camera.MomentExtractor(INFO, VISION).process(view)
    assert a.m == camera.MomentExtractor(INFO, VISION).process(image_with_wedge()).m


@pytest.mark.parametrize(
    "image",
    [
        np.zeros((240, 320)),
        np.zeros((240, 320), np.int32),
        np.zeros((240, 320, 2), np.uint8),
        np.zeros(320, np.uint8),
        np.zeros((120, 160), np.uint8),
        np.zeros((240, 640), np.uint8)[:, ::2],
        np.zeros((0, 320), np.uint8),
    ],
)
def test_other_images_are_shape_errors(image):
    with pytest.raises(camera.ShapeError):
        camera.MomentExtractor(INFO, VISION).process(image)


def test_empty_view_is_a_value():
    features = camera.MomentExtractor(INFO, VISION).process(np.full((240, 320), 230, np.uint8))
    assert not features.target_visible and not features.valid
    assert math.isnan(features.area) and math.isnan(features.alpha)
    assert features.m == []


def test_converted_image_is_what_the_moments_saw():
    extractor = camera.MomentExtractor(INFO, VISION)
    assert extractor.converted_image.sum() == 0
    features = extractor.process(image_with_wedge())
    seen = extractor.converted_image
    assert seen.shape == (240, 320) and seen.dtype == np.uint8
    assert seen.sum() / 255.0 / 195.05**2 == pytest.approx(features.area, rel=1e-3)  # weights in 255 steps


def test_reference_from_a_view_gives_depth():
    extractor = camera.MomentExtractor(INFO, VISION)
    features = extractor.process(image_with_wedge())
    extractor.set_reference(0.59, features)
    again = extractor.process(image_with_wedge())
    assert again.has_reference
    assert again.an == pytest.approx(0.59, rel=ROUNDING)
    assert again.xn == pytest.approx(0.59 * again.xg, rel=ROUNDING)
    assert again.z_star_m == 0.59 and again.area_star == features.area
    extractor.clear_reference()
    assert math.isnan(extractor.process(image_with_wedge()).an)


def test_reference_by_numbers_and_from_a_message_like_object():
    extractor = camera.MomentExtractor(INFO, VISION)
    features = extractor.process(image_with_wedge())
    extractor.set_reference(0.5, 4 * features.area, features.alpha)
    assert extractor.process(image_with_wedge()).an == pytest.approx(1.0, rel=ROUNDING)

    class Message:
        pass

    message = Message()
    for name in ("target_visible", "touches_border", "symmetric", "valid", "area", "alpha", "mu"):
        setattr(message, name, getattr(features, name))
    message.mu = tuple(message.mu)
    extractor.set_reference(0.5, message)
    assert extractor.process(image_with_wedge()).an == pytest.approx(0.5, rel=ROUNDING)


def test_bad_references_are_refused():
    extractor = camera.MomentExtractor(INFO, VISION)
    with pytest.raises(camera.DegenerateFeature, match="no target"):
        extractor.set_reference(0.5, extractor.process(np.full((240, 320), 230, np.uint8)))
    with pytest.raises(camera.ParameterError, match="z_star_m"):
        extractor.set_reference(-0.5, 0.1, 0.0)
    with pytest.raises(camera.ParameterError, match="area_star"):
        extractor.set_reference(0.5, math.nan, 0.0)
    assert not extractor.process(image_with_wedge()).has_reference


def test_faults_of_both_dicts_are_listed_at_once():
    info = dict(INFO, K=[0.0] * 9)
    with pytest.raises(camera.ParameterError) as error:
        camera.MomentExtractor(info, {"object": "grey", "order": "3", "colour": 1})
    text = str(error.value)
    for part in ("camera_info.K[0]", "vision.object", "vision.segmentation", "vision.order: found '3'",
                 "vision.colour"):
        assert part in text
    assert all(re.match(r"^(camera_info|vision)[.].+: found .+, allowed .+$", line) for line in text.splitlines())


def test_numpy_values_are_accepted_in_dicts():
    info = dict(INFO, K=np.array(INFO["K"]), D=np.zeros(5), width=np.int64(320))
    vision = dict(VISION, min_area_px=np.int32(10), object_grey=np.float64(20.0), background_grey=230)
    assert camera.MomentExtractor(info, vision).process(image_with_wedge()).valid


def test_missing_keys_of_camera_info_are_named():
    for key in ("width", "height", "K", "D", "distortion_model"):
        with pytest.raises(camera.ParameterError, match="camera_info[.]" + key):
            camera.MomentExtractor({k: v for k, v in INFO.items() if k != key}, VISION)


def test_points_are_corners_in_the_order_of_the_reference():
    image = np.full((240, 320), 230, np.uint8)
    image[80:120, 100:160] = 20  # covers u 99.5 .. 159.5, v 79.5 .. 119.5
    extractor = camera.MomentExtractor(INFO, dict(VISION, points="corners", point_count=4))
    features = extractor.process(image)
    expected = np.array([[99.5, 79.5], [159.5, 79.5], [159.5, 119.5], [99.5, 119.5]])
    found = np.stack([features.point_x, features.point_y], axis=1) * 195.05 + [159.5, 119.5]
    assert found == pytest.approx(expected, abs=1e-5)  # weights are single precision
    extractor.set_reference(0.5, features)
    again = extractor.process(image)
    assert (again.point_x, again.point_y) == (features.point_x, features.point_y)
    assert camera.MomentExtractor(INFO, VISION).process(image).point_x == []


def test_reference_without_the_configured_points_is_refused():
    features = camera.MomentExtractor(INFO, VISION).process(image_with_wedge())
    extractor = camera.MomentExtractor(INFO, dict(VISION, points="blobs", point_count=2))
    with pytest.raises(camera.ShapeError, match="found 0, allowed 2"):
        extractor.set_reference(0.5, features)


def test_features_are_a_copy():
    extractor = camera.MomentExtractor(INFO, VISION)
    first = extractor.process(image_with_wedge())
    xg = first.xg
    extractor.process(image_with_wedge(u0=150))
    assert first.xg == xg != extractor.features.xg


def test_uint16_gives_the_features_of_uint8():
    extractors = [camera.MomentExtractor(INFO, VISION) for _ in range(3)]
    image = image_with_wedge()
    deep = image.astype(np.uint16) * 257
    features = [extractor.process(each) for extractor, each in
                zip(extractors, (image, deep, np.ascontiguousarray(np.repeat(deep[:, :, None], 3, axis=2))))]
    assert features[0].valid and features[0].m == features[1].m == features[2].m
    assert extractors[1].white == 65535 and extractors[0].white == 0
    with pytest.raises(camera.ShapeError, match=r"uint16.*allowed uint8 or uint16 of shape"):
        extractors[0].process(np.zeros((240, 320, 2), np.uint16))


@pytest.mark.parametrize("bits", [8, 10, 12, 14, 16])
def test_uint16_of_fewer_bits_shows_the_target(bits):
    extractor = camera.MomentExtractor(INFO, {"object": "dark", "segmentation": "otsu"})
    features = extractor.process(np.round(image_with_wedge() * ((2**bits - 1) / 255.0)).astype(np.uint16))
    assert features.valid and extractor.white == 2**bits - 1
    of_bytes = camera.MomentExtractor(INFO, {"object": "dark", "segmentation": "otsu"})
    assert features.m == of_bytes.process(image_with_wedge()).m


def test_the_libraries_of_the_tag_detector_are_loaded_for_those_who_look_for_a_tag():
    """They are 220, and take longer to load than everything else of a process that runs a scenario."""
    code = (f"import aras_visual_servo_camera as camera\ninfo = {INFO!r}\n"
            "def say():\n    print('libvisp_detection' in open('/proc/self/maps').read())\n"
            f"camera.MomentExtractor(info, {VISION!r})\nsay()\n"
            "camera.TagExtractor(info, {'family': '36h11', 'id': 0})\nsay()\n")
    said = subprocess.run([sys.executable, "-c", code], stdout=subprocess.PIPE, check=True, text=True).stdout
    assert said.split() == ["False", "True"]


@pytest.mark.parametrize("name", ["MomentFeatures", "PhotometricFeatures"])
def test_attributes_are_the_fields_of_the_message(name):
    messages = pytest.importorskip("aras_visual_servo_msgs.msg")
    fields = set(getattr(messages, name).__slots__) - {"header", "age_s"}
    assert {attribute for attribute in dir(getattr(camera, name)) if not attribute.startswith("_")} == fields


@pytest.mark.parametrize("extractor, config", [(camera.MomentExtractor, VISION), (camera.PhotometricExtractor, {}),
                                               (camera.MatchExtractor, {}), (camera.TagExtractor, {})])
def test_a_binned_and_cropped_camera_info_is_that_of_its_images(extractor, config):
    sensor = {**INFO, "width": 1280, "height": 960, "K": [780.2, 0, 639.5, 0, 780.2, 479.5, 0, 0, 1], "binning_x": 4,
              "binning_y": 4}
    features = extractor(sensor, config).process(image_with_wedge())
    if extractor is camera.MomentExtractor:
        assert features.m == pytest.approx(extractor(INFO, config).process(image_with_wedge()).m, rel=ROUNDING)
    cropped = {**sensor, "roi": {"x_offset": 320, "y_offset": 240, "width": 640, "height": 480, "do_rectify": False}}
    with pytest.raises(camera.ShapeError, match="160 x 120"):
        extractor(cropped, config).process(image_with_wedge())
    with pytest.raises(camera.ParameterError, match="camera_info.width"):
        extractor({**sensor, "width": 320, "height": 240}, config)


def test_image_info_is_that_of_the_images():
    roi = {"x_offset": 320, "y_offset": 240, "width": 640, "height": 480}
    sensor = {**INFO, "width": 1280, "height": 960, "K": [780.2, 0, 639.5, 0, 780.2, 479.5, 0, 0, 1], "roi": roi,
              "binning_x": 2, "binning_y": 2}
    info = camera.image_info(sensor)
    assert (info["width"], info["height"]) == (320, 240)
    assert info["K"] == pytest.approx([390.1, 0, 159.5, 0, 390.1, 119.5, 0, 0, 1])
    assert "roi" not in info and "binning_x" not in info and sensor["roi"] == roi
    assert camera.image_info(info) == info


def test_pixels_have_the_coordinates_whose_projection_they_are():
    D = [-0.3, 0.1, 0.001, -0.002, 0.02]
    sensor = {**INFO, "K": [200.0, 0, 159.5, 0, 210.0, 119.5, 0, 0, 1], "D": D, "distortion_model": "plumb_bob"}
    xy = np.array([[0.0, 0.0], [0.31, -0.22], [-0.5, 0.4]])
    x, y = xy.T
    r2 = x * x + y * y
    radial = 1.0 + D[0] * r2 + D[1] * r2**2 + D[4] * r2**3
    uv = np.c_[159.5 + 200.0 * (x * radial + 2.0 * D[2] * x * y + D[3] * (r2 + 2.0 * x * x)),
               119.5 + 210.0 * (y * radial + D[2] * (r2 + 2.0 * y * y) + 2.0 * D[3] * x * y)]
    np.testing.assert_allclose(camera.undistort(sensor, uv), xy, atol=ROUNDING)
    binned = {**sensor, "binning_x": 2, "binning_y": 2}
    np.testing.assert_allclose(camera.undistort(binned, (uv + 0.5) / 2.0 - 0.5), xy, atol=ROUNDING)
    fisheye = {**sensor, "D": [0.0] * 4, "distortion_model": "equidistant"}
    assert np.isnan(camera.undistort(fisheye, [[159.5 + 200.0 * 1.5, 119.5]])).all()  # 86 degrees off the axis
    with pytest.raises(camera.ShapeError, match="n, 2"):
        camera.undistort(sensor, [1.0, 2.0])
    with pytest.raises(camera.ParameterError, match="camera_info"):
        camera.undistort({**sensor, "K": [0.0] * 9}, uv)


COLOUR = {"object": {"hue_deg": [340, 20]}, "segmentation": "coverage"}


def test_an_object_is_found_by_its_hue_where_its_grey_is_that_of_the_background():
    inside = image_with_wedge() == 20
    rgb = np.where(inside[..., None], np.uint8([200, 0, 0]), np.uint8([0, 102, 0]))
    assert not camera.MomentExtractor(INFO, VISION).process(rgb).target_visible
    features = camera.MomentExtractor(INFO, COLOUR).process(rgb)
    assert features.valid
    assert features.m == pytest.approx(camera.MomentExtractor(INFO, VISION).process(image_with_wedge()).m, rel=ROUNDING)
    green = {"object": {"hue_deg": [90, 150], "saturation": [0.5, 1]}, "segmentation": "otsu"}
    assert camera.MomentExtractor(INFO, green).process(rgb[..., [1, 0, 2]].copy()).area == pytest.approx(features.area)
    assert not camera.MomentExtractor(INFO, {**COLOUR, "object": {"hue_deg": [200, 260]}}).process(rgb).target_visible


@pytest.mark.parametrize("dtype, name", [(np.uint8, "mono8"), (np.uint16, "mono16")])
def test_a_mono_image_has_no_hue(dtype, name):
    with pytest.raises(camera.ShapeError, match=f"{name}.*vision.object"):
        camera.MomentExtractor(INFO, COLOUR).process(image_with_wedge().astype(dtype))


def test_faults_of_a_colour_are_listed():
    with pytest.raises(camera.ParameterError) as error:
        camera.MomentExtractor(INFO, {**COLOUR, "object": {"hue_deg": [20, 20], "hue": 1}, "threshold": 9})
    for key in ("vision.object.hue_deg", "vision.object.hue:", "vision.threshold"):
        assert key in str(error.value)


@pytest.mark.parametrize("extractor, config", [(camera.MomentExtractor, VISION), (camera.PhotometricExtractor, {}),
                                               (camera.MatchExtractor, {}), (camera.TagExtractor, {})])
def test_a_lens_that_folds_inside_the_image_is_told_with_its_radius(extractor, config):
    folding = {**INFO, "distortion_model": "rational_polynomial", "D": [0.44, -2.62, 0, 0, 1.41, 0.34, -2.3, 1.27]}
    with pytest.warns(UserWarning, match=" 154 px"):
        made = extractor(folding, config)
    with pytest.warns(UserWarning, match=" 154 px"):
        made.set_camera_info(folding)
    extractor({**folding, "width": 160, "height": 120, "K": [195.05, 0, 79.5, 0, 195.05, 59.5, 0, 0, 1]}, config)
