"""Poses as (position (3,), quaternion (4,) x y z w), and as matrices (4, 4)."""
import typing

import numpy

from aras_visual_servo_sim import ParameterError


IDENTITY = numpy.eye(4)


def matrix_of(position: typing.Sequence[float], quaternion: typing.Sequence[float], what: str) -> numpy.ndarray:
    """X, (4, 4). A quaternion of zeros is none at all, as Gazebo has it.

    Raises: ParameterError: a number that is not finite.
    """
    place, turn = numpy.asarray(position, float), numpy.asarray(quaternion, float)
    if not (numpy.isfinite(place).all() and numpy.isfinite(turn).all()):
        raise ParameterError("%s: found a number that is not finite, allowed are finite numbers" % what)
    norm = numpy.linalg.norm(turn)
    pose = numpy.eye(4)
    pose[:3, 3] = place
    if norm > 0.0:
        x, y, z, w = turn / norm
        pose[:3, :3] = ((1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
                        (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
                        (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)))
    return pose


def matrix_of_rpy(position: typing.Sequence[float], rpy: typing.Sequence[float]) -> numpy.ndarray:
    """X, (4, 4), of a position (3,) and roll, pitch, yaw [rad]: R = Rz(yaw) Ry(pitch) Rx(roll)."""
    angles = numpy.asarray(rpy, float)
    (cr, cp, cy), (sr, sp, sy) = numpy.cos(angles), numpy.sin(angles)
    pose = numpy.eye(4)
    pose[:3, :3] = ((cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr),
                    (sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr), (-sp, cp * sr, cp * cr))
    pose[:3, 3] = position
    return pose


def quaternion_of(pose: numpy.ndarray) -> numpy.ndarray:
    """(4,) x y z w of a pose (4, 4), by the largest of its parts (Shepperd 1978)."""
    R = pose[:3, :3]
    trace = R[0, 0] + R[1, 1] + R[2, 2]
    parts = numpy.array((R[0, 0], R[1, 1], R[2, 2], trace))
    k = int(parts.argmax())
    if k == 3:
        q = numpy.array((R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1], 1.0 + trace))
    else:
        i, j = (k + 1) % 3, (k + 2) % 3
        q = numpy.empty(4)
        q[k] = 1.0 + R[k, k] - R[i, i] - R[j, j]
        q[i] = R[i, k] + R[k, i]
        q[j] = R[j, k] + R[k, j]
        q[3] = R[j, i] - R[i, j]
    return q / numpy.linalg.norm(q)


def rpy_of(pose: numpy.ndarray) -> typing.Tuple[float, float, float]:
    """Roll, pitch, yaw of a pose, R = Rz(yaw) Ry(pitch) Rx(roll)."""
    R = pose[:3, :3]
    pitch = numpy.arctan2(-R[2, 0], numpy.hypot(R[0, 0], R[1, 0]))
    if abs(R[2, 0]) > 1.0 - 1e-12:  # roll and yaw turn about the same axis: yaw is taken as 0
        return numpy.arctan2(-R[1, 2], R[1, 1]), pitch, 0.0
    return numpy.arctan2(R[2, 1], R[2, 2]), pitch, numpy.arctan2(R[1, 0], R[0, 0])


def rotated(pose: numpy.ndarray, twist: numpy.ndarray) -> numpy.ndarray:
    """A twist [v; w] in the axes of a pose, in world axes."""
    return numpy.concatenate((pose[:3, :3] @ twist[:3], pose[:3, :3] @ twist[3:]))
