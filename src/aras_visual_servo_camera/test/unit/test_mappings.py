"""Mappings of the photometric features: matrices against central differences of pictures, the way home, bad input."""

import numpy as np
import pytest
from textured_plane import LENS, TexturedPlane, camera_info, correlate, exponential, interaction, kernels, symmetric

import aras_visual_servo_camera as camera

LINEAR = ("pca", "dct", "mixture")
MAPPINGS = LINEAR + ("mutual_information",)
TILTED = (0.25, -0.4, 1.6)  # of 1/Z [1/m]: 16 deg
# A camera displacement that moves the image by about a pixel, all six different [m, rad].
SMALL = np.array([0.002, -0.0015, 0.0025, 0.003, -0.004, 0.005])
# Of b along an axis: pictures rounded to 8 bits, a gradient from a kernel of finite width, and the depth of the plane,
# which is that of the reference view.
PICTURES = 0.05
# The same, of logarithms of a histogram, which pixels on the rim change as much as motion does.
INFORMATION = 0.1
SINGLE = 1e-5  # sums of single precision, as in test_photometric.py
BORDER = 10


def extractor(scene, plane=TILTED, **config):
    """One that has been taught the view from the goal."""
    made = camera.PhotometricExtractor(scene.info, config)
    made.set_reference(scene.image(), plane=plane)
    return made


def step_of(features):
    return -np.linalg.solve(symmetric(features.H), features.b)


def smooth_scene(lens=(0.0,) * 5):
    """Waves so long that the kernel of the gradient smooths nothing away."""
    return TexturedPlane(camera_info(lens=lens), TILTED, shortest_m=0.15)


def slopes(made, scene, xi, h):
    """(6,) central differences of the cost by the six motions of the camera at exp(xi)."""
    costs = [[made.process(scene.image(exponential(xi) @ exponential(sign * h * axis))).cost for sign in (1, -1)]
             for axis in np.eye(6)]
    return np.array([(plus - minus) / (2.0 * h) for plus, minus in costs])


@pytest.mark.parametrize("lens", [(0.0,) * 5, LENS])
@pytest.mark.parametrize("mapping", MAPPINGS)
def test_b_is_the_slope_of_the_cost(mapping, lens):
    scene = smooth_scene(lens)
    made = extractor(scene, mapping=mapping, interaction="current", switch_px=100.0)
    features = made.process(scene.image(exponential(SMALL)))
    size = np.sqrt(np.diag(symmetric(features.H))) * np.sqrt(2.0 * features.cost)  # the largest b that there can be
    off = np.abs(slopes(made, scene, SMALL, 4e-4) - features.b)
    if mapping == "mutual_information":  # whose b is less what it is at the goal
        off = np.abs(slopes(made, scene, SMALL, 4e-4) - slopes(made, scene, np.zeros(6), 4e-4) - features.b)
    np.testing.assert_array_less(off, INFORMATION * size if mapping == "mutual_information" else PICTURES * size)


@pytest.mark.parametrize("mapping", MAPPINGS)
def test_H_is_the_curvature_of_the_cost_at_the_goal(mapping):
    scene, h = smooth_scene(), 1e-3
    made = extractor(scene, mapping=mapping, interaction="current", switch_px=100.0)
    H = symmetric(made.process(scene.image()).H)
    differences = np.array([
        (np.array(made.process(scene.image(exponential(h * axis))).b)
         - made.process(scene.image(exponential(-h * axis))).b) / (2.0 * h) for axis in np.eye(6)])
    size = np.sqrt(np.diag(H))
    # Information: that it does not change when both images move alike is true but for their rim.
    bound = INFORMATION if mapping == "mutual_information" else PICTURES
    assert np.abs((differences - H) / np.outer(size, size)).max() < bound


def cosines(n):
    """(n, n) of the cosine transform, rows of length 1, written as in the books."""
    k, i = np.mgrid[:n, :n]
    table = np.cos(np.pi * k * (i + 0.5) / n) * np.sqrt(2.0 / n)
    table[0] /= np.sqrt(2.0)
    return table


def zig_zag(count):
    """[(u, v)]: 0 0, 0 1, 1 0, 2 0, 1 1, 0 2, 0 3, ..."""
    order = sorted(np.ndindex(count, count), key=lambda uv: (sum(uv), uv[0] if sum(uv) % 2 == 0 else -uv[0]))
    return order[:count]


def mapped(mapping, images, count):
    """(features, 6 + ...) of pixel images (..., h, w), by the whole of each transform."""
    if mapping == "dct":
        h, w = images.shape[-2:]
        spectrum = cosines(h) @ images @ cosines(w).T
        return np.stack([spectrum[..., v, u] for u, v in zig_zag(count)])
    raise AssertionError(mapping)


