"""Runs a protocol: each case is a sweep of its own, so that a benchmark is resumed, spread over the cores and rerun as
a sweep is. Then the table: successes with Wilson's interval beside what is published."""

import hashlib
import statistics
from pathlib import Path
from typing import Any, Dict, List, Optional, Sequence, Tuple

from ...sweep.engine import open_sweep, run_pending
from ...report.report import write_whole
from ...sweep.statistics import wilson
from ...sweep.store import csv_text
from .base import Case, Protocol

HEADINGS = ("starts", "success", "95 % interval", "published", "whose", "median error [mm]", "[deg]", "broke off",
            "hash")


def run_case(protocol: Protocol, case: Case, folder: Path, command: str = "", versions: Optional[Dict[str, str]] = None,
             workers: Optional[int] = None, scheduler: Optional[str] = None) -> List[Dict[str, Any]]:
    """Does the pending runs of a case. Returns its rows, list of dicts. Raises the errors of `run_pending`."""
    settings = {"protocol": protocol.name, "case": case.name, "starts": len(case.starts), "method": protocol.name,
                "space": "joint", "seed": 0, "drive_to_start": False, "ranges": {}, "goal": {}, "perturb": {}}
    with open_sweep(folder / case.name, case.scenario, case.starts, settings, command, versions) as store:
        run_pending(store, store.meta["setup"], workers, scheduler)
        return store.rows()


def table(protocol: Protocol, results: List[Tuple[Case, List[Dict[str, Any]]]]) -> List[List[str]]:
    """Rows of the table, the headings first.

    A start that could not be tried, because nothing was recognised in its first view, counts as a failure.
    """
    parts = [(case, columns, chosen) for case, rows in results for columns, chosen in protocol.lines(case, rows)]
    extra = list(dict.fromkeys(name for _, columns, _ in parts for name in columns))
    lines = [[*(extra or ["case"]), *HEADINGS]]
    for case, columns, rows in parts:
        won = [row for row in rows if row[protocol.metric] == 1]
        low, high = wilson(len(won), len(rows))
        rate, whose = ("", "") if case.published is None else (_percent(case.published[0]), case.published[1])
        lines.append([*([columns.get(name, "") for name in extra] or [case.name]), str(len(rows)),
                      _percent(len(won) / len(rows)) if rows else "", f"{_percent(low)} to {_percent(high)}", rate,
                      whose, _median(won, "error_mm"), _median(won, "angle_deg"), _broken(rows), digest(rows)[:16]])
    return lines


def digest(rows: List[Dict[str, Any]]) -> str:
    """SHA-256 over the traces of all runs, hexadecimal: equal for benchmarks that are equal bit for bit."""
    text = "\n".join(f"{row['id']} {row['outcome']} {row['trace_hash']}" for row in rows)
    return hashlib.sha256(text.encode()).hexdigest()


def total(lines: Sequence[Sequence[str]]) -> str:
    """SHA-256 over the hashes of all lines of a table with what they are of, hexadecimal: that of the whole benchmark.

    Args: lines: of `table`.
    """
    extra = len(lines[0]) - len(HEADINGS)
    text = "\n".join(" ".join([*line[:extra], line[-1]]) for line in lines[1:])
    return hashlib.sha256(text.encode()).hexdigest()


def markdown_table(lines: Sequence[Sequence[str]]) -> str:
    """A table in Markdown, the headings first."""
    return "".join("| " + " | ".join(line) + " |\n" for line in [lines[0], ["---"] * len(lines[0]), *lines[1:]])


def as_markdown(protocol: Protocol, lines: Sequence[Sequence[str]], command: str) -> str:
    """The table, its source and the line that repeats it, as text."""
    return "\n".join([f"# {protocol.title}", "", markdown_table(lines),
                      f"Success as metric `{protocol.metric}` has it. Source: {protocol.source}.", "",
                      f"Hash of the whole table: {total(lines)[:16]}", "", f"Repeat it: `{command}`"]) + "\n"


def save_table(protocol: Protocol, lines: Sequence[Sequence[str]], folder: Path, command: str) -> Path:
    """Write benchmark.md and benchmark.csv. Returns the path of the first."""
    write_whole(folder / "benchmark.csv", csv_text(lines[0], lines[1:]))
    return write_whole(folder / "benchmark.md", as_markdown(protocol, lines, command))


def _broken(rows):
    """How many runs ended with an error of the program, and the first of these errors; "" for none."""
    errors = [f"{row['reason']}: {row['detail']}" for row in rows if row["outcome"] == "error"]
    return f"{len(errors)}: {errors[0]}" if errors else ""


def _percent(rate):
    return f"{100.0 * rate:.1f} %"


def _median(rows, column):
    return f"{statistics.median(row[column] for row in rows):.3g}" if rows else "nan"
