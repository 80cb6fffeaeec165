"""The page of a run that was repeated on the arm's twin. One self-contained file."""

from typing import Any, Dict, List

import numpy as np

from aras_visual_servo import palette, styles
from .on_twin import OnTwin, feature_of, joint_of
from .settling import SETTLED_PART, error_size
from ..report.joint_units import shown_units
from ..report.plots import series_of, time_plot
from ..report.template import render

BLUE, RED = palette.BLUE, palette.VERMILION
BOTH = ("measured", "twin")
DASHES = {"measured": "", "twin": "5 4"}
COLOURS = {"measured": BLUE, "twin": RED}


def on_twin_html(run: OnTwin, numbers: Dict[str, Any], title: str, command: str) -> str:
    """Returns the page. Args: numbers: of `differences`."""
    plots = [_size(run)]
    for style in styles(run.measured.feature_names):
        plots.append(_plot(run, f"feature_{style.name}", style.name, f"e [{style.read_unit}]",
                           lambda record, style=style: style.factor * feature_of(record, style.name)))
    units = shown_units(run.scenario.urdf_xml())
    for name in run.measured.joint_names:
        factor, unit = units[name]
        plots.append(_plot(run, f"joint_{name}", name, unit,
                           lambda record, name=name, factor=factor: factor * joint_of(record, name)))
    return render("on_twin.html.j2", title=title, command=command, notes=list(dict.fromkeys(run.notes)), plots=plots,
                  summary=_summary(numbers), features=_features(run, numbers), joints=_joints(numbers, units),
                  part=f"{100 * SETTLED_PART:g}")


def text_of(number: Any, digits: int = 3, factor: float = 1.0) -> str:
    """Returns a number times a factor for people, a dash for None."""
    return "–" if number is None else f"{factor * number:.{digits}g}"


def _summary(numbers):
    rows = [{"name": "ended with", "cells": [numbers["ended_with"][one] for one in BOTH]}]
    for key, name in (("settling_s", "settling time [s]"), ("duration_s", "duration of the servo [s]")):
        rows.append({"name": name, "cells": [text_of(numbers[key][one]) for one in BOTH]})
    return rows


def _features(run, numbers) -> List[Dict[str, Any]]:
    rows = []
    for style in styles(run.measured.feature_names):
        of = numbers["features"][style.name]
        scaled = [*(of[key][one] for key in ("start", "final") for one in BOTH), of["rms"]]
        rows.append({"name": f"{style.name} [{style.read_unit}]", "cells": [
            *(text_of(value, factor=style.factor) for value in scaled),
            *(text_of(of["settling_s"][one]) for one in BOTH)]})
    return rows


def _joints(numbers, units):
    return [{"name": f"{name} [{units[name][1]}]",
             "cells": [text_of(of[key], factor=units[name][0]) for key in ("rms", "largest")]}
            for name, of in numbers["joints"].items()]


def _size(run):
    return _plot(run, "size", "root mean square of the errors, in their thresholds", "", error_size, log=True)


def _plot(run, name, title, label, values, log=False):
    """Both runs over the times of their images, from the first servo image on."""
    records = dict(zip(BOTH, (run.measured, run.twin)))
    times = {one: record.servo_t_s for one, record in records.items()}
    grid = np.unique(np.concatenate(list(times.values())))
    series = []
    for one, record in records.items():
        column = values(record)
        seen = np.isfinite(column)
        drawn = np.interp(grid, times[one][seen], column[seen], left=np.nan, right=np.nan) if seen.any() else \
            np.full(len(grid), np.nan)
        series.append(series_of((one, "", COLOURS[one], DASHES[one], 1.0, ""), drawn))
    return time_plot(name, title, grid, series, label, log=log)
