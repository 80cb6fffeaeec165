"""Plots of a run as inline SVG for the report: what stands there without a script, and the numbers that the script
web/report.js needs to zoom, pan, turn and read them off. No matplotlib: these plots are part of the page.

A plot is a dict: id, kind ("time" or "path"), title, svg (text), legend (rows of name, colour, dash), data (for JSON).
"""

import math
from html import escape
from typing import Any, Dict, List, Optional, Sequence, Tuple

import numpy as np

from aras_visual_servo import RunRecord, palette, spread, styles
from .scales import NO_UNIT, Scale, scales_of

# Symbol with its subscript, colour, dash, factor to the unit that is read off.
TWIST = tuple((letter, axis, color, dash, factor, unit)
              for letter, dash, factor, unit in (("v", "", 1e3, "mm/s"), ("ω", "6 3", 180.0 / math.pi, "deg/s"))
              for axis, color in zip("xyz", (palette.BLUE, palette.VERMILION, palette.GREEN)))
PATH_COLORS = {"path": palette.BLUE, "start": palette.VERMILION, "goal": palette.GREEN}
WIDTH, HEIGHT = 520, 310
LEFT, RIGHT, TOP, BOTTOM = 62, 10, 12, 44
SECOND = 58              # room for a second scale, in place of RIGHT
SIGNIFICANT = 7          # digits of the numbers in the page: more than any zoom of a plot can show
LOG_FLOOR = 1e-7         # smaller errors are drawn at this height, in the units of the features
DASH, GAP = 4, 3         # of the dashed lines at the thresholds [px]
AZIMUTH, ELEVATION = math.radians(-57.0), math.radians(30.0)   # direction from which the path is seen


def plots_of(record: RunRecord, title_of_velocity: str = "camera velocity") -> List[Dict[str, Any]]:
    """The plots of the report: feature errors, their size on a logarithmic scale, camera velocity, path; [] without
    servo rows. For a look-then-move run the third shows the velocity that the law asks for, as its title has to say."""
    rows = record.servo_rows
    if not len(rows):
        return []
    t_s = record.servo_t_s
    features = styles(record.feature_names)
    series = [series_of((one.letter, one.subscript, one.colour, "", one.factor, one.read_unit), record.e[rows, column])
              for column, one in enumerate(features)]
    levels = _levels(features, spread(record.settings.get("servo", {}).get("thresholds", {})))
    twist = [series_of(style, record.twist[rows, column]) for column, style in enumerate(TWIST)]
    scales = scales_of(one.unit for one in features)
    plots = [
        time_plot("errors", "feature errors, e = s − s*", t_s, series, "e", scales=scales),
        time_plot("convergence", "size of the errors, and thresholds of the stop rule (dashed)", t_s, series,
                  "|e|", log=True, levels=levels, scales=scales),
        time_plot("velocity", title_of_velocity, t_s, twist, "v", scales=scales_of(("m/s", "rad/s")), second="ω")]
    path = _path_plot(record, rows, t_s)
    return plots + ([path] if path else [])


def nice_ticks(low: float, high: float, count: int) -> Tuple[List[float], float]:
    """Round values within [low, high], about `count` of them, and their step: (list, float)."""
    raw = (high - low) / max(count, 1)
    power = 10.0 ** math.floor(math.log10(raw))
    step = next(factor * power for factor in (1, 2, 5, 10) if factor * power >= raw * (1 - 1e-9))
    first = math.ceil(low / step - 1e-9)
    return [k * step for k in range(first, math.floor(high / step + 1e-9) + 1)], step


def tick_text(value: float, step: float) -> str:
    """Text of a tick, with as many digits as the step needs and a true minus sign."""
    digits = max(0, -math.floor(math.log10(step) + 1e-9))
    return (f"{value:.{digits}f}" if digits < 6 else f"{value:.1e}").replace("-", "−")


def series_of(style: Tuple[str, str, str, str, float, str], values: np.ndarray) -> Dict[str, Any]:
    """A curve: style is (symbol, subscript, colour, dash, factor to the unit that is read off, that unit)."""
    letter, subscript, color, dash, factor, unit = style
    return {"name": letter, "sub": subscript, "color": color, "dash": dash, "factor": factor, "unit": unit,
            "y": [number(value) for value in values]}


