"""What a user can do next, by the way a servo has ended or by what holds it back: the one table of the live page.

    kind, text = advice(Moment(status, text, ...))

The first row of `TABLE` counts whose status and pattern fit. Its text may name what the pattern has found, and what a
function of `FACTS` finds in the run.
"""

import re
from dataclasses import dataclass
from typing import Callable, Dict, NamedTuple, Optional, Tuple

import numpy as np

from aras_visual_servo import RobotKinematics, Status, least_singular_value, spatial

#: How far a joint is turned to see whether it leads out of a singularity [rad or m].
TRIED = 0.1
#: Length that makes translations and rotations of the camera comparable [m].
LENGTH_M = 0.3
#: An image is divided into thirds to say where the target was seen last.
SIDES = ("left", "", "right"), ("top", "", "bottom")
#: A target that is nearer to where it was when the goal was taught has not moved [m, rad].
MOVED_M, MOVED_RAD = 0.002, 0.02
#: A part of the way that is smaller than this part of it is not told.
TOLD = 0.4


class Seen(NamedTuple):
    """Where the target was seen last: u, v [px]."""

    u: float
    v: float


@dataclass(frozen=True)
class Moment:
    """What advice is given on.

    Attributes: status, text, phase: of the record.  q: (n,) joint positions.  size: (width, height) of the image [px].
        seen: where the target was seen last, or None.
        away_C: (4, 4) motion that brings the target back to where it was taught, in the camera's frame; None: unknown.
        swings: whether the camera swings, or swung when the servo ended.
    """

    status: Status
    text: str
    phase: str
    kinematics: RobotKinematics
    q: np.ndarray
    size: Tuple[int, int]
    seen: Optional[Seen] = None
    away_C: Optional[np.ndarray] = None
    swings: bool = False


def _last_seen(moment: Moment) -> str:
    if moment.seen is None:
        return "It was not seen since the goal was taught"
    u, v = moment.seen
    across, down = (names[min(2, max(0, int(3 * at / most)))] for names, at, most in zip(SIDES, (u, v), moment.size))
    where = " ".join(filter(None, (down, across))) or "middle"
    return f"It was last seen at the {where} of the image (pixel {u:.0f}, {v:.0f})"


def _way_out(moment: Moment) -> str:
    """The joint that leads out of a singularity when it is bent, and the direction, in words."""
    kinematics = moment.kinematics
    best = 0.0, "", 0.0
    for i, name in enumerate(kinematics.joint_names):
        for step in (TRIED, -TRIED):
            q = np.array(moment.q, dtype=float)
            q[i] += step
            if kinematics.lower[i] <= q[i] <= kinematics.upper[i]:
                best = max(best, (least_singular_value(kinematics, q, LENGTH_M), name, step))
    return f"{best[1]} in its {'positive' if best[2] > 0.0 else 'negative'} direction"


def _way_back(moment: Moment) -> str:
    """What brings the target back to where the arm could servo to it, in words: a drag on its plane, or a turn."""
    X = moment.away_C
    if X is None:
        return "Drag the target to where its plane is green"
    across, down = X[0, 3], X[1, 3]
    most = float(np.linalg.norm(X[:3, 3]))
    if most > MOVED_M:
        ways = (across, "to the right" if across > 0.0 else "to the left"), (down, "down" if down > 0.0 else "up")
        words = [name for way, name in ways if abs(way) > TOLD * most]
        where = f" {' and '.join(words)} in the camera's image" if words else ""
        return f"Drag the target back{where}, to where its plane is green"
    if spatial.rotation_angle(X[:3, :3]) > MOVED_RAD:
        return "Turn the target back by its ring"
    return "Drag the target to where its plane is green"


def limit_joint(status: Status, text: str) -> str:
    """Returns the joint that a reason names as held back by its limit, "" where it names none."""
    found = re.search(AT_LIMIT, text)
    if found is None and status == Status.JOINT_LIMIT:
        found = re.search(JOINT, text)
    if found is None:
        return ""
    words = found.groupdict()
    first = words["joint"] or words["joints"].partition(", ")[0].strip()
    named = re.search(JOINT, first)
    return first if named is None else named["joint"]


#: Name in a text of the table -> function that finds it in the run.
FACTS: Dict[str, Callable[[Moment], str]] = {
    "last_seen": _last_seen, "way_out": _way_out, "way_back": _way_back}

JOINT = r"joint '(?P<joint>[^']+)'"
AT_LIMIT = rf"{JOINT} at its limit|at their limits, the others go on: (?P<joints>[^;)]+)"
ENDS = (Status.TIMED_OUT, Status.STOPPED)
SWINGS = "the camera swings; "
HELD = (Status.OUT_OF_REACH, Status.JOINT_LIMIT, Status.NEAR_SINGULARITY, Status.SERVOING)

