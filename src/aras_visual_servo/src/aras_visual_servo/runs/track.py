"""The way of a run to its goal, for figures: true distance, angle, retreat, and the target's way through the image."""

from dataclasses import dataclass, field
from math import degrees

import numpy as np

from ..spatial import inverse, rotation_angle


@dataclass
class Track:
    """What a figure shows of a run's servo phase, (n,) each.

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


def track_of(record, outline=None):
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
