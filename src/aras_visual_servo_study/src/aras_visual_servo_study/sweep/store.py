"""The file of a sweep in SQLite. Runs are saved as they come in, so a process that is killed loses only its last ones.

Tables: `meta` (key, value as JSON); `starts` (every run that is planned); `runs` (every run that is done: its start and
its result, nothing that depends on machine or day); `timing` (id, wall_s, done_at).
"""

import contextlib
import csv
import fcntl
import io
import json
import os
import sqlite3
import time
from dataclasses import replace
from pathlib import Path
from typing import Any, Dict, Iterable, List, Optional, Sequence, Tuple, Union

from aras_visual_servo import GOAL_AXES, ArasError
from .plan import Start
from .judge import COLUMNS

FILE = "sweep.db"
LAYOUT = 2


class StoreError(ArasError):
    """The file of a sweep cannot be read or written."""


class SweepStore:
    """One sweep on disk. Make it with `create` or `open`.

    Attributes:
        folder: of the sweep.  meta: the dict that was given to `create`.
        extra: columns of `runs` beside COLUMNS: start_<joint>, offset_<axis>, goal_<axis>, p_<perturbation>.
    """

    def __init__(self, folder: Union[str, Path], connection: sqlite3.Connection, meta: Dict[str, Any],
                 lock: Optional[int] = None) -> None:
        self.folder, self.meta = Path(folder), meta
        self._connection, self._lock = connection, lock
        self.extra = list(meta["columns"])

    @classmethod
    def create(cls, folder: Union[str, Path], meta: Dict[str, Any], starts: List[Start]) -> "SweepStore":
        """Make the file, with all planned runs (list of `Start`), in a folder that exists and holds no sweep yet."""
        path = Path(folder) / FILE
        if path.exists():
            raise StoreError(f"{path}: found a sweep; continue it with --resume")
        lock = _lock(folder)
        extra = varied_columns(starts)
        meta = dict(meta, layout=LAYOUT, columns=extra)
        with _speaking(path):
            connection = _connect(path)
            columns = ", ".join([f"{_quoted(name)} {kind}" for name, kind in COLUMNS.items()]
                                + [_quoted(name) for name in extra])
            with connection:
                connection.execute("CREATE TABLE meta (key TEXT PRIMARY KEY, value TEXT)")
                connection.execute("CREATE TABLE starts (id INTEGER PRIMARY KEY, joints TEXT, offset TEXT, "
                                   "parameters TEXT, refusal TEXT, goal TEXT)")
                connection.execute(f"CREATE TABLE runs ({columns})")
                connection.execute("CREATE TABLE timing (id INTEGER PRIMARY KEY, wall_s REAL, done_at REAL)")
                connection.executemany("INSERT INTO starts VALUES (?, ?, ?, ?, ?, ?)",
                                       [(s.id, json.dumps(s.joints), json.dumps(s.offset), json.dumps(s.parameters),
                                         s.refusal, json.dumps(s.goal)) for s in starts])
                connection.executemany("INSERT INTO meta VALUES (?, ?)",
                                       [(key, json.dumps(value)) for key, value in meta.items()])
        return cls(folder, connection, meta, lock)

    @classmethod
    def open(cls, folder: Union[str, Path], writing: bool = False) -> "SweepStore":
        """Open the folder or the file of a sweep. Raises StoreError if it is missing or another process writes it."""
        folder = Path(folder)
        path = folder if folder.is_file() else folder / FILE
        if not path.is_file():
            raise StoreError(f"{folder}: found no sweep in this folder (no {FILE})")
        lock = _lock(path.parent) if writing else None
        with _speaking(path):
            connection = _connect(path)
            meta = {key: json.loads(value) for key, value in connection.execute("SELECT key, value FROM meta")}
        if meta.get("layout") != LAYOUT:
            raise StoreError(f"{path}: found layout {meta.get('layout')}, allowed {LAYOUT}")
        for key, kind in (("columns", list), ("setup", dict), ("settings", dict)):
            if not isinstance(meta.get(key), kind):
                raise StoreError(f"{path}: meta.{key}: found {type(meta.get(key)).__name__}, allowed {kind.__name__}")
        return cls(path.parent, connection, meta, lock)

    def starts(self) -> List[Start]:
        """Every run that is planned: list of `Start`, ordered by id."""
        with _speaking(self.folder):
            rows = self._connection.execute("SELECT id, joints, offset, parameters, refusal, goal FROM starts "
                                            "ORDER BY id")
            return [Start(row[0], json.loads(row[1]), json.loads(row[2]), json.loads(row[3]), row[4],
                          json.loads(row[5])) for row in rows]

    def start(self, run_id: int) -> Start:
        """The planned run of this id. Raises StoreError with the range of ids if there is none."""
        starts = self.starts()
        found = [start for start in starts if start.id == run_id]
        if not found:
            raise StoreError(f"{self.folder}: no run {run_id}, there are 1 to {len(starts)}")
        return found[0]

    def pending(self) -> List[Start]:
        """Runs that are planned and not done: list of `Start`, ordered by id."""
        with _speaking(self.folder):
            done = {row[0] for row in self._connection.execute("SELECT id FROM runs")}
        return [start for start in self.starts() if start.id not in done]

    def add(self, results: Sequence[Tuple[Dict[str, Any], float]], starts: Dict[int, Start]) -> None:
        """Save these runs, either all or none.

        Args: results: list of (row, wall_s), row a dict of COLUMNS.  starts: dict id -> `Start`.
        """
        names = list(COLUMNS) + self.extra
        marks = ", ".join("?" * len(names))
        rows = [self._values(row, starts[row["id"]]) for row, _ in results]
        now = time.time()
        with _speaking(self.folder), self._connection:
            self._connection.executemany(f"INSERT INTO runs ({', '.join(map(_quoted, names))}) VALUES ({marks})", rows)
            self._connection.executemany("INSERT INTO timing VALUES (?, ?, ?)",
                                         [(row["id"], wall_s, now) for row, wall_s in results])

    def keep(self, key: str, value: Any) -> None:
        """Saves a value of `meta`, which JSON can hold."""
        self.meta[key] = value
        with _speaking(self.folder), self._connection:
            self._connection.execute("INSERT OR REPLACE INTO meta VALUES (?, ?)", (key, json.dumps(value)))

    def rows(self) -> List[Dict[str, Any]]:
        """Every run that is done: list of dicts of COLUMNS and `extra`, ordered by id."""
        names = list(COLUMNS) + self.extra
        with _speaking(self.folder):
            found = self._connection.execute(f"SELECT {', '.join(map(_quoted, names))} FROM runs ORDER BY id")
            return [dict(zip(names, row)) for row in found]

    def csv(self) -> str:
        """The table `runs` as text."""
        names = list(COLUMNS) + self.extra
        return csv_text(names, ([row[name] for name in names] for row in self.rows()))

    def close(self) -> None:
        """Close the file and release the lock, so that other processes may write."""
        with _speaking(self.folder):
            self._connection.close()
        if self._lock is not None:
            os.close(self._lock)
            self._lock = None

    def __enter__(self) -> "SweepStore":
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()

    def _values(self, row, start):
        given = _varied(start)
        return [row[name] for name in COLUMNS] + [given.get(name) for name in self.extra]


