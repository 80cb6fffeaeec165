"""Where a flat target's outline lies in the image: against OpenCV's projection, and its distance from each border."""

from math import inf, tan
from types import SimpleNamespace

import cv2
import numpy as np
import pytest

from aras_visual_servo.features.target.outline import Outline
from aras_visual_servo.spatial import inverse, pose_from_rpy, rotation_vector

OUTLINES = ([(-0.1, -0.05), (0.1, -0.06), (0.02, 0.07)], [(0.15, 0.1), (0.2, 0.1), (0.2, 0.12)])
CAMERA = {"width": 320, "height": 240, "fx_px": 195.0, "fy_px": 200.0, "cx_px": 150.5, "cy_px": 123.0}
LENSES = {"none": [], "k1": [-0.3], "two": [-0.3306, 0.117], "all": [0.1, -0.05, 0.01, -0.02, 0.03]}
X_WT = pose_from_rpy((0.3, -0.2, 0.1), (0.05, -0.1, 0.4))
X_WC = X_WT @ pose_from_rpy((0.02, -0.03, 0.5), (np.pi + 0.1, 0.2, 0.3))
ROUNDING = 1e-9  # [px]


def outline(camera=CAMERA, outlines=OUTLINES, **more):
    return Outline(outlines, X_WT, {**camera, **more})


@pytest.mark.parametrize("lens", LENSES.values(), ids=list(LENSES))
def test_corners_are_where_opencv_projects_them(lens):
    shown = outline(distortion=lens)
    X_CT = inverse(X_WC) @ X_WT
    K = np.array([[195.0, 0.0, 150.5], [0.0, 200.0, 123.0], [0.0, 0.0, 1.0]])
    expected = cv2.projectPoints(shown.points_T, rotation_vector(X_CT[:3, :3]), X_CT[:3, 3], K,
                                 np.array([*lens, *[0.0] * 5][:5]))[0][:, 0]
    assert len(shown.points_T) == 6 and not shown.points_T[:, 2].any()
    np.testing.assert_allclose(shown.pixels(X_WC), expected, atol=ROUNDING)
    moved = pose_from_rpy((0.01, 0.02, 0.03), (0.0, 0.0, 0.1))  # another place of the target, and a stack of poses
    np.testing.assert_allclose(shown.pixels(moved @ X_WC, moved @ X_WT), expected, atol=ROUNDING)
    both = shown.pixels(np.array([X_WC, X_WC @ moved]))
    np.testing.assert_allclose(both, [expected, shown.pixels(X_WC @ moved)], atol=ROUNDING)


def test_a_field_of_view_stands_for_a_focal_length_and_the_middle_for_a_principal_point():
    camera = {"width": 320, "height": 240, "horizontal_fov_rad": 1.41}
    f = 160.0 / tan(0.705)
    given = {"width": 320, "height": 240, "fx_px": f, "fy_px": f, "cx_px": 159.5, "cy_px": 119.5}
    np.testing.assert_allclose(outline(camera).pixels(X_WC), outline(given).pixels(X_WC), atol=ROUNDING)
    assert outline(camera).half == pytest.approx((160.0 / f, 120.0 / f))
    assert outline().half == pytest.approx((160.0 / 195.0, 120.0 / 200.0))


@pytest.mark.parametrize("aside_px, expected", [((0.0, 0.0), 90.5 - 10.0), ((-80.0, 0.0), 70.5), ((80.0, 0.0), 69.5),
                                                ((0.0, 60.0), 49.5), ((0.0, -60.0), 50.5), ((-200.0, 0.0), -49.5),
                                                ((0.0, 150.0), -40.5)])
def test_the_distance_is_that_from_the_nearest_border(aside_px, expected):
    square = [(-0.1, -0.1), (0.1, -0.1), (0.1, 0.1), (-0.1, 0.1)]  # 20 px either side of the middle, seen from 1 m
    middle = {"fx_px": 100.0, "fy_px": 100.0, "cx_px": 160.0 + aside_px[0], "cy_px": 120.0 + aside_px[1]}
    X = X_WT @ pose_from_rpy((0.0, 0.0, 1.0), (np.pi, 0.0, 0.0))
    shown = outline({"width": 320, "height": 240, **middle}, [square])
    corner = {"left": middle["cx_px"] - 10.0 + 0.5, "right": 319.5 - middle["cx_px"] - 10.0,
              "top": middle["cy_px"] - 10.0 + 0.5, "bottom": 239.5 - middle["cy_px"] - 10.0}
    assert shown.border_px(X) == pytest.approx(min(corner.values()), abs=ROUNDING)
    # Of several poses the nearest counts.
    back = X @ pose_from_rpy((0.0, 0.0, -1.0), (0.0, 0.0, 0.0))
    each = [shown.border_px(X), shown.border_px(back)]
    assert shown.border_px(np.array([X, back])) == pytest.approx(min(each), abs=ROUNDING)


def test_what_is_not_before_the_camera_has_no_place():
    behind = X_WT @ pose_from_rpy((0.0, 0.0, 0.5), (0.0, 0.0, 0.0))
    assert outline().pixels(behind) is None and outline().border_px(behind) == -inf
    assert outline().pixels(np.array([X_WC, behind])) is None
    within = X_WT @ pose_from_rpy((0.0, 0.0, 0.0), (np.pi, 0.0, 0.0))  # in the target's plane: a depth of zero
    assert outline().pixels(within) is None


def scenario_of(models, camera=CAMERA, base=None, **robot):
    return SimpleNamespace(sim={"scene": {"models": models}, "cameras": [camera]}, robot=robot, _base=base)


def test_the_outline_of_a_scenario_stands_in_it_or_in_the_file_of_its_first_model(tmp_path):
    (tmp_path / "flat.yaml").write_text("outlines_m:\n  - [[0, 0], [0.1, 0], [0.1, 0.2]]\n")
    for model in ({"outlines_m": [[(0.0, 0.0), (0.1, 0.0), (0.1, 0.2)]]}, {"file": "flat.yaml"}):
        found = Outline.of(scenario_of([{**model, "position_m": (1.0, 2.0, 3.0)}, {"outlines_m": OUTLINES}],
                                       base=tmp_path))
        np.testing.assert_allclose(found.points_T, [[0, 0, 0], [0.1, 0, 0], [0.1, 0.2, 0]])
        np.testing.assert_allclose(found.X_WT, pose_from_rpy((1.0, 2.0, 3.0), (0.0, 0.0, 0.0)))


@pytest.mark.parametrize("models, camera", [
    ([], CAMERA), ([{}], CAMERA), ([{"file": "nowhere.yaml"}], CAMERA),
    ([{"outlines_m": OUTLINES, "motion": {}}], CAMERA),
    ([{"outlines_m": OUTLINES}], {"width": 320, "height": 240}),
    ([{"outlines_m": OUTLINES}], {**CAMERA, "distortion_model": "equidistant"})])
def test_where_it_cannot_be_known_there_is_none(models, camera, tmp_path):
    assert Outline.of(scenario_of(models, camera, tmp_path)) is None
    known = {**CAMERA, "distortion_model": "plumb_bob"}
    assert Outline.of(scenario_of([{"outlines_m": OUTLINES}], known, tmp_path)) is not None


def test_a_target_that_the_arm_carries_is_that_of_the_scenario_where_it_says_so():
    carried = [{"outlines_m": OUTLINES, "attached_to": "tool"}]
    assert Outline.of(scenario_of(carried)) is None and Outline.of(scenario_of(carried, target_link="other")) is None
    assert Outline.of(scenario_of(carried, target_link="tool")) is not None