def of_pixels(scene, moved, illumination):
    """(columns, h, w): L of the mean of both gradients, what explains the light, and e, by brute force."""
    gauss, _ = kernels(1.0)
    images = [scene.image().astype(float), moved.astype(float)]
    inside = np.s_[BORDER:-BORDER, BORDER:-BORDER]
    L = np.mean([interaction(image, 1.0, scene.x, scene.y, scene.jacobian, scene.plane) for image in images], axis=0)
    star, now = (correlate(image, gauss, gauss)[inside] for image in images)
    return np.stack([*np.moveaxis(L[inside], -1, 0), *[np.ones_like(star), star][:illumination], now - star])


@pytest.mark.parametrize("lens", [(0.0,) * 5, LENS])
@pytest.mark.parametrize("light, columns", [("constant", 0), ("offset", 1), ("gain_and_offset", 2)])
def test_dct_is_that_of_the_lowest_frequencies_in_zig_zag(lens, light, columns):
    scene, count = smooth_scene(lens), 40
    moved = scene.image(exponential(SMALL))
    features = extractor(scene, mapping="dct", dct={"coefficients": count}, illumination=light).process(moved)
    s = mapped("dct", of_pixels(scene, moved, columns), count)
    s -= (C := s[:, 6:-1]) @ np.linalg.lstsq(C, s, rcond=None)[0] if columns else 0.0
    L, e = s[:, :6], s[:, -1]
    size = np.linalg.norm(L, axis=0)
    np.testing.assert_array_less(np.abs(symmetric(features.H) - L.T @ L), 5 * SINGLE * np.outer(size, size))
    np.testing.assert_array_less(np.abs(features.b - L.T @ e), 5 * SINGLE * size * np.linalg.norm(e))
    assert features.cost == pytest.approx(0.5 * e @ e, rel=100 * SINGLE)


def test_all_coefficients_are_the_image_itself():
    scene = smooth_scene()
    moved, pixels = scene.image(exponential(SMALL)), (160 - 2 * BORDER) * (120 - 2 * BORDER)
    plain = extractor(scene).process(moved)
    whole = extractor(scene, mapping="dct", dct={"coefficients": pixels}).process(moved)
    np.testing.assert_allclose(whole.H, plain.H, rtol=0, atol=SINGLE * max(plain.H))  # rotations change no length
    assert whole.cost == pytest.approx(plain.cost, rel=SINGLE)


def test_principal_components_lose_nothing_of_a_view_near_the_goal():
    scene = TexturedPlane(camera_info(), TILTED)
    moved = scene.image(exponential(SMALL))
    plain, few, many = (extractor(scene, **config).process(moved) for config in (
        {}, {"mapping": "pca", "pca": {"components": 8}}, {"mapping": "pca", "pca": {"components": 80}}))
    # Components are a part of the image, and the more there are the larger; a view that was not drawn is in their span.
    assert few.cost < many.cost < plain.cost
    near = extractor(scene, mapping="pca", pca={"components": 80, "views": 200, "spread": 0.01}).process(moved)
    assert near.cost > 0.97 * plain.cost


