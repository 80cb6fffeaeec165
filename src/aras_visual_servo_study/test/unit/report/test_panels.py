"""Panels and plots of a report: the numbers of the record, in the colours of the features, in their places."""

import dataclasses
import json
import math
import re

import numpy as np
import pytest
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d import Axes3D
from synthetic import FEATURE_ERROR, make_record, RATE_PER_S, X_WCG

from aras_visual_servo import palette, styles
from aras_visual_servo.palette import GREEN
from aras_visual_servo_study.report import plots
from aras_visual_servo_study.report.figure import draw_panel, save_figure
from aras_visual_servo_study.report.pictures import image_of
from aras_visual_servo_study.report.plots import HEIGHT, LEFT, nice_ticks, plots_of, SECOND, tick_text, WIDTH
from aras_visual_servo_study.report.scales import scales_of


def panel(record, name, **options):
    axes = Figure().add_subplot(projection=Axes3D.name if name == "path" else None)
    draw_panel(record, name, axes, **options)
    return axes


@pytest.fixture(scope="module")
def record():
    return make_record()


def seconds(record):
    stamps = record.stamp_ns[record.servo_rows]
    return 1e-9 * (stamps - stamps[0])


def test_errors_are_drawn_over_time_in_the_colours_of_their_features(record):
    axes = panel(record, "errors")
    zero, *curves = axes.lines
    assert len(curves) == 4 and not np.any(zero.get_ydata())
    for curve, style, column in zip(curves, styles(record.feature_names), record.e[record.servo_rows].T):
        np.testing.assert_array_equal(curve.get_ydata(), 1e3 * column)
        np.testing.assert_allclose(curve.get_xdata(), seconds(record))
        assert curve.get_color() == style.colour and curve.get_label() == style.mathtext
    assert axes.get_xlim() == (0.0, pytest.approx(seconds(record)[-1])) and axes.get_legend()


def test_all_six_velocities_are_drawn_and_told_apart(record):
    zero, *curves = panel(record, "velocity").lines
    assert len(curves) == 6 and len({(curve.get_color(), curve.get_linestyle()) for curve in curves}) == 6
    for curve, column in zip(curves, record.twist[record.servo_rows].T):
        np.testing.assert_array_equal(curve.get_ydata(), 1e3 * column)


@pytest.mark.parametrize("name, labels", [("errors", ("mm", "deg")), ("velocity", ("mm/s", "deg/s"))])
def test_lengths_are_read_off_on_the_left_and_angles_on_the_right(record, name, labels):
    figure = Figure()
    axes = figure.add_subplot()
    draw_panel(record, name, axes)
    figure.draw_without_rendering()
    [other] = axes.child_axes
    assert axes.get_ylabel().endswith(f"[{labels[0]}]") and other.get_ylabel().endswith(f"[{labels[1]}]")
    np.testing.assert_allclose(other.get_ylim(), np.degrees(1e-3 * np.array(axes.get_ylim())))
    angle = plots_of(record)[0 if name == "errors" else 2]["data"]["series"][-1]
    assert angle["factor"] == pytest.approx(180.0 / math.pi) and angle["unit"] == labels[1]


@pytest.mark.parametrize("units, left, right", [
    (("m", "rad"), (1e3, "[mm]"), "[deg]"), (("m", "-", "rad"), (1e3, "[mm], [10⁻³]"), "[deg]"),
    (("-", "rad", "rad"), (1.0, "[-]"), "[deg]"), (("rad",), (180.0 / math.pi, "[deg]"), None),
    (("grey",), (1.0, "[grey]"), None), ((), (1.0, ""), None)])
def test_each_unit_has_one_scale(units, left, right):
    first, second = scales_of(units)
    assert first == left and (second and second.label) == right


