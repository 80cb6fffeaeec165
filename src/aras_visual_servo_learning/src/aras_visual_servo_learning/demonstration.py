"""One run as a demonstration: what was seen, what was done, what it was worth; one row per image but the last."""

from typing import Any, Dict, Optional

import numpy as np

from aras_visual_servo import RunRecord, Status, goal_pose, spatial

from .reward import ARRIVED, LENGTH_M


def demonstration(record: RunRecord, images: bool = False) -> Optional[Dict[str, Any]]:
    """Arrays of the servo phase of a record, n rows.

    Returns:
        dict: `obs` and `next_obs`, each a dict of joint_positions (n, m), camera_pose (n, 6) in the frame of the goal
        camera (position [m], rotation vector [rad]), features (n, k), feature_errors (n, k) and, with images, image
        (n, h, w, 3) uint8; `actions` (n, 6), the twist V_C [v; w] that was commanded; `rewards` (n,), those of
        `PoseReward`; `dones` (n,), 1 in the last row. None if the servo phase has fewer than two images.
    """
    rows = record.servo_rows
    if images:
        rows = np.array([row for row in rows if row in record.images], dtype=int)
    if len(rows) < 2:
        return None
    poses = np.array([_pose(np.linalg.solve(goal_pose(record, row), record.X_WC[row])) for row in rows])
    seen = {"joint_positions": record.q[rows], "camera_pose": poses, "features": record.s[rows],
            "feature_errors": record.e[rows]}
    if images:
        seen["image"] = np.array([record.images[row] for row in rows])
    arrived = record.status[rows[-1]] == Status.CONVERGED
    rewards = -np.linalg.norm(poses[1:, :3], axis=1) - LENGTH_M * np.linalg.norm(poses[1:, 3:], axis=1)
    rewards[-1] += ARRIVED * arrived
    dones = np.zeros(len(rows) - 1, dtype=np.int64)
    dones[-1] = 1
    return {"obs": {name: values[:-1] for name, values in seen.items()},
            "next_obs": {name: values[1:] for name, values in seen.items()},
            "actions": np.nan_to_num(record.twist[rows][:-1]), "rewards": rewards, "dones": dones}


def _pose(X):
    return np.concatenate((X[:3, 3], spatial.rotation_vector(X[:3, :3])))