def _levels(features, thresholds):
    """Lines at the thresholds: y, colour, dash and where the dash begins. Lines of the same height take turns."""
    found = [(float(thresholds[one.name]), one.colour) for one in features if one.name in thresholds]
    levels = []
    for index, (y, colour) in enumerate(found):
        sharing, before = (sum(other == y for other, _ in some) for some in (found, found[:index]))
        levels.append({"y": y, "color": colour, "dash": f"{DASH} {sharing * (DASH + GAP) - DASH}",
                       "offset": -before * (DASH + GAP)})
    return levels


def number(value: float) -> Optional[float]:
    """The number rounded for the page, None if it is not finite: JSON has no NaN."""
    return float(f"{value:.{SIGNIFICANT}g}") if math.isfinite(value) else None


def time_plot(name: str, title: str, t_s: np.ndarray, series: List[Dict[str, Any]], label: str, log: bool = False,
              levels: Sequence[Dict[str, Any]] = (), ends: Optional[List[float]] = None,
              across: str = "time since the servo started [s]", scales: Tuple[Scale, Optional[Scale]] = NO_UNIT,
              second: str = "") -> Dict[str, Any]:
    """A plot of kind "time".

    Args:
        label: of the vertical axis, before the unit of its scale.  second: the same on the right.
        ends: heights that are always in view and have a line, for example those of limits.
        across: label of the horizontal axis.  scales: of `scales_of`.
    """
    left, right = scales
    data = {"t": [number(t) for t in t_s], "series": series, "label": f"{label} {left.label}".strip(), "log": log,
            "scale": left.factor,
            "right": right and {"label": f"{second or label} {right.label}", "scale": right.factor},
            "levels": list(levels), "ends": ends, "across": across}
    legend = [{key: one[key] for key in ("name", "sub", "color", "dash")} for one in series]
    return {"id": name, "kind": "time", "title": title, "legend": legend, "data": data,
            "svg": named(_time_svg(data), title)}


def _time_svg(data):
    t_end = max(data["t"][-1], 1e-3)
    drawn = [[_transformed(y, data["log"]) for y in one["y"]] for one in data["series"]]
    values = [y for one in drawn for y in one if y is not None] or [0.0, 1.0]
    values += [math.log10(level["y"]) for level in data["levels"]] if data["log"] else data["ends"] or [0.0]
    low, high = min(values), max(values)
    pad = 0.06 * (high - low) or 1e-6
    low, high = low - pad, high + pad

    edge = WIDTH - (SECOND if data["right"] else RIGHT)

    def at(t, y):
        return (LEFT + t / t_end * (edge - LEFT), TOP + (high - y) / (high - low) * (HEIGHT - TOP - BOTTOM))

    parts = []
    ticks, step = nice_ticks(0.0, t_end, 6)
    for t in ticks:
        x = at(t, 0)[0]
        parts += [f'<path class="grid" d="M{x:.1f} {TOP}V{HEIGHT - BOTTOM}"/>',
                  _text(x, HEIGHT - BOTTOM + 17, tick_text(t, step))]
    for y, words in _marks(low, high, data["scale"], data["log"]):
        v = at(0, y)[1]
        kind = "zero" if y == 0 and not data["log"] else "grid"
        parts += [f'<path class="{kind}" d="M{LEFT} {v:.1f}H{edge}"/>', _text(LEFT - 6, v + 4, words, "end")]
    for y, words in _marks(low, high, data["right"]["scale"], data["log"]) if data["right"] else ():
        v = at(0, y)[1]
        parts += [f'<path class="frame" d="M{edge} {v:.1f}h4"/>', _text(edge + 7, v + 4, words, "start")]
    parts += [f'<path class="end" d="M{LEFT} {at(0, end)[1]:.1f}H{edge}"/>' for end in data["ends"] or ()]
    for level in data["levels"] if data["log"] else ():
        v = at(0, math.log10(level["y"]))[1]
        parts.append(f'<path class="level" stroke="{level["color"]}" style="--c:{level["color"]}" '
                     f'stroke-dasharray="{level["dash"]}" '
                     f'stroke-dashoffset="{level["offset"]}" d="M{LEFT} {v:.1f}H{edge}"/>')
    for one, ys in zip(data["series"], drawn):
        style = f' stroke="{one["color"]}" style="--c:{one["color"]}" stroke-dasharray="{one["dash"] or "none"}"'
        parts += [_polyline("curve", [at(*point) for point in run], style) for run in _runs(data["t"], ys)]
    up = f"V{TOP}" if data["right"] else ""
    parts.append(f'<path class="frame" d="M{LEFT} {TOP}V{HEIGHT - BOTTOM}H{edge}{up}"/>')
    parts.append(_text((LEFT + edge) / 2, HEIGHT - 7, data["across"]))
    labels = [(13, data["label"])] + ([(WIDTH - 5, data["right"]["label"])] if data["right"] else [])
    parts += [f'<text transform="translate({x} {(TOP + HEIGHT - BOTTOM) / 2}) rotate(-90)" text-anchor="middle">'
              f'{escape(label)}</text>' for x, label in labels]
    return svg_of(parts)