def test_mixture_is_the_sum_of_a_gaussian_at_every_pixel():
    scene, extension = smooth_scene(), 5.0
    moved = scene.image(exponential(SMALL))
    features = extractor(scene, mapping="mixture", mixture={
        "extension_px": extension, "final_extension_px": extension}).process(moved)
    h, w = 120 - 2 * BORDER, 160 - 2 * BORDER
    pitch = int(extension)

    def gaussians(n):
        middle = (n - 1 - (n // pitch - 1) * pitch) // 2 + pitch * np.arange(n // pitch)
        return np.exp(-0.5 * ((np.arange(n) - middle[:, None]) / extension) ** 2)

    s = (gaussians(h) @ of_pixels(scene, moved, 0) @ gaussians(w).T).reshape(7, -1).T
    s *= pitch / (2.0 * np.pi * extension**2)
    L, e = s[:, :6], s[:, -1]
    size = np.linalg.norm(L, axis=0)
    cut = 1e-3  # of the Gaussians, beyond four standard deviations
    np.testing.assert_array_less(np.abs(symmetric(features.H) - L.T @ L), cut * np.outer(size, size))
    np.testing.assert_array_less(np.abs(features.b - L.T @ e), cut * size * np.linalg.norm(e))


def test_gaussians_shrink_as_the_camera_comes_near():
    scene = TexturedPlane(camera_info(), TILTED)
    made = extractor(scene, mapping="mixture", mixture={"extension_px": 16.0, "final_extension_px": 1.0})
    final = extractor(scene, mapping="mixture", mixture={"extension_px": 1.0, "final_extension_px": 1.0})
    far, near = (scene.image(exponential(size * SMALL)) for size in (8.0, 0.2))
    assert made.process(far).cost < 0.5 * final.process(far).cost  # of wide Gaussians
    assert made.process(near).H == final.process(near).H


@pytest.mark.parametrize("mapping", MAPPINGS)
def test_step_undoes_a_small_displacement(mapping):
    scene = smooth_scene()
    step = step_of(extractor(scene, mapping=mapping).process(scene.image(exponential(SMALL))))
    # Information has the Hessian of the goal, whose step is of first order.
    off = 0.3 if mapping == "mutual_information" else 0.03
    np.testing.assert_allclose(step, -SMALL, atol=off * np.abs(SMALL).max())


FAR = np.array([0.03, -0.025, 0.02, 0.02, -0.02, 0.06])  # 6 px and more


def homeward(made, scene, X, images=60, seen=None):
    """Distance from the goal in metres after so many steps, each half of what the features ask for."""
    for _ in range(images):
        view = scene.image(X)
        X = X @ exponential(0.5 * step_of(made.process(view if seen is None else seen(view))))
    return np.linalg.norm(X[:3, 3])


@pytest.mark.parametrize("mapping", MAPPINGS)
def test_closed_loop_arrives(mapping):
    scene = TexturedPlane(camera_info(), shortest_m=0.1, seed=3)
    made = extractor(scene, scene.plane, mapping=mapping)
    X = exponential(FAR)
    assert np.linalg.norm(X[:3, 3]) > 0.04
    assert homeward(made, scene, X) < 2e-4


def dimmed(view):
    """Another light: not a line but a curve of the grey levels, and less of it."""
    return np.rint(180.0 * (view / 255.0) ** 1.7).astype(np.uint8)


def covered(view):
    """A fifth of the view behind something dark."""
    out = view.copy()
    out[30:90, 20:84] = 20
    return out


@pytest.mark.parametrize("seen, near_m", [(dimmed, 0.003), (covered, 0.008)])
def test_information_bears_light_and_cover_where_grey_levels_do_not(seen, near_m):
    scene = TexturedPlane(camera_info(), shortest_m=0.1, seed=3)
    X = exponential(0.5 * FAR)
    fine = {"mutual_information": {"bins": 16}}  # more exact than few, from less far
    informed, plain = (homeward(extractor(scene, scene.plane, mapping=mapping, **fine), scene, X, 100, seen)
                       for mapping in ("mutual_information", "none"))
    assert informed < near_m and plain > 3 * near_m, (informed, plain)


@pytest.mark.parametrize("mapping", MAPPINGS)
def test_same_images_give_the_same_bits(mapping):
    scene, runs = TexturedPlane(camera_info(lens=LENS), TILTED), []
    for _ in range(2):
        made = extractor(scene, mapping=mapping)
        features = [made.process(scene.image(exponential(size * SMALL))) for size in (5.0, 1.0, 5.0)]
        runs.append([(one.H, one.b, one.cost, one.condition) for one in features])
        assert runs[-1][0] == runs[-1][2]  # nothing is carried from image to image
    assert runs[0] == runs[1]


def test_views_of_another_seed_have_other_components():
    scene, image = TexturedPlane(camera_info(), TILTED), None
    image = scene.image(exponential(SMALL))
    H = [extractor(scene, mapping="pca", pca={"seed": seed}).process(image).H for seed in (1, 2)]
    assert H[0] != H[1]


@pytest.mark.parametrize("config, texts", [
    ({"mapping": "wavelets"}, ["vision.photometric.mapping: found wavelets"]),
    ({"mapping": "dct", "dct": {"coefficients": 5}}, ["vision.photometric.dct.coefficients: found 5"]),
    ({"mapping": "pca", "pca": {"components": 20, "views": 10, "spread": 0.0}},
     ["vision.photometric.pca.spread", "vision.photometric.pca.components: found 20, allowed <= views, 10"]),
    ({"mapping": "mixture", "levels": 2, "mixture": {"extension_px": 2.0, "final_extension_px": 3.0}},
     ["vision.photometric.levels: found 2", "final_extension_px: found 3, allowed <= extension_px, 2"]),
    ({"mapping": "mutual_information", "interaction": "mean", "illumination": "offset",
      "mutual_information": {"bins": 3}},
     ["interaction: found mean, allowed current", "illumination: found offset", "mutual_information.bins: found 3"])])
def test_every_fault_of_the_settings_is_listed(config, texts):
    with pytest.raises(camera.ParameterError) as caught:
        camera.PhotometricExtractor(camera_info(), config)
    for text in texts:
        assert text in str(caught.value), str(caught.value)


def test_more_coefficients_than_pixels_are_refused():
    scene = smooth_scene()
    with pytest.raises(camera.ParameterError, match="dct.coefficients: found 14001, allowed at most 14000"):
        extractor(scene, mapping="dct", dct={"coefficients": 14001})


@pytest.mark.parametrize("mapping", MAPPINGS)
def test_a_blank_view_is_not_valid_and_cannot_be_taught(mapping):
    scene, blank = smooth_scene(), np.full((120, 160), 128, np.uint8)
    made = extractor(scene, mapping=mapping)
    assert not made.process(blank).valid and made.process(scene.image()).valid
    with pytest.raises(camera.DegenerateFeature):
        made.set_reference(blank, 0.6)
    stripes = np.tile((128 + 60 * np.sin(0.2 * np.arange(160))).astype(np.uint8), (120, 1))
    with pytest.raises(camera.DegenerateFeature, match="photometric reference"):
        made.set_reference(stripes, 0.6)
