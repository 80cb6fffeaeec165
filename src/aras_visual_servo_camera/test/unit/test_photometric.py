"""Photometric features: interaction matrix, normal equations, pyramid, illumination, bad input."""

import numpy as np
import pytest
from textured_plane import LENS, TexturedPlane, camera_info, correlate, exponential, interaction, kernels, symmetric

import aras_visual_servo_camera as camera

TILTED = (0.25, -0.4, 1.6)  # of 1/Z [1/m]: 16 deg
# Camera displacement of about 3 mm and 0.4 deg, all six different [m, rad].
SMALL = np.array([0.002, -0.0015, 0.0025, 0.003, -0.004, 0.005])
# Rows of 160 pixels are summed in single precision, 16 in parallel: ten additions each 2^-24, and as much again of
# the factors. b sums terms of both signs: held against the size of what is summed.
SINGLE = 1e-5


def extractor(info, **config):
    return camera.PhotometricExtractor(info, config)


def step_of(features):
    return -np.linalg.solve(symmetric(features.H), features.b)


def brute_force(scene, images, which, sigma=1.0, border=10, pitch=1):
    """(H, b, cost, size of b) of (reference, current) as floats, written as in the paper."""
    rays = scene.x[::pitch, ::pitch], scene.y[::pitch, ::pitch], scene.jacobian[::pitch, ::pitch] * pitch
    L = {name: interaction(image, sigma, *rays, scene.plane) for name, image in zip(("desired", "current"), images)}
    L["mean"] = 0.5 * (L["desired"] + L["current"])
    gauss, _ = kernels(sigma)
    inside = np.s_[border:-border, border:-border]
    L, e = L[which][inside].reshape(-1, 6), (correlate(images[1] - images[0], gauss, gauss))[inside].ravel()
    return L.T @ L, L.T @ e, 0.5 * e @ e, np.abs(L).T @ np.abs(e)


def halved(image):
    """The next level: binomial filter, every other pixel; the rim is wrong, and left out by the border."""
    weights = np.array([1.0, 4.0, 6.0, 4.0, 1.0]) / 16.0
    return correlate(image, weights, weights)[::2, ::2]


@pytest.mark.parametrize("lens", [(0.0,) * 5, LENS])
@pytest.mark.parametrize("axis", range(6))
def test_interaction_matrix_is_the_derivative_of_the_smoothed_image(lens, axis):
    scene, h = TexturedPlane(camera_info(lens=lens), TILTED, shortest_m=0.15), 1e-4
    gauss, _ = kernels(1.0)
    moved = [correlate(scene.grey(exponential(sign * h * np.eye(6)[axis])), gauss, gauss) for sign in (1.0, -1.0)]
    difference = (moved[0] - moved[1])[10:-10, 10:-10] / (2.0 * h)
    L = interaction(scene.grey(), 1.0, scene.x, scene.y, scene.jacobian, scene.plane)[10:-10, 10:-10, axis]
    # Gaussian and derivative smooth the same; what is left is that rays and depth differ across the filter's reach.
    assert np.abs(L - difference).max() < 0.02 * np.abs(difference).max()


@pytest.mark.parametrize("lens", [(0.0,) * 5, LENS])
@pytest.mark.parametrize("which", ["desired", "current", "mean"])
def test_normal_equations_are_those_of_the_pixels(lens, which):
    scene = TexturedPlane(camera_info(lens=lens), TILTED)
    images = [scene.image(), scene.image(exponential(SMALL))]
    photometric = extractor(scene.info, interaction=which)
    photometric.set_reference(images[0], plane=TILTED)
    features = photometric.process(images[1])
    H, b, cost, size = brute_force(scene, [image.astype(float) for image in images], which)
    scale = np.sqrt(np.outer(np.diag(H), np.diag(H)))
    assert np.abs(symmetric(features.H) - H).max() < SINGLE * scale.max()
    np.testing.assert_array_less(np.abs(symmetric(features.H) - H), SINGLE * scale)
    np.testing.assert_array_less(np.abs(features.b - b), SINGLE * size)
    assert features.cost == pytest.approx(cost, rel=SINGLE)
    assert features.pixels == (160 - 20) * (120 - 20) and features.level == 0 and features.interaction == which