def _marks(low, high, scale, log):
    """[(height, text)] of the ticks of a scale between these heights; of a logarithmic one at whole powers of ten."""
    if log:
        shift = math.log10(scale)
        return [(k - shift, _power(k)) for k in range(math.ceil(low + shift), math.floor(high + shift) + 1)]
    ticks, step = nice_ticks(low * scale, high * scale, 5)
    return [(tick / scale, tick_text(tick, step)) for tick in ticks]


def _transformed(y, log):
    return y if y is None or not log else math.log10(max(abs(y), LOG_FLOOR))


def _power(exponent):
    digits = str(exponent).replace("-", "−")
    return f'10<tspan dy="-5" font-size="80%">{digits}</tspan>'


def _runs(t, ys):
    """Pieces of a curve without gaps: lists of (t, y)."""
    runs, run = [], []
    for point in zip(t, ys):
        if point[1] is None:
            run = []
            continue
        if not run:
            runs.append(run)
        run.append(point)
    return runs


def _path_plot(record, rows, t_s):
    p = record.X_WM[rows, :3, 3]
    known = np.all(np.isfinite(p), axis=1)
    taught = record.rows("teach")
    goal = record.X_WM[taught[-1], :3, 3] if len(taught) else np.full(3, np.nan)
    if not known.any():
        return None
    data = {"t": [number(t) for t in t_s[known]], "p": [[number(x) for x in point] for point in p[known]],
            "goal": [number(x) for x in goal] if np.all(np.isfinite(goal)) else None, "colors": PATH_COLORS}
    words = {"path": "path", "start": "○ start", "goal": "★ goal (taught)"}
    legend = [{"name": words[part], "sub": "", "color": color, "dash": ""} for part, color in PATH_COLORS.items()]
    title = f"path of the {'target' if record.eye_to_hand else 'camera'} in the world, to scale"
    return {"id": "path", "kind": "path", "title": title, "legend": legend, "data": data,
            "svg": named(_path_svg(data), title)}


def path_box(data: Dict[str, Any]) -> Tuple[np.ndarray, np.ndarray]:
    """Centre and half edges of the box around path and goal, (3,) each [m]. No edge is under half of the longest."""
    points = np.array(data["p"] + ([data["goal"]] if data["goal"] else []))
    low, high = points.min(axis=0), points.max(axis=0)
    edges = np.maximum(high - low, 1e-3)
    return (low + high) / 2, np.maximum(edges, edges.max() / 2) / 2 * 1.08


