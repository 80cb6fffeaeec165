"""Pictures of the page that stand there without a script: every line, mark and number in its place."""
import dataclasses
import math
import re

import numpy as np
import pytest
from synthetic import make_record

from aras_visual_servo.palette import GREEN
from aras_visual_servo_study.report import plots
from aras_visual_servo_study.report.plots import HEIGHT, LEFT, RIGHT, WIDTH, nice_ticks, plots_of, tick_text

TENTH = 0.051  # of a pixel, to which places are rounded
#: The view from 57 deg right of the world's x axis and 30 deg above: directions to the right and up in the picture.
AZIMUTH, ELEVATION = math.radians(-57.0), math.radians(30.0)
TO_RIGHT = np.array([-math.sin(AZIMUTH), math.cos(AZIMUTH), 0.0])
UP = np.array([-math.sin(ELEVATION) * math.cos(AZIMUTH), -math.sin(ELEVATION) * math.sin(AZIMUTH), math.cos(ELEVATION)])
MIDDLE = np.array([WIDTH / 2, HEIGHT / 2 - 8])
WAY, GOAL = [[0.2, 0.1, 0.9], [0.16, 0.14, 0.84], [0.1, 0.18, 0.8]], [0.05, 0.2, 0.78]
WIDE, TALL = (WAY, GOAL), ([[0.0, 0.0, 0.1], [0.01, 0.02, 0.5]], [0.02, 0.0, 0.6])
NUMBER = r"(-?\d+\.\d)"


class Picture:
    """The picture of a path: `at` is where a point must be, `low` and `high` are corners of the box."""

    def __init__(self, way, goal):
        self.svg = plots._path_svg({"p": way, "goal": goal})
        centre, half = plots.path_box({"p": way, "goal": goal})
        self.low, self.high = centre - half, centre + half
        self.corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]) * 2 * half - half
        bounds = np.abs(np.column_stack([self.corners @ TO_RIGHT, self.corners @ UP])).max(axis=0)
        scale = min((np.array([WIDTH - 120, HEIGHT - 80]) / 2) / bounds)
        self.at = lambda p: MIDDLE + scale * np.array([TO_RIGHT @ (np.array(p) - centre), -UP @ (np.array(p) - centre)])

    def lines(self, kind):
        found = re.findall(f'<path class="{kind}" d="M{NUMBER} {NUMBER}L{NUMBER} {NUMBER}"/>', self.svg)
        return [np.array(one, dtype=float).reshape(2, 2) for one in found]

    def polyline(self, kind):
        [points] = re.findall(f'<polyline class="{kind}"[^>]* points="([^"]*)"/>', self.svg)
        return np.array([[float(x) for x in point.split(",")] for point in points.split()])

    def texts(self):
        """[(place, side it stands on, text)]"""
        found = re.findall(f'<text x="{NUMBER}" y="{NUMBER}" text-anchor="(\\w+)">([^<]*)<', self.svg)
        return [(np.array([x, y], dtype=float), anchor, text) for x, y, anchor, text in found]


@pytest.fixture(params=[WIDE, TALL], ids=["wide", "tall"])
def picture(request):
    return Picture(*request.param)


def near(found, wanted):
    np.testing.assert_allclose(found, wanted, atol=TENTH)


def test_the_way_its_shadow_its_start_and_its_goal_are_where_they_are_seen_from_the_side():
    picture = Picture(*WIDE)
    near(picture.polyline("curve"), [picture.at(p) for p in WAY])
    near(picture.polyline("shadow"), [picture.at([*p[:2], picture.low[2]]) for p in WAY])
    [start] = re.findall(f'<circle cx="{NUMBER}" cy="{NUMBER}"', picture.svg)
    near(np.array(start, dtype=float), picture.at(WAY[0]))
    [star] = re.findall(f'<path d="M([^"]*)Z" fill="{GREEN}"/>', picture.svg)
    corners = np.array([one.split() for one in star.split("L")], dtype=float)
    near(corners.mean(axis=0), picture.at(GOAL))
    assert f'fill="{GREEN}"' not in Picture(WAY, None).svg


def test_the_box_is_drawn_at_its_bottom_and_along_the_post_of_the_heights(picture):
    (x0, y0, z0), (x1, y1, z1) = picture.low, picture.high
    near(picture.polyline("frame"), [picture.at(p) for p in ((x0, y0, z0), (x1, y0, z0), (x1, y1, z0), (x0, y1, z0),
                                                             (x0, y0, z0))])
    [post] = picture.lines("frame")
    near(post, [picture.at((x0, y0, z0)), picture.at((x0, y0, z1))])


