"""Inverse kinematics: joint positions that give the camera a wanted pose, by damped least squares. No ROS."""

from typing import Dict, Mapping, Optional, Tuple

import numpy as np

from .kinematics import RobotKinematics
from ..spatial import rotation_vector
from .free_camera import FreeCamera

#: A camera pose counts as reached within this distance and angle: a tenth of the limits of a sweep's `strict`.
REACHED_M, REACHED_RAD = 1e-4, 5e-4
IK_STEPS, IK_DAMPING, IK_MAX_STEP = 60, 1e-2, 0.3
#: Other postures tried, and how far they are from the near one [m, rad].
IK_GUESSES, IK_SPREAD = 6, 0.8


def reach(kinematics: RobotKinematics, near: np.ndarray, X_BC: np.ndarray) -> Tuple[Optional[Dict[str, float]], str]:
    """Joints at which the camera has a pose.

    Args:
        near: (n,) joint positions to begin with.  X_BC: (4, 4) pose wanted.
    Returns:
        (joints by name, "") or (None, why not). The search begins at `near`, then at IK_GUESSES other postures, which
        are the same in every call; a solution within the joint limits is preferred. A free camera needs no search.
    """
    if isinstance(kinematics, FreeCamera):
        return kinematics.by_name(kinematics.coordinates(X_BC)), ""
    rng, found, missing = np.random.default_rng(0), None, None
    for guess in range(1 + IK_GUESSES):
        q = near if guess == 0 else near + rng.uniform(-IK_SPREAD, IK_SPREAD, len(near))
        q, error = _solve(kinematics, X_BC, q)
        if np.linalg.norm(error[:3]) < REACHED_M and np.linalg.norm(error[3:]) < REACHED_RAD:
            found = kinematics.by_name(q) if found is None else found
            if not outside_limits(kinematics, kinematics.by_name(q)):
                return kinematics.by_name(q), ""
        elif missing is None or np.linalg.norm(error) < np.linalg.norm(missing):
            missing = error
    if found is not None:
        return found, ""
    return None, (f"camera pose out of reach: {1e3 * np.linalg.norm(missing[:3]):.3g} mm and "
                  f"{np.degrees(np.linalg.norm(missing[3:])):.3g} deg are missing")


def outside_limits(kinematics: RobotKinematics, joints: Mapping[str, float]) -> str:
    """Text "outside joint limits: ..." that names every such joint; "" if there is none."""
    faults = [f"{name} {joints[name]:.4g} not in [{lower:.4g}, {upper:.4g}]"
              for name, lower, upper in zip(kinematics.joint_names, kinematics.lower, kinematics.upper)
              if not lower <= joints[name] <= upper]
    return f"outside joint limits: {', '.join(faults)}" if faults else ""


def _solve(kinematics, X_BC, q):
    """Returns (joints, remaining error (6,) in C) of damped least squares from q."""
    for _ in range(IK_STEPS):
        X = kinematics.pose(q)
        error = np.concatenate([X[:3, :3].T @ (X_BC[:3, 3] - X[:3, 3]), rotation_vector(X[:3, :3].T @ X_BC[:3, :3])])
        if np.linalg.norm(error[:3]) < REACHED_M and np.linalg.norm(error[3:]) < REACHED_RAD:
            break
        J = kinematics.jacobian(q)
        step = J.T @ np.linalg.solve(J @ J.T + IK_DAMPING ** 2 * np.eye(6), error)
        q = q + step * min(1.0, IK_MAX_STEP / max(float(np.abs(step).max()), 1e-12))
    return q, error
