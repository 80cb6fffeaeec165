"""What a frame of the video shows of ways and shapes: every line and ring, in its place, its size and its colour."""
import dataclasses

import numpy as np
import pytest
from synthetic import blob, make_record

pytest.importorskip("cv2")
from aras_visual_servo.palette import BLUE, GREEN, VERMILION, rgb  # noqa: E402
from aras_visual_servo_study.report import video  # noqa: E402
from aras_visual_servo_study.report.overlays.base import Overlay, Shape, Way  # noqa: E402

#: A pixel that a line goes through has at least so much of its colour: lines are smoothed over two pixels.
PART = 0.4
SIZE = 300
NOWHERE = np.full(2, np.nan)


def composer_of(overlay, now=0, record=None):
    """A composer without an observer, at one moment of an overlay."""
    composer = video.Composer.__new__(video.Composer)
    composer._overlay, composer._at, composer._t_s = overlay, [now], [0.25]
    composer._record, composer._rows = record, [0]
    return composer


def drawn(overlay, now=0, scale=1.0):
    """Part of its full colour that each pixel of a black picture has, once the overlay is drawn into it in white."""
    white = dataclasses.replace(
        overlay, ways=tuple(dataclasses.replace(way, name=" ", colour="#ffffff") for way in overlay.ways),
        shapes=tuple(dataclasses.replace(shape, name=" ", colour="#ffffff") for shape in overlay.shapes))
    picture = np.zeros((SIZE, SIZE, 3), np.uint8)
    composer_of(white, now)._draw_overlay(picture, scale, 0)
    return picture.max(axis=2) / 255.0


def shape(seen, wanted=None, closed=False):
    return Shape("shape", BLUE, closed, np.array(seen, dtype=float),
                 None if wanted is None else np.array(wanted, dtype=float))


def way(seen, wanted=NOWHERE):
    return Way("way", "", VERMILION, np.array(seen, dtype=float), np.array(wanted, dtype=float))


SQUARE = [[100, 100], [200, 100], [200, 200], [100, 200]]
SIDES = {"top": (100, 150), "right": (150, 200), "bottom": (200, 150), "left": (150, 100)}  # row, column of a middle


def sides(picture):
    return {name for name, place in SIDES.items() if picture[place] > PART}


@pytest.mark.parametrize("closed", [True, False])
def test_a_shape_has_all_its_sides_and_is_closed_only_if_it_says_so(closed):
    wanted = set(SIDES) - (set() if closed else {"left"})
    assert sides(drawn(Overlay(shapes=(shape([SQUARE], closed=closed),)))) == wanted
    far = np.full((1, 4, 2), 20.0)
    assert sides(drawn(Overlay(shapes=(shape(far, SQUARE, closed),)))) == wanted


def test_where_it_is_wanted_a_shape_is_thinner_than_where_it_is():
    def thickness(overlay):
        return drawn(overlay)[90:111, 150].sum()

    far = np.full((1, 4, 2), 20.0)
    assert thickness(Overlay(shapes=(shape([SQUARE], closed=True),))) > \
        1.4 * thickness(Overlay(shapes=(shape(far, SQUARE, True),))) > 0.5


def test_a_way_leads_through_every_place_up_to_now_and_not_back():
    zigzag = way([[100, 100], [200, 100], [200, 200], [100, 200]])
    assert sides(drawn(Overlay((zigzag,)), now=3)) == {"top", "right", "bottom"}
    assert sides(drawn(Overlay((zigzag,)), now=1)) == {"top"}
    gap = way([[100, 100], [200, 100], [np.nan, 0], [200, 200], [100, 200]])
    assert sides(drawn(Overlay((gap,)), now=4)) == {"top", "bottom"}


def test_rings_are_about_the_place_wanted_and_the_dot_where_the_way_is():
    picture = drawn(Overlay((way([[150, 120]]),)))
    filled = np.argwhere(picture > PART)
    np.testing.assert_allclose(filled.mean(axis=0), [120, 150], atol=0.1)
    assert np.abs(filled - [120, 150]).max() == 4 and picture[120, 150] == 1.0
    picture = np.zeros((SIZE, SIZE, 3), np.uint8)
    composer_of(Overlay((way([NOWHERE], (150, 120)),)))._draw_overlay(picture, 1.0, 0)
    ring = (picture == rgb(GREEN)).all(axis=2)
    np.testing.assert_allclose(np.argwhere(ring).mean(axis=0), [120, 150], atol=0.1)
    radius = np.linalg.norm(np.argwhere(ring) - [120, 150], axis=1)
    assert 7.0 <= radius.min() and radius.max() <= 9.0


