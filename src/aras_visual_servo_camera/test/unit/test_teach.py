"""Both extractors are taught an image by its stamp, while it is among the last ones, however many have come since."""

import numpy as np
import pytest

import aras_visual_servo_camera as camera

MS = 1_000_000
KEPT = 32
Z_STAR_M = 0.59
INFO = {"width": 160, "height": 120, "K": [100.0, 0, 79.5, 0, 100.0, 59.5, 0, 0, 1], "D": [0.0] * 5,
        "distortion_model": "plumb_bob"}


def wedge(k):
    """An asymmetric staircase that moves and grows from image to image."""
    image = np.full((120, 160), 230, np.uint8)
    for row in range(20 + k):
        image[40 + row, 30 + k:30 + k + 2 * (row + 1)] = 20
    return image


def texture(k):
    u, v = np.meshgrid(np.arange(160) - 0.4 * k, np.arange(120))
    return np.rint(128 + 50 * np.sin(0.21 * u + 0.05 * v) + 50 * np.cos(0.17 * v)).astype(np.uint8)


def moments():
    return camera.MomentExtractor(INFO, {"object": "dark", "segmentation": "coverage", "points": "corners",
                                         "point_count": 3, "kernel": {"p": 1.0, "q": 1.0}})


def fields(features):
    """Text of every field, so that NaN is equal to itself; which image was taught is looked at by itself."""
    return {name: repr(getattr(features, name)) for name in dir(features)
            if not name.startswith("_") and name != "reference_stamp_ns"}


@pytest.mark.parametrize("since", [0, 1, 5])
def test_moments_are_relative_to_the_image_asked_for(since):
    asked, told = moments(), moments()
    view = None
    for k in range(4):
        view = told.process(wedge(k))
        asked.process(wedge(k), (k + 1) * MS)
    for k in range(4, 4 + since):
        asked.process(wedge(k), (k + 1) * MS)
    asked.teach(4 * MS, Z_STAR_M)
    told.set_reference(Z_STAR_M, view)
    after = asked.process(wedge(3), 50 * MS)
    assert fields(after) == fields(told.process(wedge(3)))
    assert (after.reference_stamp_ns, after.an, after.area_star) == (4 * MS, Z_STAR_M, view.area)
    assert (after.xn, after.yn) == (Z_STAR_M * view.xg, Z_STAR_M * view.yg)


@pytest.mark.parametrize("since", [0, 1, 5])
@pytest.mark.parametrize("colours", [1, 3])
def test_luminance_is_compared_with_the_image_asked_for(since, colours):
    def picture(k):
        return np.repeat(texture(k)[..., None], colours, axis=2) if colours > 1 else texture(k)

    asked, told = (camera.PhotometricExtractor(INFO, {"levels": 2}) for _ in range(2))
    for k in range(4 + since):
        asked.process(picture(k), (k + 1) * MS)
    asked.teach(4 * MS, Z_STAR_M)
    told.set_reference(picture(3), Z_STAR_M)
    for k in (3, 6):
        after = asked.process(picture(k), (50 + k) * MS)
        assert fields(after) == fields(told.process(picture(k)))
        assert after.reference_stamp_ns == 4 * MS and (after.rms == 0.0) == (k == 3)


EXTRACTORS = {"moments": (moments, wedge), "photometric": (lambda: camera.PhotometricExtractor(INFO), texture)}


@pytest.fixture(params=EXTRACTORS)
def seen(request):
    """An extractor that has seen one image more than it keeps, and what makes pictures for it."""
    make, picture = EXTRACTORS[request.param]
    extractor = make()
    for k in range(KEPT + 1):
        extractor.process(picture(k % 5), (k + 1) * MS)
    return extractor, picture


def test_an_image_that_is_gone_is_refused_by_its_stamp_and_the_reference_stays(seen):
    extractor, picture = seen
    extractor.teach(2 * MS, Z_STAR_M)
    with pytest.raises(camera.ParameterError, match=r"found 0.001000000 s, .*last 32 images, from 0.002000000 s"):
        extractor.teach(1 * MS, Z_STAR_M)
    assert extractor.process(picture(1), 40 * MS).reference_stamp_ns == 2 * MS


def test_images_without_a_stamp_are_not_kept(seen):
    extractor, picture = seen
    for k in range(5):
        extractor.process(picture(k))
    extractor.teach(2 * MS, Z_STAR_M)
    with pytest.raises(camera.ParameterError, match="reference.stamp"):
        extractor.teach(-1, Z_STAR_M)


def test_images_from_before_time_was_set_back_are_forgotten(seen):
    extractor, picture = seen
    extractor.process(picture(0), 1 * MS)
    with pytest.raises(camera.ParameterError, match="last 1 images"):
        extractor.teach(20 * MS, Z_STAR_M)
    extractor.teach(1 * MS, Z_STAR_M)


def test_no_stamp_of_a_reference_outlives_it(seen):
    extractor, picture = seen
    extractor.teach(20 * MS, Z_STAR_M)
    extractor.clear_reference()
    assert extractor.process(picture(0), 40 * MS).reference_stamp_ns == -1


def test_a_reference_given_otherwise_carries_no_stamp():
    extractor = moments()
    view = extractor.process(wedge(0), MS)
    for arguments in ((Z_STAR_M, view), (Z_STAR_M, view.area, view.alpha)):
        extractor.teach(MS, Z_STAR_M)
        extractor.set_reference(*arguments)
        assert extractor.process(wedge(1), 2 * MS).reference_stamp_ns == -1
        extractor.process(wedge(0), MS)
