"""Writes the results of a comparison of laws: comparison.{csv,png,pdf,html}, and the table for the terminal."""

import base64
import csv
import io
from pathlib import Path
from typing import Any, Dict, List

from .laws_figure import save_figure
from ..report.template import render
from ..report.report import ResultFolderError
from ..report.versions import installed_versions
from .laws import Comparison, Results

#: Columns of the table: name in the row, heading, format.
TABLE = (("error_mm", "error [mm]", "{:.2f}"), ("angle_deg", "[deg]", "{:.3f}"), ("duration_s", "time [s]", "{:.1f}"),
         ("path_mm", "path [mm]", "{:.0f}"), ("detour_mm", "detour [mm]", "{:.0f}"),
         ("farthest_mm", "farthest [mm]", "{:.0f}"), ("joint_room", "joint room", "{:.2f}"),
         ("border_px", "border [px]", "{:.0f}"))
#: A law has arrived if the camera ends this close to the goal. The limits are loose: a law whose features hardly tell a
#: tilt may stop more than a millimetre away.
ARRIVED_MM, ARRIVED_DEG = 2.0, 0.5
COLUMNS = ("outcome", "reason", "detail", "converged", "distance0_mm", "angle0_deg", "error_mm", "x_mm", "y_mm", "z_mm",
           "angle_deg", "duration_s", "images", "path_mm", "detour_mm", "farthest_mm", "joint_room", "border_px",
           "run_hash", "trace_hash")


def arrived(row: Dict[str, Any]) -> bool:
    """Whether the true camera pose at the end is within ARRIVED_MM and ARRIVED_DEG of the goal."""
    return row["error_mm"] is not None and row["error_mm"] < ARRIVED_MM and row["angle_deg"] < ARRIVED_DEG


def verdict(row: Dict[str, Any]) -> str:
    """How a run ended in a word or two."""
    if row["outcome"] == "infeasible":
        return f"refused: {row['reason']}"
    if arrived(row):
        return "arrived" if row["converged"] else f"arrived, {row['reason']}"
    return "converged elsewhere" if row["converged"] else row["reason"]


def cells(row: Dict[str, Any]) -> List[str]:
    """The cells of a row of TABLE as texts, empty where there is no value."""
    return ["" if row[column] is None else form.format(row[column]) for column, _, form in TABLE]


def csv_text(results: Results) -> str:
    """The results as CSV text, one row per task and law."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(["task", "law", *COLUMNS])
    for task, law, row, _ in results:
        values = [row[name] for name in COLUMNS]
        writer.writerow([task, law, *("" if v is None else repr(v) if isinstance(v, float) else v for v in values)])
    return stream.getvalue()


def format_table(comparison: Comparison, results: Results) -> str:
    """The table as text for the terminal, a block per task."""
    width = max(12, *(len(law) + 2 for law in comparison.scenarios))
    lines = [f"{comparison.name}: {comparison.description}"]
    for task in comparison.tasks:
        lines += ["", task.title.ljust(width + 26) + "".join(f"{title:>14}" for _, title, _ in TABLE)]
        lines += [f"  {law:<{width}}{verdict(row):<24}" + "".join(f"{cell:>14}" for cell in cells(row))
                  for name, law, row, _ in results if name == task.name]
    return "\n".join(lines)


def save_comparison(comparison: Comparison, results: Results, folder: Path, command: str) -> Path:
    """Write all files into an existing folder. Returns the path of comparison.html. Raises ResultFolderError."""
    try:
        (folder / "comparison.csv").write_text(csv_text(results), encoding="utf-8")
        picture = save_figure(comparison, results, folder)
        path = folder / "comparison.html"
        path.write_text(page(comparison, results, picture, command), encoding="utf-8")
    except OSError as error:
        raise ResultFolderError(f"{folder}: cannot be written: {error}") from error
    return path


def page(comparison: Comparison, results: Results, picture: bytes, command: str) -> str:
    """The report as one self-contained page, str."""
    blocks = [(task.title, [(law, verdict(row), arrived(row), cells(row)) for name, law, row, _ in results
                            if name == task.name]) for task in comparison.tasks]
    counts = [(law, sum(arrived(row) for _, name, row, _ in results if name == law)) for law in comparison.scenarios]
    return render("comparison.html.j2", name=comparison.name, description=comparison.description, blocks=blocks,
                  headings=[title for _, title, _ in TABLE], arrived=counts, tasks=len(comparison.tasks),
                  picture=base64.b64encode(picture).decode("ascii"), command=command, versions=installed_versions())