@pytest.mark.parametrize("scale", [1.0, 2.0, 3.0])
def test_the_middle_of_a_pixel_is_that_of_its_enlarged_square(scale):
    dots = np.argwhere(drawn(Overlay((way([[40, 60]]),)), scale=scale) > PART)
    np.testing.assert_allclose(dots.mean(axis=0), scale * (np.array([60, 40]) + 0.5) - 0.5, atol=0.26)


def test_names_stand_one_below_the_other_in_their_colours():
    overlay = Overlay((way([NOWHERE]),), (shape(np.full((1, 2, 2), np.nan)),))
    picture = np.zeros((SIZE, SIZE, 3), np.uint8)
    composer_of(overlay)._draw_overlay(picture, 1.0, 0)
    blue, red = (np.argwhere((picture.argmax(axis=2) == channel) & (picture.max(axis=2) > 60))[:, 0]
                 for channel in (2, 0))  # the strongest of each colour
    assert 8 < blue.min() < blue.max() < 32
    assert red.min() - blue.min() == pytest.approx(20, abs=3)


@pytest.mark.parametrize("difference, desired, coloured", [(True, True, True), (False, True, False),
                                                           (True, False, False), (False, False, False)])
def test_only_features_of_grey_levels_colour_the_image_by_its_difference(difference, desired, coloured):
    record = dataclasses.replace(make_record(), images={0: blob(8)[..., 0]}, desired_image=blob(0) if desired else None)
    view = composer_of(Overlay(difference=difference), record=record)._camera_view(0)
    assert view.shape == (video.VIEW_HEIGHT, video.HALF, 3)
    assert (np.ptp(view.astype(int), axis=2).max() > 30) == coloured


@pytest.mark.parametrize("size, border", [((48, 64), (0, 0)), ((64, 64), (0, 80)), ((32, 64), (80, 0))])
def test_the_image_is_as_large_as_fits_and_stands_in_the_middle(size, border):
    record = dataclasses.replace(make_record(), images={0: np.full(size, 200, np.uint8)})
    view = composer_of(Overlay(), record=record)._camera_view(0)
    rows, columns = np.argwhere(view.max(axis=2) == 200).T
    height, width = view.shape[:2]
    assert (rows.min(), height - 1 - rows.max()) == (border[0],) * 2
    assert (columns.min(), width - 1 - columns.max()) == (border[1],) * 2


@pytest.fixture(scope="module")
def curves():
    """The plot of the errors in full colours."""
    record = make_record()
    composer = composer_of(Overlay(), record=record)
    composer._rows = record.servo_rows
    composer._t_s = (record.stamp_ns[record.servo_rows] - record.stamp_ns[record.servo_rows[0]]) * 1e-9
    return composer._curves()


def test_both_axes_of_the_curves_have_a_name_and_numbers(curves):
    _, full, left, right = curves
    dark = full.max(axis=2) < 140
    assert (left, right) == pytest.approx((102.4, 1254.4))
    assert dark[:, int(left) - 1:int(left) + 2].mean(axis=0).max() > 0.6, "the axis is where the columns say"
    used = np.flatnonzero(dark[:, :int(left) - 2].any(axis=0))
    gaps = np.flatnonzero(np.diff(used) > 4)
    assert used[0] < 50 and used[-1] > 80 and len(gaps) >= 1, "the name, then the numbers"
    assert dark[-20:, 500:860].any() and dark[-45:-25, 200:1200].any()


def test_a_moment_that_has_not_come_is_faint(curves):
    faint, full, left, right = curves
    window = (slice(10, 170), slice(int(left) + 8, int(right) // 2))
    bright, pale = (np.ptp(picture[window].astype(int), axis=2).max() for picture in (full, faint))
    assert bright > 150 and 20 < pale < 0.4 * bright
