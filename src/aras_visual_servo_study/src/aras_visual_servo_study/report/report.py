"""Result folder of a run: summary.json, trace.csv, figure.{png,pdf}, report.html. Reads a RunRecord, writes files.

    folder = create_result_folder("results", scenario.name)      # before the run, to notice a full or read-only disk
    summary = save_results(record, folder)
    print(format_summary(summary))

The same run gives the same bytes, except for `real_time_factor`, `wall_s`, `versions` and `recorded`. No file contains
the date of the run; the name of the folder does.
"""

import csv
import hashlib
import io
import itertools
import json
import math
import os
import textwrap
import time
from dataclasses import asdict
from pathlib import Path
from typing import Any, Dict, Optional, Union

import numpy as np

from aras_visual_servo import (STOP_NAMES, TWIST_NAMES, RunRecord, Status, StopSettings, fit_decay, judge, spatial,
                               spread, styles, tracking)
from ..files import ResultFolderError, write_whole
from .drawing import Drawing
from .rows import NOT_COMPARABLE, comparison_rows, is_number, stop_rows
from .versions import installed_versions

# The results published with the two experiments.
PUBLISHED = {
    "experiment_1": {"label": "paper, experiment 1",
                     "x_mm": 2.0, "y_mm": 4.7, "z_mm": 2.6, "angle_deg": 0.003},
    "experiment_2": {"label": "paper, experiment 2",
                     "x_mm": 4.0, "y_mm": 8.9, "z_mm": 7.2, "angle_deg": 0.03},
}
PROBE_BYTES = 2**20  # which a disk must have left before a run begins; its report alone takes about as much


def create_result_folder(output: Union[str, Path], scenario_name: str, stamp: Optional[str] = None) -> Path:
    """Makes the empty folder OUTPUT/SCENARIO/STAMP and tries whether it can be written. Returns its path.

    Args: stamp: None takes the local time, e.g. 20260131-142501, with -2, -3, ... if that exists.
    Raises: ResultFolderError: it cannot be made or written, with the system's reason.
    """
    parent = Path(os.path.expanduser(str(output))) / scenario_name
    name = stamp or time.strftime("%Y%m%d-%H%M%S")
    try:
        parent.mkdir(parents=True, exist_ok=True)
        folder = parent / name
        for number in itertools.count(2):
            try:
                folder.mkdir(exist_ok=stamp is not None)
                break
            except FileExistsError:
                folder = parent / f"{name}-{number}"
        probe = folder / ".writable"
        try:
            with open(probe, "wb") as stream:
                stream.write(bytes(PROBE_BYTES))
                os.fsync(stream.fileno())
        finally:
            probe.unlink(missing_ok=True)
    except OSError as error:
        raise ResultFolderError(f"results folder '{parent}': cannot be written: {error.strerror} "
                                f"({error.filename}); choose another with --output") from error
    return folder


def save_results(record: RunRecord, folder: Union[str, Path], command: Optional[str] = None, video: bool = False,
                 panels: bool = False, drawing: Optional[Drawing] = None) -> Dict[str, Any]:
    """Judge a run and write its result folder. The numbers are written first, before the pictures are drawn.

    Args:
        folder: existing folder.  command: how to repeat the run, for the report.
        video: write video.mp4 too (needs the images of the servo phase in the record, and ffmpeg) and show it in the
            report. If the video cannot be made, the report is written without it and a note in it says why.
        panels: write each of the six panels as panel_NAME.pdf too.
        drawing: `drawing.Drawing` that draws the figure meanwhile; None: this process draws it.
    Returns: The summary, as written to summary.json (see `summarise`), with `report`, the path of report.html.
    Raises: ResultFolderError.  NothingToJudge: the run never servoed; only trace.csv is written then.
    """
    from . import page  # only here: jinja2 is slow to import, and so is matplotlib
    folder = Path(folder)
    write_whole(folder / "trace.csv", trace_csv(record))
    summary = summarise(record)
    files = folder / "figure.png", folder / "figure.pdf"
    drawn = None if drawing is None else drawing.save(record, *files)
    film = None
    if video:
        film, notes = _save_video(record, folder / "video.mp4")
        summary["notes"] += notes
    else:
        (folder / "video.mp4").unlink(missing_ok=True)  # an earlier report may have left one
    write_whole(folder / "summary.json", json.dumps(_json_safe(summary), indent=2) + "\n")
    try:
        if drawn is None or panels:
            from . import figure
        if drawn is None:
            figure.save_figure(record, *files)
        if panels:
            figure.save_panels(record, folder)
        write_whole(folder / "report.html", page.report_html(record, summary, command, film))
        if drawn is not None:
            drawn()
    except OSError as error:
        raise ResultFolderError(f"{folder}: the figure cannot be written: {error}") from error
    return dict(summary, report=str(folder / "report.html"))