def test_panel_c_shows_both_differences_with_a_scale_in_grey_levels(record, monkeypatch):
    drawn = []
    monkeypatch.setattr(Figure, "savefig", lambda self, *_, **__: drawn.append(self))
    save_figure(record, png_path="a.png")
    start, end = drawn[0].axes[2:4]
    for axes, name in ((start, "start"), (end, "difference")):
        np.testing.assert_array_equal(axes.images[0].get_array(), image_of(record, name))
        image = record.initial_image if name == "start" else record.final_image
        grey = [one.astype(float).mean(axis=2) for one in (image, record.desired_image)]
        largest = np.abs(grey[0] - grey[1]).max()
        assert axes.get_xlabel() == f"largest: {largest:.0f} grey levels"
    assert not start.child_axes and start.get_title().startswith("(c) ")
    [bar] = end.child_axes
    ramp = bar.images[0]
    assert bar.get_ylim() == (-255, 255) == tuple(ramp.get_extent()[2:])
    assert (ramp.get_array()[0], ramp.get_array()[-1]) == (0, 255) and ramp.origin == "lower"


def test_the_path_leads_from_a_circle_to_the_star_within_a_cube(record):
    axes = panel(record, "path")
    way, start, goal = (np.array(line.get_data_3d()) for line in axes.lines)
    p, there = 1e3 * record.X_WC[record.servo_rows, :3, 3], 1e3 * X_WCG[:3, 3]
    np.testing.assert_array_equal(way, p.T)
    np.testing.assert_array_equal(start[:, 0], p[0])
    np.testing.assert_array_equal(goal[:, 0], there)
    limits = np.array([axes.get_xlim(), axes.get_ylim(), axes.get_zlim()])
    points = np.vstack([p, there])
    np.testing.assert_allclose(limits.mean(axis=1), 0.5 * (points.max(axis=0) + points.min(axis=0)), atol=1e-12)
    widest = (points.max(axis=0) - points.min(axis=0)).max()
    np.testing.assert_allclose(limits[:, 1] - limits[:, 0], 1.08 * widest, rtol=1e-9)


@pytest.mark.parametrize("name", ["desired", "initial", "difference", "start"])
def test_an_image_is_shown_in_its_own_greys_with_lines_through_its_middle(record, name):
    axes = panel(record, name)
    [image] = axes.images
    np.testing.assert_array_equal(image.get_array(), image_of(record, name))
    assert image.get_clim() == (0, 255) and not axes.texts
    assert {line.get_ydata()[0] for line in axes.lines[::2]} == {23.5} and axes.lines[1].get_xdata()[0] == 31.5


def test_a_panel_has_its_letter_and_title_when_asked_for(record):
    assert panel(record, "errors", letter="d").get_title().startswith("(d) ")
    assert not panel(record, "errors", letter="d").get_title() == panel(record, "errors").get_title()
    assert panel(record, "errors", title=False).get_title() == ""
    with pytest.raises(ValueError, match="panel 'nothing': allowed are"):
        draw_panel(record, "nothing", None, title=False)


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
    [star] = re.findall(f'<path d="M([^"]*)Z" fill="{GREEN}" [^>]*/>', picture.svg)
    corners = np.array([one.split() for one in star.split("L")], dtype=float)
    near(corners.mean(axis=0), picture.at(GOAL))
    assert f'fill="{GREEN}"' not in Picture(WAY, None).svg


def test_no_edge_of_the_box_is_under_half_of_the_longest_and_a_way_without_length_has_one():
    centre, half = plots.path_box({"p": [[0.0, 0.0, 0.0], [0.4, 0.1, 0.0]], "goal": [0.2, 0.3, 0.0]})
    np.testing.assert_allclose(centre, [0.2, 0.15, 0.0])
    np.testing.assert_allclose(half, np.array([0.4, 0.3, 0.2]) / 2 * 1.08)
    np.testing.assert_allclose(plots.path_box({"p": [[1.0, 2.0, 3.0]], "goal": None})[1], [0.00054] * 3)


def test_lines_at_one_height_take_turns_and_one_alone_has_the_usual_dashes():
    features = plots.styles(("xn", "yn", "an", "alpha"))
    levels = plots._levels(features, {"xn": 0.1, "an": 0.1, "alpha": 0.2})
    assert [(one["y"], one["dash"], one["offset"]) for one in levels] == [(0.1, "4 10", 0), (0.1, "4 10", -7),
                                                                          (0.2, "4 3", 0)]
    assert [one["color"] for one in levels] == [features[k].colour for k in (0, 2, 3)]


