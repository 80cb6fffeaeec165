"""Motions in files, as trajectory_msgs/JointTrajectory, and the splines of ros_controllers through their points."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Dict, List, Sequence, Tuple, Union

import numpy as np
import yaml
from scipy.interpolate import BPoly

from aras_visual_servo import ParameterError


def spline(times_s: np.ndarray, knots: np.ndarray) -> BPoly:
    """Returns the polynomials through the points of a trajectory, time -> (m,).

    They are of order 1, 3 or 5, as the points have positions alone, velocities or accelerations, too.

    Args: times_s: (n,) increasing, n > 1.  knots: (n, 1, 2 or 3, m) positions and their derivatives.
    """
    return BPoly.from_derivatives(times_s, knots)


def from_rest(here: Union[Sequence[float], np.ndarray], times_s: np.ndarray, knots: np.ndarray
              ) -> Tuple[np.ndarray, np.ndarray]:
    """Returns the points (times_s, knots) of a trajectory after one at rest at `here`, (m,), at time 0."""
    rest = np.zeros_like(knots[:1])
    rest[0, 0] = here
    return np.r_[0.0, times_s], np.vstack([rest, knots])


@dataclass(frozen=True)
class JointMotion:
    """Attributes:
        joint_names: m names.  times_s: (n,) of the points, from the beginning of the motion.
        knots: (n, 1 or 2, m) positions, and velocities if the file has them [m, rad; per s].
    """

    joint_names: Tuple[str, ...]
    times_s: np.ndarray
    knots: np.ndarray

    def way(self, here: np.ndarray) -> BPoly:
        """Returns the set points, time -> (m,), of a motion that begins at rest at `here` (m,)."""
        return spline(*from_rest(here, self.times_s, self.knots))


def read_motion(path: Path) -> JointMotion:
    """Reads what `trajectory_yaml` writes. Raises ParameterError: no such file, with every fault found."""
    try:
        content = yaml.safe_load(path.read_text(encoding="utf-8"))
        points: List[Dict[str, Any]] = content["points"]
        names = tuple(map(str, content["joint_names"]))
        times = np.array([point["time_from_start"]["secs"] + 1e-9 * point["time_from_start"]["nsecs"]
                          for point in points])
        keys = [key for key in ("positions", "velocities") if all(point.get(key) for point in points)]
        knots = np.array([[point[key] for key in keys] for point in points], dtype=float)
    except (OSError, UnicodeDecodeError, yaml.YAMLError, KeyError, TypeError, ValueError) as error:
        raise ParameterError(f"motion '{path}': found {type(error).__name__}: {error}, allowed a "
                             "trajectory_msgs/JointTrajectory in YAML") from None
    faults = []
    if not len(points) or knots.shape[2:] != (len(names),):
        faults.append(f"motion '{path}': points: found {len(points)} with numbers of shape {knots.shape[1:]}, allowed "
                      f"one or more with a position for each of {', '.join(names) or 'one or more joints'}")
    elif not np.all(np.isfinite(knots)):
        faults.append(f"motion '{path}': points: found numbers that are not finite, allowed finite ones")
    if len(times) and not np.all(np.diff(np.r_[0.0, times]) > 0.0):
        faults.append(f"motion '{path}': time_from_start: found {times.tolist()[:5]} ..., allowed increasing times "
                      "above 0")
    if faults:
        raise ParameterError(faults)
    return JointMotion(names, times, knots)
