"""Measures of the camera's path in a run, beside its final error, and the path itself, for figures.

All are taken over the servo phase, from the true camera poses and the measured joint positions of a RunRecord.
"""

from dataclasses import dataclass, field
from math import degrees, inf
from typing import Any, Dict, Optional

import numpy as np

from .record import RunRecord
from ..features.target.outline import Outline
from ..spatial import inverse, rotation_angle

#: Columns of a sweep with their descriptions.
MEASURES = {
    "path_mm": "length of the path of the camera, or eye-to-hand of the target [mm]",
    "detour_mm": "its largest distance from the straight line between start and goal [mm]",
    "farthest_mm": "its largest distance from the goal [mm]",
    "joint_room": "least distance of any joint from a limit, in halves of its range: 1 in the middle, 0 at the limit",
    "border_px": "least distance of the target's outline from the image border, negative where it is cut [px]",
}


def measures(record: RunRecord, lower: Any, upper: Any,
             outline: Optional[Outline] = None) -> Dict[str, Optional[float]]:
    """Dict of MEASURES; None where a value is unknown.

    Args:
        record: RunRecord with a taught view and servo rows.  lower, upper: limits of its joints, in their order.
        outline: `Outline` of its target, or None.
    """
    rows, found = record.servo_rows, dict.fromkeys(MEASURES)
    X_WMg, X_WM = record.X_WM[record.taught_row], record.X_WM[rows]
    if np.isfinite(X_WM).all() and np.isfinite(X_WMg).all():
        p, goal = 1e3 * X_WM[:, :3, 3], 1e3 * X_WMg[:3, 3]
        found["path_mm"] = float(np.linalg.norm(np.diff(p, axis=0), axis=1).sum())
        found["detour_mm"] = float(distance_from_segment(p, p[0], goal).max())
        found["farthest_mm"] = float(np.linalg.norm(p - goal, axis=1).max())
        if outline is not None:
            border_px = outline.border_px(record.X_WC[rows], X_WM if record.eye_to_hand else None)
            found["border_px"] = border_px if border_px > -inf else None
    lower, upper = np.asarray(lower, dtype=float), np.asarray(upper, dtype=float)
    limited, q = np.isfinite(lower) & np.isfinite(upper), record.q[rows]
    q = q[np.isfinite(q).all(axis=1)]
    if limited.any() and len(q):
        room = np.minimum(q - lower, upper - q)[:, limited] / (0.5 * (upper - lower)[limited])
        found["joint_room"] = float(room.min())
    return found


def distance_from_segment(points: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(n,) distances of points (n, 3) from the straight line between a and b, (3,) each."""
    way = b - a
    length2 = float(way @ way)
    part = np.clip((points - a) @ way / length2, 0.0, 1.0) if length2 > 0.0 else np.zeros(len(points))
    return np.linalg.norm(points - (a + part[:, None] * way), axis=1)


@dataclass
class Track:
    """Curves of a run's servo phase for a figure, (n,) each.

    Attributes:
        t_s: time since its first image.  distance_mm, angle_deg: of the camera from the goal, as a
            target at rest sees it.
        retreat_mm: how far the camera is behind the goal along the goal's optical axis, away from the target.
        u_px, v_px: middle of the target's outline in the image.
    """

    t_s: list
    distance_mm: list
    angle_deg: list
    retreat_mm: list
    u_px: list = field(default_factory=list)
    v_px: list = field(default_factory=list)


def track_of(record: RunRecord, outline: Optional[Outline] = None) -> Track:
    """`Track` of a RunRecord with a taught view and servo rows."""
    rows = record.servo_rows
    taught = record.rows("teach")[-1]
    X_WC = record.X_WC if not record.eye_to_hand else inverse(record.X_WM) @ record.X_WC  # from a target at rest
    X_CgC = np.linalg.inv(X_WC[taught]) @ X_WC[rows]
    p = 1e3 * X_CgC[:, :3, 3]
    track = Track((record.t_s[rows] - record.t_s[rows[0]]).tolist(), np.linalg.norm(p, axis=1).tolist(),
                  [degrees(rotation_angle(X[:3, :3])) for X in X_CgC], (-p[:, 2]).tolist())
    if outline is not None:
        pixels = [outline.pixels(record.X_WC[row], record.X_WM[row] if record.eye_to_hand else None) for row in rows]
        middle = [(np.nan, np.nan) if p is None else 0.5 * (p.min(axis=0) + p.max(axis=0)) for p in pixels]
        track.u_px, track.v_px = np.transpose(middle).tolist()
    return track
