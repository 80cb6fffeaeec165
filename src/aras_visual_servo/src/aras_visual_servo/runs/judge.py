"""Judges a run by the true camera pose, not by the features that the servo saw.

`judge(record)` is a pure function of the record. `run(scenario)` makes such a record without ROS.
"""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Callable, Dict, Optional

import numpy as np

from .record import RunRecord
from ..features.base import spread
from ..ground.errors import ArasError
from ..spatial import inverse, mean_pose, rotation_angle
from ..ground.types import FEATURE_NAMES, Status

if TYPE_CHECKING:
    from ..scenario.scenario import Scenario

# A decay is fitted while the error is above this share of its largest value ...
FIT_FLOOR_SHARES = 0.05, 0.002
# ... and above this many times its stop threshold. Below that, the error is shaped by the pixels and not by the law.
FIT_FLOOR_THRESHOLDS = 3.0
FIT_MIN_ROWS = 8
#: ... and only where ln |e| is straight within this part of its range: from the first image, and from a later one on.
FIT_BENT = 0.07, 0.02


class NothingToJudge(ArasError):
    """The run has no taught view or no servo phase; the text says how it ended."""


@dataclass(frozen=True)
class Judgement:
    """The result of a run.

    Attributes:
        converged: features, tilt and pose were within their thresholds.  reason: the last status in words.
        settled: the servo has arrived as far as its features tell (SETTLED); the reason names the unknown part.
        stopped_by_rule: the published stop rule was met, which the scenario asks for in place of converging.
        passed: one of the three, and the true final error is within the scenario's `experiment.judge`.
        faults: why the run did not pass, one line each.
        duration_s: simulated seconds from the first servo image to the one that ended it.
        final_error: x_mm, y_mm, z_mm of p_CgC in the goal camera frame Cg and the total angle_deg of R_CgC; eye-to-hand
            of the target in the camera against the taught one, see `true_error`.
        initial_error: the same at the first servo image.
        final_feature_error: feature name -> e at the end, in its unit (features.styles).
        gains_per_s: feature name -> gain lambda of the scenario, at which its error decays (`fit_decay`); {} if the law
            promises no exponential decay.
        limits: the scenario's judge thresholds, {} if it has none.
        images: number of servo images.
    """

    converged: bool
    reason: str
    passed: bool
    faults: tuple
    duration_s: float
    final_error: dict
    initial_error: dict
    final_feature_error: dict
    gains_per_s: dict
    limits: dict
    images: int
    stopped_by_rule: bool = False
    settled: bool = False


def run(scenario: "Scenario", progress: Optional[Callable[[float, str], None]] = None,
        keep_images: bool = False) -> RunRecord:
    """Runs a scenario without ROS: simulator, moments and sequence in this process.

    Args:
        progress: called with each row's (t_s, phase), or None.
        keep_images: keep every image of the servo phase in the record, for a video.
    """
    from .loop import ServoLoop  # needs the C++ modules, so it is imported only when a scenario is run
    return ServoLoop(scenario).run(progress=progress, keep_images=keep_images)


def judge(record: RunRecord) -> Judgement:
    """Judges a run, from its `teach` row and its servo rows with true camera poses.

    Raises NothingToJudge: the record has no taught view or no servo row.
    """
    rows = record.servo_rows
    if not len(rows) or not len(record.rows("teach")):
        have = ", ".join(dict.fromkeys(record.phase.tolist())) or "none"
        end = f"; it ended with: {record.status_text[-1] or Status(int(record.status[-1])).name}" if len(record) else ""
        raise NothingToJudge(f"run '{record.scenario}': no taught view or no servo image, phases found: {have}{end}")
    first, last = int(rows[0]), int(rows[-1])
    converged = bool(record.status[last] == Status.CONVERGED)
    stopped_by_rule = bool(record.status[last] == Status.STOPPED_BY_RULE)
    settled = bool(record.status[last] == Status.SETTLED)
    final_error = true_error(record, last)
    limits = dict(record.settings.get("experiment", {}).get("judge", {}))
    reason = str(record.status_text[last]) or Status(int(record.status[last])).name
    faults = [] if converged or stopped_by_rule or settled and limits else [f"not converged: {reason}"]
    for key, limit in limits.items():
        if not abs(final_error[key]) <= limit:
            faults.append(f"{key}: found {final_error[key]:.4g}, allowed +-{limit:g}")
    return Judgement(
        converged=converged, reason=reason, passed=not faults, faults=tuple(faults),
        duration_s=float((record.stamp_ns[last] - record.stamp_ns[first]) * 1e-9),
        final_error=final_error, initial_error=true_error(record, first),
        final_feature_error=dict(zip(record.feature_names, record.e[_last_finite(record.e, rows)].tolist())),
        gains_per_s=_promised_rates(record), limits=limits, images=len(rows), stopped_by_rule=stopped_by_rule,
        settled=settled)