def _path_svg(data):
    centre, half = path_box(data)
    sa, ca, se, ce = math.sin(AZIMUTH), math.cos(AZIMUTH), math.sin(ELEVATION), math.cos(ELEVATION)
    # The box fills the picture.
    wide, deep = abs(sa) * half[0] + abs(ca) * half[1], abs(ca) * half[0] + abs(sa) * half[1]
    scale = min((WIDTH - 120) / (2 * wide), (HEIGHT - 80) / (2 * (half[2] * ce + deep * se)))

    def at(p):
        """Place in the picture of a point: orthographic view from AZIMUTH and ELEVATION, world z up."""
        x, y, z = np.asarray(p) - centre
        return WIDTH / 2 + scale * (-sa * x + ca * y), HEIGHT / 2 - 8 - scale * (ce * z - se * (ca * x + sa * y))

    low, high = centre - half, centre + half
    near_x, near_y = high[0] if ca > 0 else low[0], high[1] if sa > 0 else low[1]
    corner = at((near_x, near_y, low[2]))
    parts = []
    for axis, name in enumerate("xy"):
        ticks, step = nice_ticks(low[axis], high[axis], 4)
        middle = at((centre[0], near_y, low[2]) if axis == 0 else (near_x, centre[1], low[2]))
        side = -1 if middle[0] < corner[0] else 1
        anchor = "end" if side < 0 else "start"
        for value in ticks:
            a, b = np.array([low[0], low[1], low[2]]), np.array([high[0], high[1], low[2]])
            a[axis] = b[axis] = value
            parts.append(_line("grid", at(a), at(b)))
            x, y = at((value, near_y, low[2]) if axis == 0 else (near_x, value, low[2]))
            parts.append(_text(x + 3 * side, y + 13, tick_text(1e3 * value, 1e3 * step), anchor))
        parts.append(_axis_name(name, middle[0] + 46 * side, middle[1] + 28, anchor))
    post = min(((x, y) for x in (low[0], high[0]) for y in (low[1], high[1])), key=lambda c: at((*c, low[2]))[0])
    ticks, step = nice_ticks(low[2], high[2], 3)
    for value in ticks:
        x, y = at((*post, value))
        parts += [_line("grid", (x - 4, y), (x, y)), _text(x - 7, y + 4, tick_text(1e3 * value, 1e3 * step), "end")]
    x, y = at((*post, high[2]))
    parts += [_line("frame", at((*post, low[2])), (x, y)), _axis_name("z", x, y - 9, "middle")]
    corners = [(low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1]), (low[0], low[1])]
    parts.append(_polyline("frame", [at((*c, low[2])) for c in corners]))
    parts.append(_polyline("shadow", [at((x, y, low[2])) for x, y, _ in data["p"]]))
    parts.append(_polyline("curve", [at(point) for point in data["p"]],
                           f' stroke="{palette.BLUE}" style="--c:{palette.BLUE}"'))
    x, y = at(data["p"][0])
    parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="5" fill="none" stroke="{palette.VERMILION}" '
                 f'style="--c:{palette.VERMILION}" stroke-width="2"/>')
    if data["goal"]:
        parts.append(f'<path d="{star(*at(data["goal"]))}" fill="{palette.GREEN}" style="--c:{palette.GREEN}"/>')
    return svg_of(parts)


def star(x: float, y: float, radius: float = 8.0) -> str:
    """Path of a five-pointed star."""
    corners = [(x + (radius, 0.42 * radius)[k % 2] * math.sin(k * math.pi / 5),
                y - (radius, 0.42 * radius)[k % 2] * math.cos(k * math.pi / 5)) for k in range(10)]
    return "M" + "L".join(f"{a:.1f} {b:.1f}" for a, b in corners) + "Z"


def _text(x, y, words, anchor="middle"):
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{words}</text>'


def _line(kind, a, b):
    return f'<path class="{kind}" d="M{a[0]:.1f} {a[1]:.1f}L{b[0]:.1f} {b[1]:.1f}"/>'


def _polyline(kind, points, more=""):
    return f'<polyline class="{kind}"{more} points="{" ".join("%.1f,%.1f" % tuple(point) for point in points)}"/>'


def _axis_name(name, x, y, anchor):
    return _text(x, y, f'{name}<tspan dy="3" font-size="80%">W</tspan><tspan dy="-3"> [mm]</tspan>', anchor)


def named(svg: str, title: str) -> str:
    """The picture with a title for readers who do not see it."""
    return svg.replace('role="img"', f'role="img" aria-label="{escape(title)}"', 1)


def svg_of(parts: List[str]) -> str:
    """The picture with these elements."""
    return f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img">' + "".join(parts) + "</svg>"
