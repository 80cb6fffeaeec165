"""Report of a sweep: runs.csv, {map,curve,reasons}.{png,pdf}, sweep.html. It reads nothing but the store.

The same runs give the same bytes, on whatever machine and in whatever order they were done.
"""

import base64
import math
import shlex
from pathlib import Path
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple

from ..files import write_whole
from ..report.scales import read_off
from ..report.template import render, script
from .figure import default_axes, distance_column, save_figures
from .map import MAP_MODULES, joint_units, plain_label, sweep_maps
from .metrics import known_metrics
from .statistics import aggregate, every_run_succeeds, reasons
from ..report.drawing import Drawing
from .store import SweepStore

CAPTIONS = {"map": "Result, time to the end and final error over two axes.",
            "curve": "Success against the {distance}, with 95 % Wilson intervals.",
            "reasons": "Why runs did not succeed."}
#: Largest number of ids shown for each reason.
MOST_IDS = 8


def save_csv(store: SweepStore) -> Path:
    """Write runs.csv. Returns its path."""
    return write_whole(store.folder / "runs.csv", store.csv())


def save_report(store: SweepStore, drawing: Optional[Drawing] = None) -> Path:
    """Writes runs.csv, the figures and sweep.html of a store with at least one run. Returns the path of sweep.html.

    The axes of the maps are `meta["axes"]` of the store, see `figure.known_axes`; without, `figure.default_axes`.

    Args: drawing: draws the figures; None: processes of this one do.
    Raises: ResultFolderError: a file cannot be written.
    """
    save_csv(store)
    rows = store.rows()
    axes = tuple(store.meta.get("axes") or default_axes(rows))
    pictures = save_figures(rows, store.folder, axes, drawing)
    return write_whole(store.folder / "sweep.html", report_html(store, rows, pictures, axes))


def report_html(store: SweepStore, rows: List[Dict[str, Any]], pictures: Dict[str, bytes],
                axes: Tuple[str, ...]) -> str:
    """The report as one self-contained page, str."""
    numbers, joints = aggregate(rows), joint_units(store.meta["setup"])
    captions = {name: text.format(distance=plain_label(distance_column(rows)).partition(" [")[0])
                for name, text in CAPTIONS.items()}
    shown = {name for name in ("curve", "reasons") if name == "curve" or not every_run_succeeds(rows)}
    planned = len(store.starts())
    return render(
        "sweep.html.j2", name=store.meta["setup"]["scenario"]["name"], numbers=numbers, planned=planned,
        missing=planned - len(rows),
        rates=[(label, f"{100 * numbers[key]:.2f}\u00a0%", f"{100 * numbers[key + '_low']:.2f} to "
                                                           f"{100 * numbers[key + '_high']:.2f}\u00a0%", source)
               for label, key, source in rate_labels() if not math.isnan(numbers[key])],
        spreads=[(label, *(_number(numbers[f"{name}_{part}_{unit}"], form) for part in ("median", "p95", "max")))
                 for label, name, unit, form in (("time [s]", "time", "s", "{:.2f}"),
                                                 ("position error [mm]", "error", "mm", "{:.4f}"),
                                                 ("angle [deg]", "angle", "deg", "{:.5f}"))],
        reasons=[(outcome, reason, len(ids), _first(ids)) for outcome, reason, ids in reasons(rows)],
        maps=sweep_maps(rows, axes, joints=joints), script=script(*MAP_MODULES),
        map=base64.b64encode(pictures["map"]).decode(),
        map_caption=captions["map"], one_colour=every_run_succeeds(rows),
        pictures=[(captions[name], base64.b64encode(png).decode()) for name, png in pictures.items() if name in shown],
        settings=setting_rows(store.meta, joints), command=repeat_line(store.meta),
        driven=store.meta["setup"]["drive_to_start"], versions=store.meta["versions"])


def repeat_line(meta: Dict[str, Any]) -> str:
    """Returns the line that repeats the sweep, with the axes that its maps had last."""
    words = shlex.split(meta["command"])
    if "--axes" in words:
        at = words.index("--axes")
        del words[at:at + 3]
    return shlex.join([*words, *(["--axes", *meta["axes"]] if meta.get("axes") else [])])


def rate_labels() -> Sequence[Tuple[str, str, str]]:
    """(label, name in `aggregate`, source) of all ways to succeed."""
    return (*((f"{metric.label}: {metric.threshold}", metric.name, metric.source) for metric in known_metrics()),
            ("the law's own stop rule was met", "converged", ""))


def setting_rows(meta: Dict[str, Any], joints: Mapping[str, str] = {}) -> List[Tuple[str, str]]:
    """(name, value) of everything that the sweep varied. Args: joints: of `joint_units`."""
    settings = meta["settings"]
    rows = [(key, str(settings[key])) for key in ("starts", "method", "space", "seed")]
    for words, ranges in (("range of ", settings["ranges"]), ("goal, range of ", settings["goal"])):
        for key, (low, high) in ranges.items():
            name, factor, unit = read_off(key, joints.get(key, ""))
            rows.append((words + name, f"{factor * low:.6g} to {factor * high:.6g} {unit}".strip()))
    return rows + [(f"perturbed: {name}", text) for name, text in settings["perturb"].items()]


def format_summary(store: SweepStore) -> str:
    """The sweep as a few lines for the terminal."""
    return format_rows(store.meta["setup"]["scenario"]["name"], store.rows())


def format_rows(scenario: str, rows: List[Dict[str, Any]]) -> str:
    """The runs of a scenario, by its name, as a few lines."""
    numbers = aggregate(rows)
    lines = [f"{scenario}: {numbers['runs']} runs, {numbers['feasible']} feasible, "
             f"{numbers['infeasible']} starts refused, {numbers['errors']} errors"]
    for label, key in (*((metric.label, metric.name) for metric in known_metrics()), ("converged", "converged")):
        if not math.isnan(numbers[key]):
            lines.append(f"{label:<20}{100 * numbers[key]:.2f} %   (95 %: {100 * numbers[key + '_low']:.2f} to "
                         f"{100 * numbers[key + '_high']:.2f} %)")
    if not math.isnan(numbers["time_median_s"]):
        lines.append(f"{'time, median':<20}{numbers['time_median_s']:.2f} s simulated, 95 % below "
                     f"{numbers['time_p95_s']:.2f} s")
        lines.append(f"{'error, median':<20}{numbers['error_median_mm']:.4f} mm, 95 % below "
                     f"{numbers['error_p95_mm']:.4f} mm")
    lines += [f"{len(ids):>6} {outcome:<11} {reason}: id {_first(ids)}" for outcome, reason, ids in reasons(rows)]
    return "\n".join(lines)


def _first(ids):
    """The first ids as text."""
    return ", ".join([*map(str, ids[:MOST_IDS]), *(["..."] if len(ids) > MOST_IDS else [])])


def _number(value, form):
    return "" if math.isnan(value) else form.format(value)
