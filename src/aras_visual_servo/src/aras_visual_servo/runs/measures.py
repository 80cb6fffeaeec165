"""Measures of the camera's path in a run, beside its final error. They describe how a law moves. Needs numpy only.

All are taken over the servo phase, from the true camera poses and the measured joint positions of a RunRecord.
"""

from math import inf

import numpy as np

#: Columns of a sweep, and what they are.
MEASURES = {
    "path_mm": "length of the path of what the arm carries, camera or target [mm]",
    "detour_mm": "its largest distance from the straight line between start and goal [mm]",
    "farthest_mm": "its largest distance from the goal [mm]",
    "joint_room": "least distance of any joint from a limit, in halves of its range: 1 in the middle, 0 at the limit",
    "border_px": "least distance of the target's outline from the image border, negative where it is cut [px]",
}


def measures(record, lower, upper, outline=None):
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


def distance_from_segment(points, a, b):
    """(n,) distances of points (n, 3) from the straight line between a and b, (3,) each."""
    way = b - a
    length2 = float(way @ way)
    part = np.clip((points - a) @ way / length2, 0.0, 1.0) if length2 > 0.0 else np.zeros(len(points))
    return np.linalg.norm(points - (a + part[:, None] * way), axis=1)