def _save_video(record, path):
    """(`video.Film` or None, notes)."""
    from .video import VideoError, save_video
    try:
        return save_video(record, path), []
    except VideoError as error:
        return None, [f"no video: {error}"]


def summarise(record: RunRecord) -> Dict[str, Any]:
    """Summary of a run for JSON, judged by the scenario's `experiment.judge`, keys in the order that readers ask."""
    result = judge(record)
    servo = record.settings.get("servo", {})
    base = published_name(record.scenario)
    return {
        "scenario": record.scenario,
        "status": Status(int(record.status[record.servo_rows[-1]])).name,
        "converged": result.converged,
        "settled": result.settled,
        "stopped_by_rule": result.stopped_by_rule,
        "reason": result.reason,
        "passed": result.passed,
        "faults": list(result.faults),
        "duration_s": result.duration_s,
        "images": result.images,
        "final_error": result.final_error,
        "initial_error": result.initial_error,
        "judge": result.limits,
        "tracking": tracking(record) if servo.get("track") else None,
        "published": PUBLISHED.get(base),
        "final_feature_error": result.final_feature_error,
        "stop": _stop(record, servo),
        "thresholds": spread(servo.get("thresholds", {})),
        "gains_per_s": spread(servo.get("gains_per_s", {})),
        "promised_decay_per_s": result.gains_per_s,
        "measured_decay_per_s": fit_decay(record),
        "law": servo.get("law"),
        "mode": servo.get("mode"),
        "seed": record.settings.get("sim", {}).get("seed"),
        "run_hash": record.run_hash,
        "trace_sha256": hashlib.sha256(trace_csv(record).encode()).hexdigest(),
        "recorded": record.recorded,
        "notes": list(record.notes),
        "real_time_factor": record.real_time_factor,
        "wall_s": record.wall_s,
        "versions": {**installed_versions(), **({"opengl": record.opengl} if record.opengl else {})},
    }


def _stop(record, servo):
    """What the stop rule judged beside the feature errors: name -> {found, allowed}, "rule", "cond_l".

    The last values that the servo knew of; None where it did not.
    """
    allowed = {**asdict(StopSettings()), **servo.get("stop", {})}
    stop = {"rule": allowed["rule"], "cond_l": _last(record, "cond_l")}
    for name in STOP_NAMES[:3]:
        stop[name] = {"found": _last(record, name), "allowed": allowed[name]}
    return stop


def _last(record, name):
    column = np.full(0, np.nan) if record.stop is None else record.stop[record.servo_rows, STOP_NAMES.index(name)]
    known = column[np.isfinite(column)]
    return float(known[-1]) if len(known) else None


def published_name(scenario: str) -> str:
    """The published experiment a scenario is a variant of ("experiment_1_binary" -> "experiment_1"), or ""."""
    return next((name for name in PUBLISHED if scenario == name or scenario.startswith(name + "_")), "")


