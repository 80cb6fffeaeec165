"""report.html of a run: one self-contained page, readable on a phone and on paper, and complete without JavaScript."""

import base64
import io
import json
import math
from typing import Any, Dict, List, Optional, Tuple

import numpy as np
import yaml

from . import pictures, plots
from .image_plot import image_plot
from .joint_plot import joint_plot
from .replay import ReplayError, replay_of
from .rows import NOT_COMPARABLE, comparison_rows, is_number, stop_rows
from aras_visual_servo import RunRecord, styles
from .template import render, script

# A larger video is not put into the page but stays a file beside it: mail programs and phones refuse larger pages.
EMBEDDED_VIDEO_BYTES = 8_000_000


def report_html(record: RunRecord, summary: Dict[str, Any], command: Optional[str] = None, film: Any = None) -> str:
    """The report as one page: pictures, plots, their script and a small video (`video.Film`) inside.

    Args: summary: `report.summarise(record)`.  command: how to repeat the run, None: in process.
    """
    drawn = plots.plots_of(record, pictures.panel_title(record, "velocity"))
    drawn[3:3] = [plot for plot in (joint_plot(record), image_plot(record)) if plot] if drawn else []
    for plot in drawn:
        # A "<" in the numbers or names could end the script element that contains them.
        plot["json"] = json.dumps(plot.pop("data"), ensure_ascii=False, separators=(",", ":")).replace("<", "\\u003c")
    try:
        shown_again, why_not = replay_of(record), ""
    except ReplayError as error:
        shown_again, why_not = None, str(error)
    scenario = yaml.safe_dump(record.settings, sort_keys=False, allow_unicode=True) if record.settings else ""
    return render(
        "report.html.j2", summary=summary, images=_images(record), plots=drawn, film=film and _film(film),
        replay=shown_again, no_replay=why_not, script=script("lib/draw.js", "report.js") if drawn else "",
        rows=comparison_rows(summary), caveat=NOT_COMPARABLE if summary["published"] else "",
        stop=stop_rows(summary), features=_feature_rows(summary),
        settings=flat_settings(record), eye_to_hand=record.eye_to_hand,
        recorded=[(topic, f"{count['in_bag']} of {count['published']} messages published")
                  for topic, count in record.recorded.items()],
        scenario=scenario, scenario_src=data_uri(scenario.encode(), "text/yaml"),
        command=command or f"aras-servo run {summary['scenario']}")


def data_uri(content: bytes, kind: str) -> str:
    """A data: address that contains these bytes, str."""
    return f"data:{kind};base64," + base64.b64encode(content).decode("ascii")


def png_bytes(image: np.ndarray) -> bytes:
    """The bytes of a PNG file of a uint8 image (h, w) or (h, w, 3) rgb. The same pixels always give the same bytes."""
    import PIL.Image  # slow to import
    stream = io.BytesIO()
    PIL.Image.fromarray(np.ascontiguousarray(image)).save(stream, "PNG")
    return stream.getvalue()


def _images(record):
    """Title and data address of each picture, in the camera's own pixels; address None if the record lacks it."""
    shown = []
    for letter, panel in (("a", "desired"), ("b", "initial"), ("c", "start"), ("", "difference")):
        image = pictures.image_of(record, panel)
        title = (f"({letter}) " if letter else "") + pictures.panel_title(record, panel).replace("$-$", "−")
        largest = pictures.largest_difference(record, panel) if panel in pictures.DIFFERENCES else None
        title += "" if largest is None else f", at most {largest:.0f} grey levels"
        shown.append({"panel": panel, "title": title,
                      "src": None if image is None else data_uri(png_bytes(image), "image/png")})
    return shown


def _film(film):
    small = film.path.stat().st_size <= EMBEDDED_VIDEO_BYTES
    return {"src": data_uri(film.path.read_bytes(), "video/mp4") if small else film.path.name,
            "poster": data_uri(png_bytes(film.poster), "image/png"), "beside": not small,
            "width": film.poster.shape[1], "height": film.poster.shape[0], "speed": film.speed}


def _feature_rows(summary):
    rows, errors = [], summary["final_feature_error"]
    for style, value in zip(styles(errors), errors.values()):
        threshold, gain = summary["thresholds"].get(style.name), summary["gains_per_s"].get(style.name)
        rate = summary["measured_decay_per_s"].get(style.name)
        # Three digits of the threshold, so that an error can be held against it.
        digits = max(4, 2 - math.floor(math.log10(threshold * style.factor))) if threshold else 4
        rows.append({"style": style, "value": f"{value * style.factor:+.{digits}f}" if is_number(value) else "unknown",
                     "threshold": f"{threshold * style.factor:.4g}" if threshold is not None else "",
                     "gain": f"{gain:g}" if gain is not None else "",
                     "rate": "" if rate is None else f"{rate:.2f}" if is_number(rate) else "not exponential"})
    return rows


def flat_settings(record: RunRecord) -> List[Tuple[str, str]]:
    """Rows (dotted key, value as text): every setting of the record's scenario that influences the result."""
    rows = []
    for section in ("robot", "sim", "vision", "servo", "experiment"):
        rows += _flatten(section, record.settings.get(section, {}))
    return rows


def _flatten(prefix, value):
    if isinstance(value, dict) and ("." not in prefix or any(isinstance(v, (dict, list)) for v in value.values())):
        return [row for key, item in value.items() for row in _flatten(f"{prefix}.{key}", item)]
    if isinstance(value, list) and any(isinstance(v, dict) for v in value):
        return [row for i, item in enumerate(value) for row in _flatten(f"{prefix}[{i}]", item)]
    if isinstance(value, dict):
        return [(prefix, ", ".join(f"{key} {item}" for key, item in value.items()))] if value else []
    return [(prefix, ", ".join(map(str, value)) if isinstance(value, list) else str(value))]
