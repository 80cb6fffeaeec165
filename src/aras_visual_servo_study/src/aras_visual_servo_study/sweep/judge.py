"""Judges a run of a sweep: its result is one row, which depends on the record of the run alone."""

import hashlib
from typing import Any, Dict

import numpy as np

from aras_visual_servo import FEATURE_NAMES, MEASURES, RunRecord, Status, goal_pose, judge
from .metrics import Outcome, judge_by, known_metrics

#: The reason of a run that timed out names the most frequent status of its last part, which is this long.
LAST_PART_S = 1.0

#: Columns of a result and their type in SQLite. The columns of the start are stored beside them.
COLUMNS = {
    "id": "INTEGER PRIMARY KEY", "outcome": "TEXT", "reason": "TEXT", "detail": "TEXT", "converged": "INTEGER",
    **{metric.name: "INTEGER" for metric in known_metrics()}, "duration_s": "REAL", "images": "INTEGER",
    "goal_distance_mm": "REAL", "distance0_mm": "REAL", "angle0_deg": "REAL", "x0_mm": "REAL", "y0_mm": "REAL",
    "z0_mm": "REAL",
    "error_mm": "REAL", "x_mm": "REAL", "y_mm": "REAL", "z_mm": "REAL", "angle_deg": "REAL",
    **dict.fromkeys(MEASURES, "REAL"), **{f"e_{name}": "REAL" for name in FEATURE_NAMES},
    "run_hash": "TEXT", "trace_hash": "TEXT",
}


def judge_row(record: RunRecord) -> Dict[str, Any]:
    """Result of a run as a dict of COLUMNS. `id` and MEASURES are left None for the caller to fill in."""
    judgement = judge(record)
    error, row = judgement.final_error, dict.fromkeys(COLUMNS)
    row.update(initial_columns(judgement.initial_error))
    row.update({key: error[key] for key in ("x_mm", "y_mm", "z_mm", "angle_deg")})
    row["error_mm"] = _length(error)
    row["converged"] = int(judgement.converged)
    row["goal_distance_mm"] = _goal_distance_mm(record)
    row.update(judge_by(Outcome(*[row[name] for name in Outcome._fields])))  # type: ignore[arg-type]
    row.update(outcome="success" if row["success"] else "failure", reason=_reason(record, judgement, row["success"]),
               detail=judgement.reason, duration_s=judgement.duration_s, images=judgement.images,
               run_hash=record.run_hash, trace_hash=trace_hash(record))
    row.update({f"e_{name}": value for name, value in judgement.final_feature_error.items() if f"e_{name}" in COLUMNS})
    return row


def trace_hash(record: RunRecord) -> str:
    """SHA-256 of every number of the trace, hexadecimal: equal for equal runs, bit for bit."""
    digest = hashlib.sha256(",".join(record.phase).encode())
    for name in ("stamp_ns", "status", "s", "e", "twist", "q", "X_WC"):
        digest.update(np.ascontiguousarray(getattr(record, name)).tobytes())
    return digest.hexdigest()


def _reason(record, judgement, success):
    rows = record.servo_rows
    status = record.status[rows]
    last = Status(status[-1])
    if judgement.converged:
        return "converged" if success else "converged elsewhere"
    if last == Status.STOPPED_BY_RULE:
        return judgement.reason
    if last == Status.TARGET_LOST:
        return "target lost"
    if last == Status.TIMED_OUT:
        part = status[:-1][record.t_s[rows[:-1]] >= record.t_s[rows[-1]] - LAST_PART_S]
        counts = np.bincount(part) if len(part) else np.zeros(1)
        names = {Status.JOINT_LIMIT: ", at a joint limit", Status.NEAR_SINGULARITY: ", at a singularity",
                 Status.TARGET_LOST: ", target lost", Status.OUT_OF_REACH: ", out of reach"}
        lacking = judgement.reason.partition(": ")[2].split(", ")
        return "timed out" + names.get(int(np.argmax(counts)), ", tilt" if lacking[0] == "tilt" else "")
    return last.name.lower().replace("_", " ")


def initial_columns(error: Dict[str, float]) -> Dict[str, float]:
    """The columns that say how far from the goal a run begins, from the `pose_error` of its start."""
    return {"distance0_mm": _length(error), "angle0_deg": error["angle_deg"], "x0_mm": error["x_mm"],
            "y0_mm": error["y_mm"], "z0_mm": error["z_mm"]}


def _goal_distance_mm(record):
    """Distance of the goal camera from the target's frame at the end [mm], None without a target."""
    if record.X_WT is None:
        return None
    return float(1e3 * np.linalg.norm(goal_pose(record, record.servo_rows[-1])[:3, 3] - record.X_WT[:3, 3]))


def _length(error):
    return float(np.sqrt(error["x_mm"] ** 2 + error["y_mm"] ** 2 + error["z_mm"] ** 2))