#: (kind, statuses, pattern of the text, what to do now). The text of a camera that swings begins with SWINGS.
TABLE: Tuple[Tuple[str, Tuple[Status, ...], str, str], ...] = (
    ("swings", (*HELD, *ENDS, Status.TARGET_LOST), f"^{SWINGS}",
     "The camera oscillates: lower the gains or the latency, then press Again to compare."),
    ("out_of_reach", (*HELD, *ENDS), r"would have to go on|cannot go on",
     "{way_back}: the arm goes on as soon as it can reach it."),
    ("chatters", (*HELD, *ENDS), rf"{JOINT} chatters",
     "{joint} reverses because the arm is close to a singularity: drag the target nearer, bend {way_out}, or raise "
     "servo.inverse.damping."),
    ("joint_limit", (*HELD, *ENDS), AT_LIMIT,
     "{joint} is at its limit: drag the target to where {joint} can turn back, or stop and move {joint} by hand, or "
     "start from another posture."),
    ("singular", (*HELD, *ENDS), r"part of the twist cannot be achieved",
     "The arm is singular here: drag the target nearer, or stop and bend {way_out}."),
    ("lost_target_ended", (Status.STOPPED,), r"target lost",
     "{last_seen}. Drag it back below the camera and press \u201cServo from here\u201d, or press Again."),
    ("lost_target_at_start", (Status.TARGET_LOST,), r"at the start|where servoing starts|at the goal",
     "{last_seen}. Drag it below the camera and press \u201cServo from here\u201d, or press Run all."),
    ("lost_target", (Status.TARGET_LOST,), "", "{last_seen}. Drag it back below the camera: the servo goes on."),
    ("lost_in_time_limit", (Status.TIMED_OUT,), r"target (?:not in view|cut|lost)",
     "{last_seen}. The target left the image: lower the gains or the latency, or drag it back below the camera."),
    ("stale_in_time_limit", (Status.TIMED_OUT,), r"no features|no image",
     "No images arrive: look at latency and lost frames under \u201cNoise, latency, exposure, light\u201d."),
    ("not_held", (Status.TIMED_OUT,), r"everything for less than hold_s",
     "The error was below its thresholds only at times: lower the gains or the noise, or raise the thresholds."),
    ("timed_out", (Status.TIMED_OUT,), "",
     "The error has not gone below its thresholds in time: watch whether it still falls (raise the gains or "
     "servo.time_limit_s), stays (raise the thresholds) or swings (lower the gains or the latency)."),
    ("stopped", (Status.STOPPED,), "",
     "\u201cServo from here\u201d continues to the taught goal; Run all restarts the experiment."),
    ("stale", (Status.STALE_INPUT,), "",
     "The arm waits for an image: look at latency and lost frames under \u201cNoise, latency, exposure, light\u201d."),
    ("held_at_end", (Status.FAULT,), JOINT, "Drive {joint} free by hand, or press Reset."),
    ("fault", (Status.FAULT,), "", "Fix the named cause, then press Again or Reset."),
    ("converged", (Status.CONVERGED, Status.STOPPED_BY_RULE), "",
     "Drag the target and watch the servo follow, or change a gain and press Again to compare."),
    ("settled", (Status.SETTLED,), "",
     "These features cannot show more: use more pixels or samples, or features that see the remaining motion."),
    ("moved", (Status.IDLE,), r"^the last servo: ",
     "\u201cServo from here\u201d servoes to the last taught goal; Again drives to the start first."),
    ("idle", (Status.IDLE,), "", "Run all drives to the goal, teaches it, drives to the start and servoes."),
)
_PATTERNS = [re.compile(pattern) for _, _, pattern, _ in TABLE]


def advice(moment: Moment) -> Tuple[str, str]:
    """Returns (kind, what to do now) for a moment of a run; ("", "") while it goes on as it should."""
    if moment.phase not in ("servo", "done", "idle"):
        return "", ""
    told = (SWINGS if moment.swings else "") + moment.text
    for (kind, statuses, _, text), pattern in zip(TABLE, _PATTERNS):
        found = pattern.search(told) if moment.status in statuses else None
        if found is None:
            continue
        words = {key: value for key, value in found.groupdict().items() if value}
        if "joints" in words:
            words["joint"] = limit_joint(moment.status, moment.text)
        words.update({name: fact(moment) for name, fact in FACTS.items() if "{" + name + "}" in text})
        return kind, text.format(**words)
    return "", ""