def trace_csv(record: RunRecord) -> str:
    """The record as CSV text, one row per image. A cell is empty if its value did not exist at that image.

    Columns: t_s, phase, status, e_<feature>_<unit>, V_<vx..wz>, q_<joint>, p_WC_{x,y,z}_m and q_WC_{x,y,z,w} (true
    pose of the camera in the world, unit quaternion with w >= 0), and what the stop rule judges, `STOP_NAMES`.
    """
    header = (["t_s", "phase", "status"]
              + [f"e_{style.column}" for style in styles(record.feature_names)]
              + [f"V_{name}_{'m_s' if name[0] == 'v' else 'rad_s'}" for name in TWIST_NAMES]
              + [f"q_{name}" for name in record.joint_names]
              + [f"p_WC_{axis}_m" for axis in "xyz"] + [f"q_WC_{axis}" for axis in "xyzw"] + list(STOP_NAMES))
    stop = np.full((len(record), len(STOP_NAMES)), np.nan) if record.stop is None else record.stop
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(header)
    for i in range(len(record)):
        numbers = np.concatenate([record.e[i], record.twist[i], record.q[i], record.X_WC[i, :3, 3],
                                  spatial.quaternion_xyzw(record.X_WC[i, :3, :3]), stop[i]])
        writer.writerow([f"{record.stamp_ns[i] // 10**9}.{record.stamp_ns[i] % 10**9:09d}", record.phase[i],
                         int(record.status[i])] + [f"{x:.9g}" if math.isfinite(x) else "" for x in numbers])
    return stream.getvalue()


def format_summary(summary: Dict[str, Any]) -> str:
    """The summary as a table for the terminal, ASCII, at most 79 columns wide, str."""
    lines = [f"{summary['scenario']}: {'PASSED' if summary['passed'] else 'FAILED'} ({summary['reason']})", ""]
    lines.append(f"{'final pose error':<31}{'x [mm]':>10}{'y [mm]':>10}{'z [mm]':>10}{'angle [deg]':>14}")
    for row in comparison_rows(summary):
        cells = zip(row["cells"], (10, 10, 10, 14))
        lines.append(f"{row['label']:<31}" + "".join(f"{cell:>{width}}" for cell, width in cells))
    if summary["published"]:
        lines += textwrap.wrap(NOT_COMPARABLE, 79)
    lines += ["", f"{'time to converge' if summary['converged'] else 'servo time':<20}{summary['duration_s']:.2f} s "
                  f"simulated, {summary['images']} images"]
    rates, asked = summary["measured_decay_per_s"], summary["promised_decay_per_s"]
    if rates and asked:
        text = ", ".join(f"{name} {f'{rate:.2f}' if is_number(rate) else 'not exponential'} (asked {asked[name]:g})"
                         for name, rate in rates.items() if name in asked)
        lines.append(f"{'decay [1/s]':<20}{text}")
    lines += [f"{'the servo saw':<20}{row['label']} {row['found']} (allowed {row['allowed']})"
              for row in stop_rows(summary)]
    if is_number(summary["real_time_factor"]):
        lines.append(f"{'real-time factor':<20}{summary['real_time_factor']:.1f}")
    if summary["run_hash"]:
        lines.append(f"{'run hash':<20}{summary['run_hash']}")
        if summary["versions"].get("opengl"):
            lines.append(f"{'':<20}on this kind of processor and with this OpenGL:")
            lines.append(f"{'':<20}{summary['versions']['opengl']}")
    lines += [f"{'!':<20}{fault}" for fault in summary["faults"]]
    lines += [f"{'note':<20}{note}" for note in summary["notes"]]
    if summary.get("report"):
        lines.append(f"{'report':<20}{summary['report']}")
    return "\n".join(lines)


def _json_safe(value):
    """The value with null for NaN and infinity, which JSON does not have."""
    if isinstance(value, dict):
        return {key: _json_safe(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_json_safe(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