def test_condition_is_that_of_the_matrix_with_columns_of_length_one():
    scene = TexturedPlane(camera_info(), TILTED)
    photometric = extractor(scene.info)
    photometric.set_reference(scene.image(), plane=TILTED)
    features = photometric.process(scene.image(exponential(SMALL)))
    H = symmetric(features.H)
    scaled = H / np.sqrt(np.outer(np.diag(H), np.diag(H)))
    assert features.condition == pytest.approx(np.linalg.cond(scaled) ** 0.5, rel=1e-6)


@pytest.mark.parametrize("lens", [(0.0,) * 5, LENS])
def test_step_undoes_a_small_displacement(lens):
    scene = TexturedPlane(camera_info(lens=lens), TILTED, shortest_m=0.1)
    photometric = extractor(scene.info)
    photometric.set_reference(scene.image(), plane=TILTED)
    step = step_of(photometric.process(scene.image(exponential(SMALL))))
    # Rounded grey levels leave 0.02 mm and 0.1 mrad (measured: the error does not shrink with the displacement), the
    # change of the plane's depth that L does not know about half a percent of the displacement.
    np.testing.assert_allclose(step, -SMALL, atol=0.02 * np.abs(SMALL).max())


def test_mean_of_both_gradients_is_of_second_order():
    # Motions that leave the depth of the plane alone: halving them divides the error of the step by 4 with the gradient
    # of the reference (first order), by 8 with the mean of both (second order).
    scene, errors = TexturedPlane(camera_info(), shortest_m=0.1), {}
    for which in ("desired", "current", "mean"):
        photometric = extractor(scene.info, interaction=which)
        photometric.set_reference(scene.image(), plane=(0.0, 0.0, 1.6))
        errors[which] = []
        for size in (0.5, 0.25):
            xi = size * np.array([0.012, -0.009, 0.0, 0.0, 0.0, 0.04])
            errors[which].append(np.linalg.norm(step_of(photometric.process(scene.image(exponential(xi)))) + xi))
    assert errors["desired"][0] / errors["desired"][1] == pytest.approx(4.0, abs=1.0), errors
    assert errors["mean"][0] / errors["mean"][1] == pytest.approx(8.0, abs=1.0), errors
    for which in ("desired", "current"):
        assert errors["mean"][1] < 0.2 * errors[which][1], errors


def test_levels_go_from_coarse_to_fine_as_the_displacement_shrinks():
    scene = TexturedPlane(camera_info(), shortest_m=0.1)
    photometric = extractor(scene.info, levels=3, switch_px=0.5)
    photometric.set_reference(scene.image(), 1 / 1.6)
    levels = []
    for size in (8.0, 3.0, 0.5, 0.0):  # SMALL moves the image by about a pixel
        features = photometric.process(scene.image(exponential(size * SMALL)))
        levels.append(features.level)
        assert features.level == 0 or features.motion_px >= 0.5
        assert features.levels == 3
    assert levels[0] == 2 and levels[-1] == 0 and levels == sorted(levels, reverse=True)
    assert features.rms == 0.0 and features.cost == 0.0 and features.motion_px == 0.0


def test_motion_is_that_of_the_image_in_pixels_of_the_level():
    scene = TexturedPlane(camera_info(), shortest_m=0.1)
    motions = []
    for levels, switch_px in ((1, 0.01), (2, 0.01)):
        photometric = extractor(scene.info, levels=levels, switch_px=switch_px)
        photometric.set_reference(scene.image(), 1 / 1.6)
        features = photometric.process(scene.image(exponential([0.01, 0, 0, 0, 0, 0])))
        assert features.level == levels - 1
        motions.append(features.motion_px)
    focal = np.sqrt(scene.info["K"][0] * scene.info["K"][4])
    assert motions[0] == pytest.approx(0.01 * 1.6 * focal, rel=0.03)
    assert motions[1] == pytest.approx(0.5 * motions[0], rel=0.03)


@pytest.mark.parametrize("lens", [(0.0,) * 5, LENS])
def test_a_coarser_level_is_the_image_halved(lens):
    scene = TexturedPlane(camera_info(lens=lens), TILTED)
    images = [scene.image(), scene.image(exponential(2 * SMALL))]
    photometric = extractor(scene.info, levels=2, switch_px=0.01)
    photometric.set_reference(images[0], plane=TILTED)
    features = photometric.process(images[1])
    assert features.level == 1 and features.pixels == (80 - 10) * (60 - 10)
    H, b, _, size = brute_force(scene, [halved(image.astype(float)) for image in images], "mean", border=5, pitch=2)
    np.testing.assert_array_less(np.abs(symmetric(features.H) - H), SINGLE * np.sqrt(np.outer(np.diag(H), np.diag(H))))
    np.testing.assert_array_less(np.abs(features.b - b), SINGLE * size)


