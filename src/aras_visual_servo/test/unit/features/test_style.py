"""How features are shown: unit, symbol, label and colour of each, distinct colours together, defaults for others."""

import numpy as np
import pytest
from matplotlib.mathtext import MathTextParser

from aras_visual_servo import expand, Feature, known_features, register_family, register_feature, spread, styles
from aras_visual_servo.features import base
from aras_visual_servo.palette import distance, LEAST_DISTANCE, oklab, PALETTE, rgb, spare

# WCAG 2.1, 1.4.11: of graphics against what is behind them. A colour of 8 bits a channel may miss it by its rounding.
CONTRAST, ROUNDING = 3.0, 0.03
POINTS = expand(("points4",))
SEGMENTS = tuple(f"{name}{number}" for number in (1, 2, 3, 4) for name in ("xm", "ym", "l", "alpha"))
SHIPPED = [name.replace("N", "1") if name.endswith("N") else name for name in known_features()]


def contrast_to_white(colour):
    channels = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in (x / 255 for x in rgb(colour))]
    return 1.05 / (0.05 + sum(share * c for share, c in zip((0.2126, 0.7152, 0.0722), channels)))


@pytest.fixture
def registered():
    """Registers features for one test; forgets them afterwards."""
    known = dict(base.FEATURES), dict(base.FAMILIES)
    yield
    for now, before in zip((base.FEATURES, base.FAMILIES), known):
        now.clear()
        now.update(before)


def test_the_four_default_features_look_as_they_always_did():
    assert [(one.mathtext, one.colour) for one in styles(("xn", "yn", "an", "alpha"))] == [
        ("$x_{n}$ [mm]", "#0072B2"), ("$y_{n}$ [mm]", "#D55E00"), ("$a_{n}$ [mm]", "#009E73"),
        ("$α$ [deg]", "#AA4499")]


@pytest.mark.parametrize("name", SHIPPED)
def test_every_feature_brings_a_look_of_its_own(name):
    [style] = styles([name])
    assert style.unit in ("m", "rad", "grey", "-") and style.symbol != name and style.label != name
    assert "{" not in style.symbol + style.label
    assert contrast_to_white(style.colour) > CONTRAST - ROUNDING


@pytest.mark.parametrize("name, unit", [
    ("an", "m"), ("alpha", "rad"), ("tz", "m"), ("rx", "rad"), ("zr", "-"), ("photometric", "grey"), ("x3", "-"),
    ("alpha3", "rad"), ("sx", "-"), ("kx", "-"), ("n20", "-"), ("c4", "-")])
def test_a_feature_has_the_unit_of_its_value(name, unit):
    assert styles([name])[0].unit == unit


def test_members_of_a_family_tell_their_number():
    [style] = styles(["ym12"])
    assert (style.letter, style.subscript, style.label) == ("y", "m12", "middle of segment 12 in y")


@pytest.mark.parametrize("names", [
    POINTS, expand(("points6",)), SEGMENTS, ("xn", "yn", "an", "sx", "sy", "alpha"),
    ("xn", "yn", "an", "px", "py", "alpha"), ("tx", "ty", "tz", "rx", "ry", "rz"),
    ("xr", "yr", "zr", "rx", "ry", "rz"), ("kx", "ky", "an", "alpha"),
    ("xg", "yg", "n20", "n11", "n02", "alpha")])
def test_features_that_go_together_keep_their_own_colours_far_apart(names):
    together = [style.colour for style in styles(names)]
    assert together == [styles([name])[0].colour for name in names]
    assert min(distance(a, b) for i, a in enumerate(together) for b in together[:i]) >= LEAST_DISTANCE


def test_x_is_cool_and_y_is_warm():
    for name, cool in ((name, name.startswith("x")) for name in POINTS):
        assert (oklab(styles([name])[0].colour)[2] < 0.0) == cool, name  # the axis from blue to yellow


@pytest.mark.parametrize("names", [("xn", "tx", "xr", "kx", "x1"), expand(("points99",)), SHIPPED])
def test_however_many_features_are_shown_no_two_have_one_colour(names):
    assert len({style.colour for style in styles(names)}) == len(names)


def test_a_colour_that_is_taken_goes_to_the_feature_that_comes_first():
    first, second = styles(("xn", "tx"))
    assert first == styles(["xn"])[0] and second.colour not in (first.colour, styles(["tx"])[0].colour)


def test_a_plugin_that_says_nothing_is_shown_by_its_name_in_a_colour_of_its_own(registered):
    register_feature("log_an")(type("LogDepth", (Feature,), {}))
    xn, style, alpha = styles(("xn", "log_an", "alpha"))
    assert (style.unit, style.letter, style.subscript, style.label) == ("-", "log_an", "", "log_an")
    assert style.colour in PALETTE and style.colour not in (xn.colour, alpha.colour)


def test_a_plugin_says_how_it_is_shown(registered):
    register_family("k")(type("Curvature", (Feature,), {
        "unit": "1/m", "symbol": "κ_{number}", "label": "curvature {number}", "colour": "#123456"}))
    [style] = styles(["k7"])
    assert (style.mathtext, style.label, style.colour) == ("$κ_{7}$ [1/m]", "curvature 7", "#123456")
    assert (style.column, style.factor, style.read_unit) == ("k7_per_m", 1.0, "1/m")


def test_a_name_that_nobody_knows_is_shown_all_the_same():
    [style] = styles(["of_an_old_bag"])
    assert (style.unit, style.symbol, style.label, style.column) == ("-", *["of_an_old_bag"] * 3)


@pytest.mark.parametrize("name", [*SHIPPED, "of_an_old_bag", "a_b_c_d", "cost$in$", "θ"])
def test_matplotlib_can_write_every_symbol(name):
    text = styles([name])[0].mathtext
    MathTextParser("agg").parse(text)
    assert text.endswith("]")


def test_a_symbol_with_several_subscripts_is_one_subscript(registered):
    register_feature("deep")(type("Deep", (Feature,), {"symbol": "d_a_b"}))
    [style] = styles(["deep"])
    assert (style.letter, style.subscript) == ("d", "a_b")
    MathTextParser("agg").parse(style.mathtext)


def test_lengths_and_angles_are_read_off_in_mm_and_deg():
    length, angle, number = styles(("xn", "alpha", "sx"))
    assert (length.factor, length.read_unit) == (1e3, "mm")
    assert (angle.factor, angle.read_unit) == (pytest.approx(57.29577951308232), "deg")
    assert (number.factor, number.read_unit) == (1.0, "-")


def test_a_value_of_a_group_is_that_of_each_of_its_features():
    assert spread({"points2": 3.0, "alpha": 1.0}) == {"x1": 3.0, "y1": 3.0, "x2": 3.0, "y2": 3.0, "alpha": 1.0}


def test_white_and_black_are_the_ends_of_the_lightness_and_grey_has_no_hue():
    np.testing.assert_allclose([oklab("#FFFFFF"), oklab("#000000")], [[1, 0, 0], [0, 0, 0]], atol=1e-6)
    lightness, a, b = oklab("#808080")
    assert (a, b) == pytest.approx((0.0, 0.0), abs=1e-6) and lightness == pytest.approx(0.5999, abs=1e-4)


def test_a_spare_colour_keeps_its_distance():
    taken = list(PALETTE)
    for _ in range(20):
        taken.append(spare(taken))
        assert min(distance(taken[-1], other) for other in taken[:-1]) >= LEAST_DISTANCE
