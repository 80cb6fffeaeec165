"""Measures of the camera's path in a run, beside its final error. They describe how a law moves. Needs numpy only.

All are taken over the servo phase, from the true camera poses and the measured joint positions of a RunRecord.
"""

from math import inf

import numpy as np

from .judge import taught_pose

#: Columns of a sweep, and what they are.
MEASURES = {
    "path_mm": "length of the camera's path [mm]",
    "detour_mm": "largest distance of the camera from the straight line between start and goal [mm]",
    "farthest_mm": "largest distance of the camera from the goal [mm]",
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
    X_WCg, X_WC = taught_pose(record), record.X_WC[rows]
    if np.isfinite(X_WC).all() and np.isfinite(X_WCg).all():
        p, goal = 1e3 * X_WC[:, :3, 3], 1e3 * X_WCg[:3, 3]
        found["path_mm"] = float(np.linalg.norm(np.diff(p, axis=0), axis=1).sum())
        found["detour_mm"] = float(distance_from_segment(p, p[0], goal).max())
        found["farthest_mm"] = float(np.linalg.norm(p - goal, axis=1).max())
        if outline is not None:
            border_px = outline.border_px(X_WC)
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
