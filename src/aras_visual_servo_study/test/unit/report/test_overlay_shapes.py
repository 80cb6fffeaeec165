"""What each kind of overlay makes of values that are known: points, segments, poses, frames of an image."""
import dataclasses

import numpy as np
import pytest
from synthetic import X_WCG, make_record

pytest.importorskip("cv2")
from aras_visual_servo.spatial import exponential, rotation_vector  # noqa: E402
from aras_visual_servo_study.report.image_plot import image_plot  # noqa: E402
from aras_visual_servo_study.report.overlays import base, overlay_of  # noqa: E402
from aras_visual_servo_study.report.overlays.photometric import photometric  # noqa: E402
from aras_visual_servo_study.report.overlays.points import points  # noqa: E402
from aras_visual_servo_study.report.overlays.pose import DISPLACEMENT, pose, reference  # noqa: E402

FOCAL_PX, WIDTH, HEIGHT = 100.0, 64, 48
INFO = {"width": WIDTH, "height": HEIGHT, "K": [FOCAL_PX, 0, 31.5, 0, FOCAL_PX, 23.5, 0, 0, 1]}
MIDDLE = np.array([31.5, 23.5])
ROUNDING = 1e-9


def scene_of(names, **changes):
    """A scene whose features have the values of `changes` at the only image of the servo, and those at the goal.

    changes: name -> (value, value at the goal), or X_WT.
    """
    record = make_record(feature_names=tuple(names), servo_images=1)
    s, s_star = record.s.copy(), record.s_star.copy()
    for column, name in enumerate(names):
        s[record.servo_rows, column], s_star[record.servo_rows, column] = changes.pop(name, (0.0, 0.0))
    return base.Scene(dataclasses.replace(record, s=s, s_star=s_star, camera_info=INFO, **changes))


def px(x, y):
    return MIDDLE + FOCAL_PX * np.array([x, y])


@pytest.mark.parametrize("angle, way", [(0.0, (1.0, 0.0)), (0.5 * np.pi, (0.0, 1.0)), (np.pi / 6, (0.75**0.5, 0.5))])
def test_both_ends_of_a_segment_are_half_its_length_from_its_middle(angle, way):
    names = ("xm2", "ym2", "l2", "alpha2")
    scene = scene_of(names, xm2=(0.1, 0.0), ym2=(-0.05, 0.02), l2=(0.2, 0.1), alpha2=(angle, angle))
    overlay = points(scene, names)
    assert [one.name + one.subscript for one in overlay.ways] == ["point2", "point2'"]
    for one, side in zip(overlay.ways, (-1.0, 1.0)):
        np.testing.assert_allclose(one.seen[0], px(0.1, -0.05) + side * 10.0 * np.array(way), atol=ROUNDING)
        np.testing.assert_allclose(one.wanted, px(0.0, 0.02) + side * 5.0 * np.array(way), atol=ROUNDING)
    assert overlay.shapes[0].seen.shape == (1, 2, 2) and not overlay.shapes[0].closed


@pytest.mark.parametrize("count, closed", [(1, None), (2, False), (3, True), (4, True)])
def test_three_points_and_more_are_joined_to_a_ring(count, closed):
    names = [f"{axis}{n}" for n in range(1, count + 1) for axis in "xy"]
    values = {name: (0.01 * k, -0.02 * k) for k, name in enumerate(names)}
    overlay = points(scene_of(names, **values), names)
    assert [shape.closed for shape in overlay.shapes] == ([] if closed is None else [closed])
    for k, one in enumerate(overlay.ways):
        np.testing.assert_allclose(one.seen[0], px(0.02 * k, 0.02 * k + 0.01), atol=ROUNDING)
        np.testing.assert_allclose(one.wanted, px(-0.04 * k, -0.04 * k - 0.02), atol=ROUNDING)
    for shape in overlay.shapes:
        np.testing.assert_allclose(shape.seen[0], [one.seen[0] for one in overlay.ways])
        np.testing.assert_allclose(shape.wanted, [one.wanted for one in overlay.ways])


#: A target 0.5 m below the goal camera, tilted, whose frame is not the camera's.
X_CGT = exponential(np.array([0.02, -0.01, 0.5, 0.3, -0.2, 0.4]))
AWAY = (0.03, -0.02, 0.04, 0.1, -0.2, 0.3)


def displaced():
    X = np.eye(4)
    X[:3, 3] = AWAY[:3]
    X[:3, :3] = exponential(np.array([0, 0, 0, *AWAY[3:]]))[:3, :3]
    np.testing.assert_allclose(rotation_vector(X[:3, :3]), AWAY[3:], atol=ROUNDING)
    return X


def seen(X_CT, p_T=(0.0, 0.0, 0.0)):
    x, y, z, _ = X_CT @ [*p_T, 1.0]
    return px(x / z, y / z)


def test_the_frame_of_the_target_is_where_the_displacement_puts_it():
    scene = scene_of(DISPLACEMENT, X_WT=X_WCG @ X_CGT, **{name: (x, 0.0) for name, x in zip(DISPLACEMENT, AWAY)})
    overlay = pose(scene, DISPLACEMENT)
    here, [origin] = np.linalg.inv(displaced()) @ X_CGT, overlay.ways
    np.testing.assert_allclose(origin.seen[0], seen(here), atol=ROUNDING)
    np.testing.assert_allclose(origin.wanted, seen(X_CGT), atol=ROUNDING)
    length_m = 0.13 * WIDTH / FOCAL_PX * X_CGT[2, 3]
    for axis, shape in enumerate(overlay.shapes[:3]):
        end = length_m * np.eye(3)[axis]
        np.testing.assert_allclose(shape.seen[0], [seen(here), seen(here, end)], atol=ROUNDING)
        np.testing.assert_allclose(shape.wanted, [seen(X_CGT), seen(X_CGT, end)], atol=ROUNDING)