def test_pyramid_reaches_home_from_where_the_image_alone_does_not():
    scene, left = TexturedPlane(camera_info(), waves=60, seed=3), {}
    for levels in (1, 4):
        photometric = extractor(scene.info, levels=levels)
        photometric.set_reference(scene.image(), 1 / 1.6)
        X = exponential([0.1, -0.08, 0.04, 0.06, -0.06, 0.16])  # 25 pixels and 10 deg
        for _ in range(60):
            X = X @ exponential(0.5 * step_of(photometric.process(scene.image(X))))
        left[levels] = np.linalg.norm(X[:3, 3])
    assert left[4] < 1e-5 and left[1] > 0.1, left


@pytest.mark.parametrize("illumination, gain, offset", [
    ("constant", 1.0, 0.0), ("offset", 1.0, 25.0), ("gain_and_offset", 0.7, 20.0)])
def test_light_that_changes_is_taken_out(illumination, gain, offset):
    scene = TexturedPlane(camera_info(), TILTED)
    photometric = extractor(scene.info, illumination=illumination, interaction="current")
    photometric.set_reference(scene.image(), plane=TILTED)
    lit = [np.clip(np.rint(gain * scene.grey(exponential(xi)) + offset), 0, 255).astype(np.uint8)
           for xi in (SMALL, np.zeros(6))]
    # To first order of the displacement: the gradient is the current one.
    np.testing.assert_allclose(step_of(photometric.process(lit[0])), -SMALL, atol=0.08 * np.abs(SMALL).max())
    features = photometric.process(lit[1])
    assert features.rms < 0.5 and features.motion_px < 0.02  # rounding of grey levels: 0.29 in each image


def test_same_images_give_the_same_bits():
    scene = TexturedPlane(camera_info(lens=LENS), TILTED)
    runs = []
    for _ in range(2):
        photometric = extractor(scene.info, levels=3, illumination="gain_and_offset")
        photometric.set_reference(scene.image(), plane=TILTED)
        features = [photometric.process(scene.image(exponential(size * SMALL))) for size in (5.0, 1.0, 5.0)]
        runs.append([(f.H, f.b, f.rms, f.cost, f.level, f.condition, f.reference_hash) for f in features])
        assert runs[-1][0] == runs[-1][2]  # nothing is carried from image to image
    assert runs[0] == runs[1]


def test_colour_is_turned_into_grey():
    scene = TexturedPlane(camera_info())
    photometric = extractor(scene.info)
    photometric.set_reference(scene.image(), 0.6)
    colour = np.repeat(scene.image()[:, :, None], 3, axis=2)
    assert photometric.process(colour).rms == 0.0


def test_normal_of_the_target_tilts_the_plane():
    scene = TexturedPlane(camera_info(), TILTED)
    a, b = extractor(scene.info), extractor(scene.info, target_normal_C=list(np.array(TILTED) * 3.0))
    a.set_reference(scene.image(), plane=TILTED)
    b.set_reference(scene.image(), 1.0 / TILTED[2])
    moved = scene.image(exponential(SMALL))
    np.testing.assert_allclose(a.process(moved).H, b.process(moved).H, rtol=SINGLE)
    assert a.features.z_star_m == b.features.z_star_m == pytest.approx(1.0 / 1.6)


def test_before_a_reference_an_image_with_contrast_is_fit_to_become_one():
    scene = TexturedPlane(camera_info())
    photometric = extractor(scene.info)
    features = photometric.process(scene.image())
    assert features.valid and features.target_visible and not features.has_reference
    assert features.H == [] and features.b == [] and np.isnan(features.rms) and features.reference_hash == 0


def test_blank_image_is_not_valid_and_cannot_be_the_reference():
    scene, blank = TexturedPlane(camera_info()), np.full((120, 160), 128, np.uint8)
    photometric = extractor(scene.info)
    with pytest.raises(camera.DegenerateFeature, match="standard deviation"):
        photometric.set_reference(blank, 0.6)
    assert not photometric.process(scene.image()).has_reference  # there was none
    photometric.set_reference(scene.image(), 0.6)
    features = photometric.process(blank)
    assert not features.valid and not features.target_visible and "contrast" in features.fault and features.H == []
    assert photometric.process(scene.image()).valid


