"""Runs a protocol: each case is a sweep of its own, so that a benchmark is resumed, spread over the cores and rerun as
a sweep is. Then the table: successes with Wilson's interval beside what is published."""

import hashlib
import io
import statistics
import sys
from pathlib import Path
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple

from aras_visual_servo import ParameterError
from ...files import write_whole
from ...report.versions import installed_versions
from ...sweep.engine import Progress, open_sweep, run_pending
from ...sweep.statistics import wilson
from ...sweep.store import csv_text
from .base import Case, Protocol

#: Each case with its rows.
Results = List[Tuple[Case, List[Dict[str, Any]]]]
HEADINGS = ("starts", "success", "95 % interval", "published", "whose", "median error [mm]", "[deg]", "broke off",
            "hash")


def run_protocol(protocol: Protocol, folder: Path, count: Optional[int] = None, names: Sequence[str] = (),
                 changes: Mapping[str, Any] = {}, own: Mapping[str, str] = {}, command: str = "",
                 workers: Optional[int] = None, scheduler: Optional[str] = None, quiet: bool = False) -> Results:
    """Does the pending runs of a protocol.

    Args:
        folder: where each case has a folder.  count: starts of each case; None: all.
        names: of the cases, or their beginnings; (): all cases.  changes, own: as of `Protocol.changed_cases`.
        command: line that repeats it.  workers, scheduler: as of `run_pending`.  quiet: show no progress on stderr.
    Raises:
        ParameterError: an unknown case, or values that a scenario cannot have.  The errors of `run_pending`.
    """
    cases = protocol.changed_cases(folder / "files", protocol.published_starts if count is None else count,
                                   dict(changes), **own)
    unknown = [name for name in names if not any(_begins(case, name) for case in cases)]
    if unknown:
        raise ParameterError(f"cases: found {', '.join(unknown)}, allowed {', '.join(case.name for case in cases)}")
    results = []
    for case in [case for case in cases if not names or any(_begins(case, name) for name in names)]:
        if not quiet:
            print(f"benchmark: {folder / case.name}", file=sys.stderr)
        results.append((case, run_case(protocol, case, folder, command, workers, scheduler, quiet)))
    return results


def _begins(case, name):
    """Whether the case has this name, or one that begins with it: orb_plain with orb."""
    return f"{case.name}_".startswith(f"{name}_")


def run_case(protocol: Protocol, case: Case, folder: Path, command: str = "", workers: Optional[int] = None,
             scheduler: Optional[str] = None, quiet: bool = False) -> List[Dict[str, Any]]:
    """Does the pending runs of a case. Returns its rows, list of dicts. Raises the errors of `run_pending`."""
    settings = {"protocol": protocol.name, "case": case.name, "starts": len(case.starts), "method": protocol.name,
                "space": "joint", "seed": 0, "drive_to_start": False, "ranges": {}, "goal": {}, "perturb": {}}
    with open_sweep(folder / case.name, case.scenario, case.starts, settings, command, installed_versions()) as store:
        progress = Progress(len(case.starts), store.rows(), io.StringIO()) if quiet else None
        run_pending(store, store.meta["setup"], workers, scheduler, progress)
        return store.rows()


def table(protocol: Protocol, results: Results) -> List[List[str]]:
    """Rows of the table, lists of text, the headings first.

    A start that could not be tried, because nothing was recognised in its first view, counts as a failure: the protocol
    has no other word for it.
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
                      f"Hash of the whole table: {total(lines)[:16]}",
                      *(["", f"Repeat it: `{command}`"] if command else [])]) + "\n"


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