def test_without_a_whole_displacement_the_frame_is_where_it_truly_is():
    names = DISPLACEMENT[:3]
    scene = scene_of(names, X_WT=X_WCG @ X_CGT)
    truly = np.linalg.inv(scene.record.X_WC[scene.rows[0]]) @ X_WCG @ X_CGT
    np.testing.assert_allclose(pose(scene, names).ways[0].seen[0], seen(truly), atol=ROUNDING)
    gone = scene_of(DISPLACEMENT, X_WT=X_WCG @ X_CGT, tx=(np.nan, 0.0))
    assert np.isnan(pose(gone, DISPLACEMENT).ways[0].seen).all()


def test_the_ring_of_the_reference_point_grows_as_it_comes_nearer():
    names = ("xr", "yr", "zr")
    overlay = reference(scene_of(names, xr=(0.1, 0.0), yr=(-0.1, 0.05), zr=(-np.log(2.0), 0.0)), names)
    [ring], [point] = overlay.shapes, overlay.ways
    np.testing.assert_allclose(point.seen[0], px(0.1, -0.1), atol=ROUNDING)
    for places, middle, radius in ((ring.seen[0], px(0.1, -0.1), 2 * 0.03 * WIDTH),
                                   (ring.wanted, px(0.0, 0.05), 0.03 * WIDTH)):
        np.testing.assert_allclose(np.linalg.norm(places - middle, axis=1), radius)
        np.testing.assert_allclose(places.mean(axis=0), middle, atol=ROUNDING)
    assert ring.closed and not reference(scene_of(names[:2]), names[:2]).shapes
    assert reference(scene_of(names), ("xr",)) == base.Overlay()


def test_the_frame_of_the_image_is_half_as_large_and_moves_with_the_plane():
    scene = scene_of(("photometric",), X_WT=X_WCG @ X_CGT)
    overlay = photometric(scene, ("photometric",))
    quarter = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * [WIDTH / 4, HEIGHT / 4]
    np.testing.assert_allclose(overlay.shapes[0].wanted, MIDDLE + quarter, atol=1e-6)
    np.testing.assert_allclose([way.wanted for way in overlay.ways], MIDDLE + quarter, atol=1e-6)
    X_CgC = np.linalg.inv(X_WCG) @ scene.record.X_WC[scene.rows[0]]
    normal, p = X_CGT[:3, 2], X_CGT[:3, 3]
    for way, corner in zip(overlay.ways, quarter / FOCAL_PX):
        on_plane = np.array([*corner, 1.0]) * (normal @ p) / (normal @ [*corner, 1.0])
        x, y, z, _ = np.linalg.inv(X_CgC) @ [*on_plane, 1.0]
        np.testing.assert_allclose(way.seen[0], px(x / z, y / z), atol=1e-6)
    assert overlay.difference and overlay.shapes[0].closed


def test_of_a_target_that_is_not_known_nothing_is_drawn():
    scene = scene_of(DISPLACEMENT)
    now, then = scene.target
    assert now.shape == (1, 4, 4) and then.shape == (4, 4) and np.isnan(now).all() and np.isnan(then).all()
    assert scene.outline("outline", "#000000") == () and overlay_of(scene.record) == base.Overlay()
    assert image_plot(scene.record) is None


def test_a_target_that_moves_is_at_each_image_where_it_was():
    record = make_record(servo_images=2)
    poses = np.array([X_WCG @ X_CGT @ exponential(np.array([0.01 * k, 0, 0, 0, 0, 0.1 * k]))
                      for k in range(len(record))])
    scene = base.Scene(dataclasses.replace(record, camera_info=INFO, X_WT=np.eye(4), target_poses=poses))
    now, then = scene.target
    for X_CT, row in zip([*now, then], [*scene.rows, scene.goal]):
        np.testing.assert_allclose(X_CT, np.linalg.inv(record.X_WC[row]) @ poses[row], atol=ROUNDING)


def test_a_point_behind_the_camera_is_not_seen():
    scene = scene_of(("xn",))
    ahead, behind = np.eye(4), np.eye(4)
    ahead[2, 3], behind[2, 3] = 0.5, -0.5
    pixels = scene.seen_in(np.array([[0.1, 0.0, 0.0]]), np.array([ahead, behind]))
    np.testing.assert_allclose(pixels[0], [px(0.2, 0.0)])
    assert np.isnan(pixels[1]).all()


@pytest.mark.parametrize("corners, shown", [(4, 4), (32, 32), (33, 32), (400, 32)])
def test_an_outline_has_its_corners_or_some_of_them_from_the_first_to_the_last(corners, shown):
    scene = scene_of(("xn",), X_WT=X_WCG @ X_CGT)
    scene.corners = np.column_stack([np.linspace(0.0, 0.1, corners), np.zeros((corners, 2))])
    [outline] = scene.outline("outline", "#000000")
    assert outline.seen.shape == (1, shown, 2) and outline.wanted.shape == (shown, 2) and outline.closed
    for place, corner in ((0, 0.0), (-1, 0.1)):
        np.testing.assert_allclose(outline.wanted[place], seen(X_CGT, (corner, 0.0, 0.0)), atol=ROUNDING)


def test_the_legend_of_the_image_says_what_the_star_is():
    record = dataclasses.replace(make_record(), camera_info=INFO)
    names = [one["name"] for one in image_plot(record)["legend"]]
    assert names == ["centroid", "axis", "circle of the same area", "★ and dashed: at the goal"]