def test_curves_fill_the_frame_from_the_first_second_to_the_last_and_leave_a_margin_above_and_below():
    record = make_record()
    plot = plots_of(record)[0]
    curves = [np.array([[float(x) for x in pair.split(",")] for pair in points.split()])
              for points in re.findall(r'<polyline class="curve"[^>]*points="([^"]*)"', plot["svg"])]
    assert len(curves) == 4
    for curve in curves:
        assert (curve[0, 0], curve[-1, 0]) == (LEFT, WIDTH - SECOND)
    heights = np.concatenate([curve[:, 1] for curve in curves])
    frame = np.array([plots.TOP, HEIGHT - plots.BOTTOM])
    margin = 0.06 / 1.12 * (frame[1] - frame[0])
    near([heights.min(), heights.max()], frame + [margin, -margin])


def test_the_taught_goal_is_the_last_view_of_it_and_may_be_missing():
    record = make_record()
    untaught = dataclasses.replace(record, phase=np.where(record.phase == "teach", "settle_goal", record.phase))
    assert plots_of(untaught)[3]["data"]["goal"] is None


# The page keeps plots.SIGNIFICANT digits.
PAGE_RELATIVE = 10.0 ** (1 - plots.SIGNIFICANT)
# Coordinates in the picture have one digit after the point.
PIXEL_ROUNDING = 0.051


def by_name(record):
    return {plot["id"]: plot for plot in plots_of(record)}


@pytest.mark.parametrize("low, high", [(0.0, 2.97), (-0.16, 0.17), (1e-6, 3e-6), (-123.0, 4567.0), (0.78, 0.801)])
def test_ticks_are_round_and_within(low, high):
    ticks, step = nice_ticks(low, high, 5)
    assert 3 <= len(ticks) <= 11 and low - 1e-9 * step <= ticks[0] and ticks[-1] <= high + 1e-9 * step
    assert f"{step:e}"[0] in "125" and np.allclose(np.diff(ticks), step)


def test_a_tick_has_the_digits_of_its_step_and_a_true_minus():
    assert (tick_text(0.1, 0.05), tick_text(-2.0, 1.0), tick_text(-0.5, 0.5)) == ("0.10", "−2", "−0.5")


def test_the_script_gets_the_numbers_of_the_record():
    record = make_record()
    data = json.loads(json.dumps(by_name(record)["errors"]["data"], allow_nan=False))
    rows = record.servo_rows
    assert data["t"][0] == 0.0 and len(data["t"]) == len(rows)
    for column, series in enumerate(data["series"]):
        np.testing.assert_allclose(series["y"], record.e[rows, column], rtol=PAGE_RELATIVE)
    assert [series["unit"] for series in data["series"]] == ["mm", "mm", "mm", "deg"]


def test_an_exponential_is_a_straight_line_in_the_logarithmic_plot():
    svg = by_name(make_record())["convergence"]["svg"]
    curve = re.findall(r'class="curve" stroke="%s"[^>]*points="([^"]*)"' % palette.BLUE, svg)[0]
    points = np.array([[float(x) for x in pair.split(",")] for pair in curve.split()])
    line = np.polyval(np.polyfit(points[:, 0], points[:, 1], 1), points[:, 0])
    assert np.abs(points[:, 1] - line).max() < 2 * PIXEL_ROUNDING
    assert FEATURE_ERROR[0] > 0 and RATE_PER_S > 0 and points[-1, 1] > points[0, 1] + 20  # down the page


def test_a_gap_in_the_errors_is_a_gap_in_the_curve():
    record = make_record()
    e = record.e.copy()
    e[record.servo_rows[40:45]] = np.nan
    plot = by_name(dataclasses.replace(record, e=e))["errors"]
    assert plot["svg"].count('class="curve"') == 2 * len(record.feature_names)
    assert plot["data"]["series"][0]["y"][42] is None


def test_a_record_without_servo_images_or_true_poses_has_no_such_plots():
    record = make_record()
    assert plots_of(dataclasses.replace(record, phase=np.full(len(record), "to_goal"))) == []
    assert "path" not in by_name(dataclasses.replace(record, X_WC=np.full_like(record.X_WC, np.nan)))
