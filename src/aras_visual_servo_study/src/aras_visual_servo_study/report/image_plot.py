"""Plot of what the servo saw in the image, for the page: the ways of points through the image and what the features
show (`overlays`), at the start, at the goal and, with the script, at any moment between."""

import base64
from typing import Any, Dict, Optional

import numpy as np

from aras_visual_servo import RunRecord, palette
from ..live.hub import jpeg
from .overlays import overlay_of
from .plots import named, number, star

#: Moments that the page keeps at most: a curve through the image needs no more.
MOST_MOMENTS = 150
#: Colours of a difference: darker than the goal image, equal, brighter.
DARKER, EQUAL, BRIGHTER = "#0b3c8c", "#f4f4f4", "#8c3200"
FULL = 96.0  # grey levels at which a difference has its full colour


def image_plot(record: RunRecord) -> Optional[Dict[str, Any]]:
    """The plot, a dict as `plots` describes it, of kind "image"; None where nothing is known of the image."""
    overlay = overlay_of(record)
    if overlay is None or not overlay.ways:
        return None
    rows = record.servo_rows
    chosen = np.unique(np.round(np.linspace(0, len(rows) - 1, min(MOST_MOMENTS, len(rows)))).astype(int))
    t_s = record.servo_t_s
    width, height = int(record.camera_info["width"]), int(record.camera_info["height"])
    data = {"t": [number(t) for t in t_s[chosen]], "width": width, "height": height, "difference": overlay.difference,
            "full": FULL, "colours": [DARKER, EQUAL, BRIGHTER],
            "ways": [{"color": way.colour, "p": _pixels(way.seen[chosen]), "goal": _pixels(way.wanted)}
                     for way in overlay.ways],
            "shapes": [{"color": shape.colour, "closed": shape.closed,
                        "seen": _pixels(shape.seen[chosen] if shape.wanted is not None else shape.seen[:1]),
                        "goal": None if shape.wanted is None else _pixels(shape.wanted)} for shape in overlay.shapes]}
    legend = [{"name": way.name, "sub": way.subscript, "color": way.colour, "dash": ""} for way in overlay.ways]
    shown = {shape.name if shape.wanted is not None else "lines of equal weight": shape.colour
             for shape in overlay.shapes}
    legend += [{"name": name, "sub": "", "color": colour, "dash": ""} for name, colour in shown.items()]
    legend.append({"name": "★ and dashed: at the goal", "sub": "", "color": palette.GREEN, "dash": ""})
    if overlay.difference:
        legend += [{"name": "■ darker than the goal image", "sub": "", "color": DARKER, "dash": ""},
                   {"name": "■ brighter", "sub": "", "color": BRIGHTER, "dash": ""}]
    title = "the features in the image, from the start to the goal (★)"
    return {"id": "image", "kind": "image", "title": title, "legend": legend, "data": data,
            "svg": named(_svg(data, _background(record, overlay.difference)), title)}


def coloured_difference(image: np.ndarray, desired: np.ndarray) -> np.ndarray:
    """uint8 (h, w, 3): how an image differs from the desired one, both uint8 (h, w) or (h, w, 3)."""
    grey = [one.astype(float).mean(axis=2) if one.ndim == 3 else one.astype(float) for one in (image, desired)]
    share = np.clip((grey[0] - grey[1]) / FULL, -1.0, 1.0)[..., None]
    darker, equal, brighter = (np.array(palette.rgb(colour), dtype=float) for colour in (DARKER, EQUAL, BRIGHTER))
    mixed = equal + np.abs(share) * (np.where(share < 0.0, darker, brighter) - equal)
    return np.rint(mixed).astype(np.uint8)


def _background(record, difference):
    image = record.initial_image
    if image is None:
        return ""
    if difference and record.desired_image is not None:
        image = coloured_difference(image, record.desired_image)
    return "data:image/jpeg;base64," + base64.b64encode(jpeg(image)).decode()


def _pixels(points):
    """Nested lists, rounded to a tenth of a pixel; None in place of a point that is not known."""
    if points.ndim > 1:
        return [_pixels(one) for one in points]
    return [round(float(x), 1) for x in points] if np.isfinite(points).all() else None


def _svg(data, background):
    width, height = data["width"], data["height"]
    size = width / 52  # of marks, in pixels of the image
    parts = [f'<svg class="pixels" viewBox="-0.5 -0.5 {width} {height}" role="img">']
    if background:
        parts.append(f'<image class="view" href="{background}" x="-0.5" y="-0.5" width="{width}" height="{height}" '
                     f'preserveAspectRatio="none"/>')
    for shape in data["shapes"]:
        if shape["goal"]:
            parts.append(_line("goal", shape["goal"], shape))
    for way in data["ways"]:
        known = [p for p in way["p"] if p]
        parts.append(_line("curve", known, {"color": way["color"], "closed": False}))
        if way["goal"]:
            parts.append(f'<path class="star" style="fill:{palette.GREEN}" d="{star(*way["goal"], 0.7 * size)}"/>')
    parts.append('<g class="now">')
    for shape in data["shapes"]:
        parts.append(_line("shape" if shape["goal"] else "still", shape["seen"][0], shape))
    for way in data["ways"]:
        if way["p"][0]:
            u, v = way["p"][0]
            parts.append(f'<circle class="dot" cx="{u}" cy="{v}" r="{0.45 * size:.1f}" stroke="{way["color"]}"/>')
    return "".join(parts) + "</g></svg>"


def _line(kind, points, shape):
    points = [point for point in points if point]
    closed = "Z" if shape["closed"] and points else ""
    return (f'<path class="{kind}" stroke="{shape["color"]}" d="' + "".join(
        f"{'L' if i else 'M'}{u} {v}" for i, (u, v) in enumerate(points)) + closed + '"/>')