def test_grid_and_numbers_stand_at_the_near_sides_of_the_box(picture):
    (x0, y0, z0), (x1, y1, z1) = picture.low, picture.high
    lines, texts = iter(picture.lines("grid")), iter(picture.texts())
    for axis, name, anchor, side in ((0, "x", "end", -1), (1, "y", "start", 1)):
        ticks, step = nice_ticks(picture.low[axis], picture.high[axis], 4)
        for value in ticks:
            ends = ((value, y0, z0), (value, y1, z0)) if axis == 0 else ((x0, value, z0), (x1, value, z0))
            near(next(lines), [picture.at(p) for p in ends])
            place, found, text = next(texts)
            near(place, picture.at(ends[0] if axis == 0 else ends[1]) + [3 * side, 13])
            assert (found, text) == (anchor, tick_text(value, step))
        place, found, text = next(texts)
        middle = picture.at((0.5 * (x0 + x1), y0, z0) if axis == 0 else (x1, 0.5 * (y0 + y1), z0))
        near(place, middle + [46 * side, 28])
        assert (found, text) == (anchor, name)
    ticks, step = nice_ticks(z0, z1, 3)
    for value in ticks:
        end = picture.at((x0, y0, value))
        near(next(lines), [end - [4, 0], end])
        place, found, text = next(texts)
        near(place, end + [-7, 4])
        assert (found, text) == ("end", tick_text(value, step))
    place, found, text = next(texts)
    near(place, picture.at((x0, y0, z1)) - [0, 9])
    assert (found, text) == ("middle", "z") and not list(lines) and not list(texts)


def test_no_edge_of_the_box_is_under_half_of_the_longest_and_a_way_without_length_has_one():
    centre, half = plots.path_box({"p": [[0.0, 0.0, 0.0], [0.4, 0.1, 0.0]], "goal": [0.2, 0.3, 0.0]})
    np.testing.assert_allclose(centre, [0.2, 0.15, 0.0])
    np.testing.assert_allclose(half, np.array([0.4, 0.3, 0.2]) / 2 * 1.08)
    np.testing.assert_allclose(plots.path_box({"p": [[1.0, 2.0, 3.0]], "goal": None})[1], [0.00054] * 3)


def test_a_star_has_five_points_and_stands_on_two_of_them():
    path = plots.star(100.0, 50.0, 10.0)
    assert path[0] == "M" and path[-1] == "Z"
    corners = np.array([one.split() for one in path[1:-1].split("L")], dtype=float) - [100.0, 50.0]
    angles = np.radians(90.0 - 36.0 * np.arange(10))
    radii = np.where(np.arange(10) % 2, 4.2, 10.0)
    near(corners, np.column_stack([radii * np.cos(angles), -radii * np.sin(angles)]))


def test_lines_at_one_height_take_turns_and_one_alone_has_the_usual_dashes():
    features = plots.styles(("xn", "yn", "an", "alpha"))
    levels = plots._levels(features, {"xn": 0.1, "an": 0.1, "alpha": 0.2})
    assert [(one["y"], one["dash"], one["offset"]) for one in levels] == [(0.1, "4 10", 0), (0.1, "4 10", -7),
                                                                          (0.2, "4 3", 0)]
    assert [one["color"] for one in levels] == [features[k].colour for k in (0, 2, 3)]


def test_velocities_are_read_off_in_millimetres_and_degrees():
    series = plots_of(make_record())[2]["data"]["series"]
    assert [(one["name"], one["sub"], one["unit"]) for one in series] == [
        (letter, axis, unit) for letter, unit in (("v", "mm/s"), ("ω", "deg/s")) for axis in "xyz"]
    assert [one["factor"] for one in series] == pytest.approx([1e3] * 3 + [180.0 / math.pi] * 3)


def test_curves_fill_the_frame_from_the_first_second_to_the_last_and_leave_a_margin_above_and_below():
    record = make_record()
    plot = plots_of(record)[0]
    curves = [np.array([[float(x) for x in pair.split(",")] for pair in points.split()])
              for points in re.findall(r'<polyline class="curve"[^>]*points="([^"]*)"', plot["svg"])]
    assert len(curves) == 4
    for curve in curves:
        assert (curve[0, 0], curve[-1, 0]) == (LEFT, WIDTH - RIGHT)
    heights = np.concatenate([curve[:, 1] for curve in curves])
    frame = np.array([plots.TOP, HEIGHT - plots.BOTTOM])
    margin = 0.06 / 1.12 * (frame[1] - frame[0])
    near([heights.min(), heights.max()], frame + [margin, -margin])


def test_heights_that_are_always_in_view_have_a_line_each():
    plot = plots.time_plot("a", "A", np.array([0.0, 1.0]), [], "label", ends=[-1.0, 1.0])
    found = re.findall(rf'<path class="end" d="M{LEFT} {NUMBER}H{WIDTH - RIGHT}"/>', plot["svg"])
    frame = np.array([plots.TOP, HEIGHT - plots.BOTTOM])
    margin = 0.06 / 1.12 * (frame[1] - frame[0])
    near(np.array(found, dtype=float), [frame[1] - margin, frame[0] + margin])


def test_the_taught_goal_is_the_last_view_of_it_and_may_be_missing():
    record = make_record()
    untaught = dataclasses.replace(record, phase=np.where(record.phase == "teach", "settle_goal", record.phase))
    assert plots_of(untaught)[3]["data"]["goal"] is None
