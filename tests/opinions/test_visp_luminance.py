"""Law photometric and the normal equations of the camera against ViSP's vpFeatureLuminance and vpServo.

What differs by design: ViSP derives along rows and columns without smoothing across them, this project takes the
derivative of a Gaussian in both; ViSP's depth is one for all pixels, ours that of a plane. Of images whose grey levels
are polynomials of second order both derivatives are exact, and a plane parallel to the image has one depth: there,
nothing differs.
"""
import itertools
from types import SimpleNamespace

import numpy as np
from textured_plane import TexturedPlane, camera_info, exponential, symmetric
from views import look_at
from visp import visp_servo

import aras_visual_servo_camera as camera
import aras_visual_servo as avs
from aras_visual_servo.laws.base import LawSetup, make_law
from aras_visual_servo.laws.photometric import PhotometricSettings

CASES = 60
INTERACTIONS = ("desired", "current", "mean")
GAIN_PER_S = 2.0
#: Of a twist's length: rounding times the condition of the normal equations, at most 1e6.
SAME = 1e-9
#: Of H, scaled to a diagonal of ones, and of b: the camera sums in single precision, see test_photometric.py there.
SINGLE = 1e-5
#: Rows and columns that ViSP leaves out on each side; ours by default too.
BORDER = 10
Z_M = 0.625


def asked(info, images, interaction):
    K = info["K"]
    return {"kind": "luminance", "gain_per_s": GAIN_PER_S, "interaction": interaction, "width": info["width"],
            "height": info["height"], "camera": [K[0], K[4], K[2], K[5]], "z_m": Z_M,
            "image_star": images[0].tobytes().hex(), "image": images[1].tobytes().hex()}


def of_textures():
    """[case] of a textured plane, seen from the goal and from nearby."""
    for seed in range(CASES):
        rng = np.random.default_rng(seed)
        scene = TexturedPlane(camera_info(64, 48), (0.0, 0.0, 1.0 / Z_M), shortest_m=0.1, seed=seed)
        xi = np.r_[rng.uniform(-0.01, 0.01, 3), rng.uniform(-0.02, 0.02, 3)]
        yield asked(scene.info, (scene.image(), scene.image(exponential(xi))), INTERACTIONS[seed % 3])


def test_law_is_vp_servo_on_the_same_normal_equations(compared):
    differences = []
    for theirs in visp_servo(list(of_textures())):
        L, e = theirs["matrix"], theirs["error"]
        law = make_law("photometric", [GAIN_PER_S], LawSetup(
            ("photometric",), settings={"photometric": PhotometricSettings(0.0, 1e-4, 1e-4)}))
        law.reset(avs.Reference(np.zeros(1)))
        seen = SimpleNamespace(has_reference=True, rms=float(np.sqrt(np.mean(e**2))), b=(L.T @ e).tolist(),
                               H=(L.T @ L)[np.triu_indices(6)].tolist(), condition=5.0, symmetric=False)
        twist = law.step(look_at(seen)).twist
        differences.append(np.abs(twist - theirs["twist"]).max() / np.linalg.norm(theirs["twist"]))
    compared("`photometric` without damping", "ViSP vpServo, vpFeatureLuminance", differences, SAME)


def polynomials(seed):
    """(camera_info, (reference, current)): grey levels of second order whose second derivatives are the same."""
    rng = np.random.default_rng(seed)
    while True:
        half_u, half_v = rng.integers(BORDER + 1, BORDER + 5, 2)
        u, v = np.meshgrid(np.arange(-half_u, half_u + 1), np.arange(-half_v, half_v + 1))
        bend_u, bend_v, twist = rng.integers(-1, 2, 3)
        bent = bend_u * u * (u + 1) // 2 + bend_v * v * (v + 1) // 2 + twist * u * v
        images = [bent + slope_u * u + slope_v * v for slope_u, slope_v in rng.integers(-5, 6, (2, 2))]
        least = min(image.min() for image in images)
        images = [image - least for image in images]
        if max(image.max() for image in images) <= 255 and (bend_u or bend_v or twist):
            break
    width, height = 2 * int(half_u) + 1, 2 * int(half_v) + 1
    K = [rng.uniform(8, 40), 0.0, rng.uniform(0, width), 0.0, rng.uniform(8, 40), rng.uniform(0, height), 0.0, 0.0, 1.0]
    info = {"width": width, "height": height, "K": K, "D": [0.0] * 5, "distortion_model": "plumb_bob"}
    return info, [np.ascontiguousarray(image, dtype=np.uint8) for image in images]


def normal_equations(info, images, interaction):
    """The camera's features; None where six motions look alike in one of so small images."""
    extractor = camera.PhotometricExtractor(info, {"interaction": interaction, "min_contrast": 0.1})
    try:
        extractor.set_reference(images[0], Z_M)
    except camera.DegenerateFeature:
        return None
    found = extractor.process(images[1])
    return found if found.valid else None


def test_normal_equations_are_those_of_vp_feature_luminance(compared):
    cases, seeds = [], itertools.count()
    while len(cases) < CASES:
        info, images = polynomials(next(seeds))
        interaction = INTERACTIONS[len(cases) % 3]
        found = normal_equations(info, images, interaction)
        if found is not None:
            cases.append((info, found, asked(info, images, interaction)))
    H_off, b_off = [], []
    for (info, found, _), theirs in zip(cases, visp_servo([case[-1] for case in cases])):
        L, e = theirs["matrix"], theirs["error"]
        assert found.pixels == len(e) == (info["width"] - 2 * BORDER) * (info["height"] - 2 * BORDER)
        size = np.sqrt(np.diag(L.T @ L))
        H_off.append((np.abs(symmetric(found.H) - L.T @ L) / np.outer(size, size)).max())
        b_off.append((np.abs(np.array(found.b) - L.T @ e) / (size * np.linalg.norm(e))).max())
    compared("photometric H, quadratic image", "ViSP vpFeatureLuminance", H_off, SINGLE)
    compared("photometric b, quadratic image", "ViSP vpFeatureLuminance", b_off, SINGLE)
