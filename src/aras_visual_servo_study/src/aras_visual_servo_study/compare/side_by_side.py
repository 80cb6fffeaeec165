"""Puts two or more runs side by side on one page: path, errors, joints between their limits, and differing settings.

    page = save_side_by_side([read_run("naive_inverse"), read_run("redundant")], folder, command)
"""

import base64
from dataclasses import dataclass
from pathlib import Path
from textwrap import fill
from typing import Any, Dict, List, Optional, Sequence, Tuple

import matplotlib
import numpy as np
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d import Axes3D

import aras_visual_servo as avs
from aras_visual_servo import (Outline, ParameterError, RunRecord, fit_decay, judge, load_scenario, measures, palette,
                               scenario_from_dict, track_of)
from ..files import SCENARIO_FILE, write_whole
from ..report.figure import STYLE, draw_panel, save_both
from ..report.page import flat_settings
from ..report.template import render
from .settling import settling_s
from .laws_report import COLOURS, FLOOR_DEG, FLOOR_MM, TABLE, cells
from ..sweep.judge import judge_row


#: Rates of decay and differing settings in the table of the terminal, at most.
MOST_DECAYS, MOST_DIFFERENCES = 8, 10
#: Letters in a line of a legend.
LEGEND_WIDTH = 24


@dataclass
class Run:
    """One run.  label.  record: RunRecord.  lower, upper: (m,) limits of its joints.  outline: `Outline` or None."""

    label: str
    record: RunRecord
    lower: np.ndarray
    upper: np.ndarray
    outline: Optional[Outline] = None


def read_run(source: str, changes: Optional[Dict[str, Any]] = None) -> Run:
    """Reads or makes a run that is to be compared.

    Args: source: a scenario by name or path, which is run here with `changes`; or a bag, a folder of bags, or the
        folder of a run without a bag, which is run again as it was.
    Raises: ParameterError: there is no such scenario, changes of a recorded run, or a bag without its scenario.
        BagError: the bags hold no run.
    """
    path = Path(source)
    if changes and (path.suffix == ".bag" or path.is_dir()):
        raise ParameterError(f"{source}: found {', '.join(changes)} to change, allowed nothing with the run of a "
                             "folder or a bag: name its scenario")
    if path.is_dir() and (path / SCENARIO_FILE).is_file() and not any(path.glob("*.bag*")):
        scenario = load_scenario(str(path / SCENARIO_FILE))
        record, label = avs.run(scenario), f"{scenario.name} ({path.name})"
    elif path.suffix == ".bag" or path.is_dir():
        from aras_visual_servo_controller import read_bag  # needs rosbag
        record = read_bag(str(path))
        if not record.settings:
            raise ParameterError(f"{source}: scenario: found none in the bag, allowed a bag with the topic scenario")
        scenario = scenario_from_dict(dict(record.settings), source=str(path))
        label = f"{record.scenario} ({path.parent.name if path.suffix == '.bag' else path.name})"
    else:
        scenario = load_scenario(source, changes)
        record, label = avs.run(scenario), scenario.name
    kinematics = scenario.kinematics(calibrated=False)
    limits = [dict(zip(kinematics.joint_names, ends)) for ends in (kinematics.lower, kinematics.upper)]
    lower, upper = (np.array([ends.get(name, sign * np.inf) for name in record.joint_names])
                    for ends, sign in zip(limits, (-1.0, 1.0)))
    return Run(label, record, lower, upper, Outline.of(scenario))


def rows_of(run: Run) -> Dict[str, Any]:
    """Result of a run: a row of sweep.judge with its MEASURES filled in."""
    return dict(judge_row(run.record), **measures(run.record, run.lower, run.upper, run.outline))


def differing(runs: Sequence[Run]) -> List[Tuple[str, List[str]]]:
    """(setting, its value in each run as text) of every setting that is not the same in all runs."""
    tables = [dict(flat_settings(run.record)) for run in runs]
    keys = list(dict.fromkeys(key for table in tables for key in table))
    return [(key, [table.get(key, "") for table in tables]) for key in keys
            if len({table.get(key, "") for table in tables}) > 1]


