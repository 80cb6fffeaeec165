"""Plots of the report: what is drawn without a script, and what the script gets."""

import dataclasses
import io
import json
import re

import numpy as np
import PIL.Image
import pytest
from synthetic import FEATURE_ERROR, RATE_PER_S, X_WCG, make_record

from aras_visual_servo import palette
from aras_visual_servo_study.report import plots
from aras_visual_servo_study.report.page import png_bytes
from aras_visual_servo_study.report.plots import nice_ticks, plots_of, tick_text

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


def test_the_path_ends_at_the_goal_and_stays_within_the_picture():
    plot = by_name(make_record())["path"]
    np.testing.assert_allclose(plot["data"]["goal"], X_WCG[:3, 3], rtol=PAGE_RELATIVE)
    numbers = [float(x) for points in re.findall(r'points="([^"]*)"', plot["svg"]) for x in re.split("[ ,]", points)]
    assert min(numbers) > 0 and max(numbers[::2]) < plots.WIDTH and max(numbers[1::2]) < plots.HEIGHT


def test_a_record_without_servo_images_or_true_poses_has_no_such_plots():
    record = make_record()
    assert plots_of(dataclasses.replace(record, phase=np.full(len(record), "to_goal"))) == []
    assert "path" not in by_name(dataclasses.replace(record, X_WC=np.full_like(record.X_WC, np.nan)))


@pytest.mark.parametrize("shape", [(5, 7), (5, 7, 3)])
def test_a_png_holds_the_pixels_of_the_image(shape):
    image = np.random.default_rng(0).integers(0, 256, shape, dtype=np.uint8)
    read = PIL.Image.open(io.BytesIO(png_bytes(image)))
    assert read.format == "PNG" and np.array_equal(np.asarray(read), image)