def test_stripes_tell_no_six_motions_apart():
    scene = TexturedPlane(camera_info())
    stripes = np.tile((128 + 60 * np.sin(0.2 * np.arange(160))).astype(np.uint8), (120, 1))
    photometric = extractor(scene.info, interaction="current")
    with pytest.raises(camera.DegenerateFeature, match="six motions"):
        photometric.set_reference(stripes, 0.6)
    photometric.set_reference(scene.image(), 0.6)
    features = photometric.process(stripes)
    assert features.target_visible and not features.valid and "six motions" in features.fault


@pytest.mark.parametrize("more", [{}, {"levels": 2, "mapping": "pca"}])
def test_a_failed_reference_changes_nothing(more):
    scene = TexturedPlane(camera_info())
    photometric = extractor(scene.info, **more)
    photometric.set_reference(scene.image(), 0.6)
    moved = scene.image(exponential(SMALL))
    before = photometric.process(moved)
    with pytest.raises(camera.ParameterError, match="in front of every pixel"):
        photometric.set_reference(moved, plane=(5.0, 0.0, 1.6))
    with pytest.raises(camera.DegenerateFeature):
        photometric.set_reference(np.full((120, 160), 128, np.uint8), 0.6)
    after = photometric.process(moved)
    assert (after.H, after.b, after.rms) == (before.H, before.b, before.rms)
    assert after.reference_hash == before.reference_hash


@pytest.mark.parametrize("stretch", [1.001, 0.98, 1.04])
def test_a_change_of_zoom_keeps_the_reference(stretch):
    scene = TexturedPlane(camera_info())
    zoomed = {**scene.info, "K": [stretch * k if i in (0, 4) else k for i, k in enumerate(scene.info["K"])]}
    photometric, taught = extractor(scene.info), extractor(zoomed)
    photometric.set_reference(scene.image(), 0.6)
    photometric.set_camera_info(zoomed)
    other = TexturedPlane(zoomed)
    taught.set_reference(other.image(), 0.6)
    home, away = (other.image(pose) for pose in (np.eye(4), exponential(SMALL)))
    assert photometric.process(home).has_reference
    assert photometric.features.rms < 1.0  # rounding of both images, interpolation of one

    def step(features):
        H = np.zeros((6, 6))
        H[np.triu_indices(6)] = features.H
        return -np.linalg.solve(H + np.triu(H, 1).T, features.b)

    np.testing.assert_allclose(step(photometric.process(away)), step(taught.process(away)), atol=2e-4)
    photometric.set_camera_info(scene.info)
    assert photometric.process(scene.image()).rms == 0.0


@pytest.mark.parametrize("z_star_m", [0.0, -1.0, float("nan"), float("inf")])
def test_depth_of_the_reference_is_checked(z_star_m):
    scene = TexturedPlane(camera_info())
    with pytest.raises(camera.ParameterError, match="z_star_m: found"):
        extractor(scene.info).set_reference(scene.image(), z_star_m)


def test_image_of_another_size_is_refused():
    scene = TexturedPlane(camera_info())
    photometric = extractor(scene.info)
    for act in (photometric.process, lambda image: photometric.set_reference(image, 0.6)):
        with pytest.raises(camera.ShapeError, match="found 80 x 60, allowed 160 x 120"):
            act(np.zeros((60, 80), np.uint8))


def test_every_fault_of_the_settings_is_listed():
    with pytest.raises(camera.ParameterError) as caught:
        extractor(camera_info(), interaction="goal", illumination="sun", levels=0, switch_px=0.0, smoothing_px=0.1,
                  border_px=-1, min_contrast=200, target_normal_C=[0.0, 0.0, -1.0], sigma=1.0)
    text = str(caught.value)
    for key in ("interaction", "illumination", "levels", "switch_px", "smoothing_px", "border_px", "min_contrast",
                "target_normal_C", "sigma: found an unknown key"):
        assert f"vision.photometric.{key}" in text, key
    with pytest.raises(camera.ParameterError, match="vision.photometric.levels: found 0"):
        camera.MomentExtractor(camera_info(), {"object": "dark", "segmentation": "otsu", "photometric": {"levels": 0}})
    with pytest.raises(camera.ParameterError, match="levels: found 8"):
        extractor(camera_info(), levels=8)