def make_figure(runs: Sequence[Run]) -> Figure:
    """Figure with a column per run: path, errors, distance and angle to the goal, joints. A row shares its axes."""
    rows = 4
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(max(4.2 * len(runs), 6.0), 11.5))
        grid = figure.add_gridspec(rows, len(runs), left=0.09, right=0.93, top=0.955, bottom=0.045, hspace=0.3,
                                   wspace=0.5, height_ratios=(1.25, 1.0, 1.0, 1.2))
        panels = [[figure.add_subplot(grid[row, column], projection=Axes3D.name if row == 0 else None)
                   for column in range(len(runs))] for row in range(rows)]
        for column, run in enumerate(runs):
            path, errors, left, joints = (panels[row][column] for row in range(rows))
            draw_panel(run.record, "path", path, title=False)
            path.set_title(run.label, fontweight="bold")
            draw_panel(run.record, "errors", errors, title=False)
            _draw_left(run, left)
            _draw_joints(run, joints)
        for row in panels:
            _same_limits(row, "xyz" if row is panels[0] else "xy")
    return figure


def table_of(runs: Sequence[Run]) -> List[Tuple[str, Sequence[str]]]:
    """[(title, a text per run)] of the table of laws."""
    columns = zip(*(cells(rows_of(run)) for run in runs))
    table: List[Tuple[str, Sequence[str]]] = [(title if title != "[deg]" else "error [deg]", texts)
                                              for (_, title, _), texts in zip(TABLE, columns)]
    settled = [settling_s(run.record) for run in runs]
    rates = [fit_decay(run.record) for run in runs]
    shared = [name for name in rates[0] if all(name in each for each in rates)]
    return [*table, ("settled [s]", _texts(settled)),
            *((f"decay {name} [1/s]", _texts([each[name] for each in rates])) for name in shared[:MOST_DECAYS])]


def _texts(values):
    return ["–" if np.isnan(value) else f"{value:.2f}" for value in values]


def save_side_by_side(runs: Sequence[Run], folder: Path, command: str) -> Path:
    """Write runs.png, runs.pdf and runs.html into a folder. Returns the path of the page. Raises ResultFolderError."""
    table = [("ended with", [judge(run.record).reason for run in runs]), *table_of(runs)]
    picture = base64.b64encode(save_both(make_figure(runs), folder / "runs")).decode("ascii")
    return write_whole(folder / "runs.html", render("runs.html.j2", labels=[run.label for run in runs], table=table,
                                                    settings=differing(runs), command=command, picture=picture))


def format_runs(runs: Sequence[Run]) -> str:
    """The table of the runs as text for the terminal."""
    width = max(14, *(len(run.label) + 2 for run in runs))
    lines = [title.ljust(20) + "".join(text.rjust(width) for text in texts)
             for title, texts in [("", [run.label for run in runs]), *table_of(runs)]]
    lines += [f"{run.label}: {judge(run.record).reason}" for run in runs]
    lines += [f"differs: {key}: {' / '.join(value or '–' for value in values)}"
              for key, values in differing(runs)[:MOST_DIFFERENCES]]
    lines += [f"note: {run.label}: {note}" for run in runs for note in run.record.notes]
    return "\n".join(lines)


def _draw_left(run, axes):
    track = track_of(run.record)
    axes.plot(track.t_s, np.maximum(track.distance_mm, FLOOR_MM), color=COLOURS[0], label="distance [mm]")
    axes.plot(track.t_s, np.maximum(track.angle_deg, FLOOR_DEG), color=COLOURS[1], label="angle [deg]")
    axes.set(yscale="log", xlabel="time since the servo started [s]", ylabel="distance to the goal, true pose")
    axes.legend(loc="best")


def _draw_joints(run, axes):
    """Draw where each joint is between its limits, -1 to 1. The legend names joints without limits."""
    rows = run.record.servo_rows
    t_s = run.record.t_s[rows] - run.record.t_s[rows[0]]
    limited = np.flatnonzero(np.isfinite(run.lower) & np.isfinite(run.upper))
    for place, joint in enumerate(limited):
        lower, upper = run.lower[joint], run.upper[joint]
        part = (2.0 * run.record.q[rows, joint] - lower - upper) / (upper - lower)
        axes.plot(t_s, part, color=COLOURS[place % len(COLOURS)], label=run.record.joint_names[joint])
    for end in (-1.0, 1.0):
        axes.axhline(end, color=palette.GREY, linewidth=1.5)
    axes.set(ylim=(-1.08, 1.08), xlabel="time since the servo started [s]", ylabel="joints between their limits")
    free = [name for joint, name in enumerate(run.record.joint_names) if joint not in limited]
    if free:
        axes.plot([], [], " ", label=fill(f"no limits: {', '.join(free)}", LEGEND_WIDTH))
    axes.legend(loc="best", ncol=2, columnspacing=1.0, handlelength=1.5)


def _same_limits(row, names):
    for name in names:
        ends = [getattr(axes, f"get_{name}lim")() for axes in row]
        for axes in row:
            getattr(axes, f"set_{name}lim")(min(end[0] for end in ends), max(end[1] for end in ends))
