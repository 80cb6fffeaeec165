"""Features in reports: of every shipped scenario, each has a colour of its own, a unit, a gain and a threshold, and the
same look in page, figure, table and trace."""

import csv
import io
import re
from html import unescape
from html.parser import HTMLParser
from pathlib import Path

import pytest
from matplotlib.figure import Figure
from synthetic import make_record, SETTINGS

import aras_visual_servo_controller
from aras_visual_servo import expand, FEATURE_NAMES, fit_decay, load_scenario, scenario_names, styles
from aras_visual_servo_study.report.figure import draw_panel
from aras_visual_servo_study.report.page import report_html
from aras_visual_servo_study.report.plots import plots_of
from aras_visual_servo_study.report.report import summarise, trace_csv

PACKAGE = Path(aras_visual_servo_controller.__file__).parent
UNITS = {"m", "rad", "grey", "-"}


def record_of(name):
    """A made-up run of a shipped scenario, with its features."""
    settings = load_scenario(name).as_dict()
    features = expand(settings["servo"].get("features", FEATURE_NAMES))
    return make_record(settings=settings, scenario=name, feature_names=features)


@pytest.fixture(scope="module", params=scenario_names())
def record(request):
    return record_of(request.param)


class _Rows(HTMLParser):
    """Texts of the cells of every table row."""

    def __init__(self, text):
        super().__init__()
        self.rows = []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        if tag == "tr":
            self.rows.append([])
        elif tag in ("td", "th"):
            self.rows[-1].append("")
        elif "class" in dict(attributes) and dict(attributes)["class"] == "swatch":
            self.rows[-1][-1] += dict(attributes)["style"]

    def handle_data(self, data):
        if self.rows and self.rows[-1]:
            self.rows[-1][-1] += data


def table_of(record):
    """Rows of the page's table of features: name, final error, threshold, gain, rate."""
    page = report_html(record, summarise(record)).split("<h2>Features</h2>")[1].split("</table>")[0]
    return [row for row in _Rows(page).rows if len(row) == 5][1:]


def test_every_feature_has_a_colour_of_its_own_and_the_same_in_page_and_figure(record):
    axes = Figure().add_subplot()
    draw_panel(record, "errors", axes)
    drawn = [line for line in axes.lines if not line.get_label().startswith("_")]
    errors, convergence = plots_of(record)[:2]
    colours = [series["color"] for series in errors["data"]["series"]]
    assert len(set(colours)) == len(colours) == len(record.feature_names)
    assert colours == [line.get_color() for line in drawn] == [style.colour for style in styles(record.feature_names)]
    assert colours == [series["color"] for series in convergence["data"]["series"]]
    for row, colour in zip(table_of(record), colours):
        assert colour in row[0]


def test_every_feature_has_a_unit_wherever_it_is_shown(record):
    axes = Figure().add_subplot()
    draw_panel(record, "errors", axes)
    legend = [text.get_text() for text in axes.get_legend().get_texts()]
    shown = styles(record.feature_names)
    assert {style.unit for style in shown} <= UNITS
    assert [re.search(r"\[(.+)\]$", text)[1] for text in legend] == [style.read_unit for style in shown]
    assert [re.search(r"\[(.+?)\]", row[0])[1] for row in table_of(record)] == [style.read_unit for style in shown]
    errors = plots_of(record)[0]["data"]
    assert [series["unit"] for series in errors["series"]] == [style.read_unit for style in shown]
    for style, series in zip(shown, errors["series"]):
        beside = errors["right"] if style.unit == "rad" and errors["right"] else errors
        unit = "10⁻³" if style.unit == "-" and errors["scale"] == 1e3 else style.read_unit
        assert f"[{unit}]" in beside["label"] and series["factor"] == (beside["scale"] if unit != "10⁻³" else 1.0)


def test_every_feature_has_its_gain_and_threshold_in_the_table(record):
    servo, rows = record.settings["servo"], table_of(record)
    gains, thresholds = ({feature: value for key, value in servo[section].items() for feature in expand([key])}
                         for section in ("gains_per_s", "thresholds"))
    assert len(rows) == len(record.feature_names)
    for style, (_, _, threshold, gain, _) in zip(styles(record.feature_names), rows):
        assert float(gain) == gains[style.name]
        assert float(threshold) == pytest.approx(thresholds[style.name] * style.factor, rel=1e-3)  # 4 digits


def test_every_feature_has_a_line_at_its_threshold(record):
    convergence = plots_of(record)[1]
    levels = convergence["data"]["levels"]
    assert [level["color"] for level in levels] == [style.colour for style in styles(record.feature_names)]
    drawn = re.findall(r'class="level" stroke="(#\w+)"', convergence["svg"])
    assert drawn == [level["color"] for level in levels]


@pytest.mark.parametrize("name, columns", [
    ("experiment_1", ["e_xn_m", "e_yn_m", "e_an_m", "e_alpha_rad"]), ("six_dof_photometric", ["e_photometric_grey"]),
    ("six_dof_hybrid", ["e_xr", "e_yr", "e_zr", "e_rx_rad", "e_ry_rad", "e_rz_rad"])])
def test_columns_of_the_trace_name_the_unit(name, columns):
    header = next(csv.reader(io.StringIO(trace_csv(record_of(name)))))
    assert [column for column in header if column.startswith("e_")] == columns


def test_a_decay_is_not_fitted_below_the_threshold_of_a_group():
    settings = dict(SETTINGS, servo={"thresholds": {"points1": 1.0}})
    rates = fit_decay(make_record(settings=settings, feature_names=("x1", "y1")))
    assert all(rate != rate for rate in rates.values())  # every error is below three thresholds: NaN


def test_a_feature_of_a_plugin_that_is_not_here_is_shown_all_the_same():
    record = make_record(feature_names=("xn", "of<old>bag"), settings={})
    page = report_html(record, summarise(record))
    assert "of<old>bag" not in page and "of<old>bag" in unescape(page)
    [_, row] = table_of(record)
    assert "of<old>bag" in row[0] and "[-]" in row[0] and row[2:4] == ["", ""]