def goal_pose(record: RunRecord, row: Any) -> np.ndarray:
    """X_WCg, (4, 4), at an image: the camera's taught pose relative to the target, for the target's pose at that
    image. Of several taught images it is the mean."""
    X_WCg = record.taught_pose
    if record.target_poses is None:
        return X_WCg
    then, now = record.target_poses[record.taught_row], record.target_poses[row]
    return X_WCg if np.array_equal(then, now) else now @ np.linalg.solve(then, X_WCg)


def true_error(record: RunRecord, row: Any) -> Dict[str, float]:
    """True error at an image, a dict as of `pose_error`.

    With the camera in the hand that of the camera against its goal, relative to the target. Eye-to-hand that of the
    target in the camera against the taught one: p_CT - p_CTg in the axes of the camera, and the angle of R_TgT.
    """
    if not record.eye_to_hand or record.target_poses is None:
        return pose_error(goal_pose(record, row), record.X_WC[row])
    here, *taught = (inverse(record.X_WC[at]) @ record.target_poses[at] for at in (row, *record.taught_rows))
    goal = mean_pose(np.array(taught))
    x_mm, y_mm, z_mm = (1e3 * (here[:3, 3] - goal[:3, 3])).tolist()
    return {"x_mm": x_mm, "y_mm": y_mm, "z_mm": z_mm,
            "angle_deg": math.degrees(rotation_angle(goal[:3, :3].T @ here[:3, :3]))}


def tracking(record: RunRecord) -> Dict[str, Any]:
    """How well a moving goal was followed: root mean squares over the second half of the servo images.

    They are e (a dict by feature), position_mm and angle_deg (of the true X_CgC, Cg moving with the target).
    """
    rows = record.servo_rows
    rows = rows[len(rows) // 2:-1]  # the last one is the stop
    errors = [true_error(record, row) for row in rows]
    squares = [[sum(error[axis]**2 for axis in ("x_mm", "y_mm", "z_mm")), error["angle_deg"]**2] for error in errors]
    position_mm, angle_deg = np.sqrt(np.mean(squares, axis=0)).tolist() if len(rows) else (math.nan, math.nan)
    e = np.sqrt(np.nanmean(np.square(record.e[rows]), axis=0)).tolist() if len(rows) else []
    return {"e": dict(zip(record.feature_names, e)), "position_mm": position_mm, "angle_deg": angle_deg}


def pose_error(X_WCg: np.ndarray, X_WC: np.ndarray) -> Dict[str, float]:
    """Error of a camera pose C against the goal Cg: x_mm, y_mm, z_mm of p_CgC in Cg, and angle_deg >= 0 of R_CgC."""
    X_CgC = np.linalg.solve(X_WCg, X_WC) if np.all(np.isfinite(X_WCg)) else np.full((4, 4), np.nan)
    x_mm, y_mm, z_mm = (1e3 * X_CgC[:3, 3]).tolist()
    return {"x_mm": x_mm, "y_mm": y_mm, "z_mm": z_mm, "angle_deg": math.degrees(rotation_angle(X_CgC[:3, :3]))}


def fit_decay(record: RunRecord) -> Dict[str, float]:
    """Fits the rates of the exponentials through |e|, by straight lines through ln |e| over the servo images [1/s].

    A bounded law or a saturated joint does not decay exponentially at first. So a line is fitted through the last
    images above the floor, as far back as ln |e| is straight within FIT_BENT of its range; where there is no such line,
    through those above the lower floor.

    Returns:
        dict feature name -> rate. NaN where fewer than FIT_MIN_ROWS images stand above the floor, or |e| falls by less
        than a factor of e on the straight part.
    """
    rows = record.servo_rows
    t_s, thresholds = record.t_s[rows], spread(record.settings.get("servo", {}).get("thresholds", {}))
    rates = {}
    for column, name in enumerate(record.feature_names):
        size = np.abs(record.e[rows, column])
        rates[name] = math.nan
        for share in FIT_FLOOR_SHARES:
            floor = max(share * np.nanmax(size, initial=0.0), FIT_FLOOR_THRESHOLDS * thresholds.get(name, 0.0))
            below = np.flatnonzero(~(size > floor))
            end = below[0] if len(below) else len(size)
            rates[name] = _rate_of_the_end(t_s[:end], np.log(size[:end]))
            if not math.isnan(rates[name]):
                break
    return rates


def _rate_of_the_end(t_s, log_size):
    for begin in range(len(t_s) - FIT_MIN_ROWS + 1):
        fall = log_size[begin] - log_size[-1]
        if fall < 1.0:
            break
        slope, offset = np.polyfit(t_s[begin:], log_size[begin:], 1)
        if np.abs(slope * t_s[begin:] + offset - log_size[begin:]).max() < FIT_BENT[begin > 0] * fall:
            return float(-slope)
    return math.nan


def _promised_rates(record):
    servo = record.settings.get("servo", {})
    if servo.get("mode") != "continuous" or servo.get("law") != "decoupled":
        return {}
    return {name: float(servo["gains_per_s"][name]) for name in FEATURE_NAMES if name in servo["gains_per_s"]}


def _last_finite(e, rows):
    finite = rows[np.isfinite(e[rows]).all(axis=1)]
    return finite[-1] if len(finite) else rows[-1]