def varied_columns(starts: Sequence[Start]) -> List[str]:
    """Returns the columns of `runs` beside COLUMNS, see `SweepStore.extra`."""
    joints = next((start.joints for start in starts if start.joints), {})
    offset = next((start.offset for start in starts if start.offset), {})
    return list(_varied(replace(starts[0], joints=joints, offset=offset)))


def planned_rows(starts: Sequence[Start]) -> List[Dict[str, Any]]:
    """Returns the rows of these starts as `SweepStore.rows` does, with None for everything that only a run gives."""
    empty = dict.fromkeys([*COLUMNS, *varied_columns(starts)])
    return [{**empty, **_varied(start)} for start in starts]


def _varied(start):
    return {**{f"start_{name}": q for name, q in (start.joints or {}).items()},
            **{f"offset_{axis}": value for axis, value in start.offset.items()},
            **{f"goal_{axis}": value for axis, value in start.goal.items() if axis in GOAL_AXES},
            **{f"p_{name}": value for name, value in start.parameters.items()}}


@contextlib.contextmanager
def _speaking(path):
    """Turns errors of SQLite, and of values that are not what was written, into StoreError with the file's name."""
    try:
        yield
    except (sqlite3.Error, ValueError, TypeError, RecursionError) as error:
        raise StoreError(f"{path}: cannot be read or written: {error}") from error


def csv_text(names: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    """Rows of values, with their names above, as text: a float with all its digits, nothing for None."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(names)
    writer.writerows([repr(value) if isinstance(value, float) else value for value in row] for row in rows)
    return stream.getvalue()


def _connect(path):
    connection = sqlite3.connect(str(path), timeout=30.0)
    connection.execute("PRAGMA journal_mode=WAL")
    connection.execute("PRAGMA synchronous=NORMAL")
    return connection


def _lock(folder):
    """Handle of the lock that keeps other processes from writing. The system releases it when the process ends."""
    try:
        handle = os.open(Path(folder) / ".lock", os.O_CREAT | os.O_RDWR, 0o644)
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        return handle
    except BlockingIOError:
        os.close(handle)
        raise StoreError(f"{folder}: another sweep is writing there") from None
    except OSError as error:
        raise StoreError(f"{folder}: cannot be written: {error.strerror}") from error


def _quoted(name):
    return '"' + name.replace('"', '""') + '"'
