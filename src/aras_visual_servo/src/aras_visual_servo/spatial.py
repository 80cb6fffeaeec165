"""Rotations and poses: matrices, rotation vectors, quaternions, roll-pitch-yaw angles. No other module computes them.

A pose X_AB is a 4 x 4 homogeneous matrix, a twist is stacked [v; w], a rotation vector is theta u [rad]. The functions
that a servo calls at every image are written out for speed, and those that every run needs, because scipy takes a tenth
of a second to import; the others are scipy's.
"""

from math import asin, atan2, cos, sin, sqrt
from typing import Any, Sequence, Tuple, Union

import numpy as np

_EYE = np.eye(4)
#: (3, 9): v @ _SKEW are the rows of [v]x, one after another.
_SKEW = np.array([[0, 0, 0, 0, 0, -1, 0, 1, 0], [0, 0, 1, 0, 0, 0, -1, 0, 0], [0, -1, 0, 1, 0, 0, 0, 0, 0]], float)
#: Below this angle third-order terms of the series are smaller than rounding errors [rad].
_SMALL_RAD = 1e-5
#: Below this cosine the sine of the angle is too small to find the axis from it, so the quaternion is used [-].
_NEAR_HALF_TURN = -0.9


def exponential(twist: np.ndarray) -> np.ndarray:
    """Pose after a body twist was held for one second.

    Args: twist: (6,) array, [v; w] in the moving frame [m/s, rad/s].
    Returns: (4, 4).
    """
    v, w = twist[:3], twist[3:]
    angle = float(w @ w) ** 0.5
    W = skew(w.tolist())
    if angle < _SMALL_RAD:
        A, B, C = 1.0, 0.5, 1.0 / 6.0
    else:
        A, B, C = sin(angle) / angle, (1.0 - cos(angle)) / angle**2, (angle - sin(angle)) / angle**3
    WW = W @ W
    X = _EYE.copy()
    X[:3, :3] += A * W + B * WW
    X[:3, 3] = v + B * (W @ v) + C * (WW @ v)
    return X


def exponentials(twists: np.ndarray) -> np.ndarray:
    """`exponential` of each of N twists, (N, 6): (N, 4, 4)."""
    v, w = twists[:, :3, None], twists[:, 3:]
    angle = np.sqrt(np.einsum("ij,ij->i", w, w))[:, None, None]
    turns, safe = angle >= _SMALL_RAD, np.maximum(angle, _SMALL_RAD)
    A, B, C = np.sin(safe) / safe, (1.0 - np.cos(safe)) / safe**2, (safe - np.sin(safe)) / safe**3
    A, B, C = np.where(turns, A, 1.0), np.where(turns, B, 0.5), np.where(turns, C, 1.0 / 6.0)
    W = (w @ _SKEW).reshape(-1, 3, 3)
    WW = W @ W
    X = np.zeros((len(twists), 4, 4))
    X[:, :3, :3] = np.eye(3) + A * W + B * WW
    X[:, :3, 3:] = v + B * (W @ v) + C * (WW @ v)
    X[:, 3, 3] = 1.0
    return X


def logarithm(X: np.ndarray) -> np.ndarray:
    """Twist, (6,), [v; w], of which a pose, (4, 4), is the `exponential`; its turn is at most pi [m, rad]."""
    w = rotation_vector(X[:3, :3])
    p, square = X[:3, 3], float(w @ w)
    angle = square**0.5
    if angle < _SMALL_RAD:
        D = 1.0 / 12.0
    else:
        D = (1.0 - 0.5 * angle * cos(0.5 * angle) / sin(0.5 * angle)) / square
    wp = np.cross(w, p)
    return np.concatenate([p - 0.5 * wp + D * np.cross(w, wp), w])


def inverse(X: np.ndarray) -> np.ndarray:
    """Inverse of a pose, (4, 4), or of each of a stack of poses, (..., 4, 4)."""
    result = np.empty_like(X, dtype=float)
    result[...] = _EYE
    result[..., :3, :3] = X[..., :3, :3].swapaxes(-1, -2)
    result[..., :3, 3] = -(X[..., None, :3, 3] @ X[..., :3, :3])[..., 0, :]
    return result


def transform(R: np.ndarray, p: Union[np.ndarray, Sequence[float]]) -> np.ndarray:
    """Returns the pose (4, 4) of a rotation (3, 3) and a position (3,)."""
    X = np.eye(4)
    X[:3, :3], X[:3, 3] = R, p
    return X


def size_of(X: np.ndarray) -> Tuple[float, float]:
    """How far a pose, (4, 4), is from the identity: (distance [m], angle [rad])."""
    return float(np.linalg.norm(X[:3, 3])), rotation_angle(X[:3, :3])


def mean_pose(poses: np.ndarray) -> np.ndarray:
    """The mean, (4, 4), of poses that are close to each other, (N, 4, 4); NaN where one of them has NaN."""
    if not np.isfinite(poses).all():
        return np.full((4, 4), np.nan)
    if (poses == poses[0]).all():
        return poses[0]
    U, _, Vt = np.linalg.svd(poses[:, :3, :3].mean(axis=0))
    return transform(U @ Vt, poses[:, :3, 3].mean(axis=0))


def skew(vector: Any) -> np.ndarray:
    """[v]x, (3, 3), of a vector, (3,): [v]x w is the cross product v x w."""
    x, y, z = vector
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def adjoint(X: np.ndarray) -> np.ndarray:
    """(6, 6): a twist [v; w] in the frame that has the pose X, (4, 4), as a twist in the frame that X is given in."""
    R = X[:3, :3]
    return np.block([[R, skew(X[:3, 3]) @ R], [np.zeros((3, 3)), R]])


def adjoints(X: np.ndarray) -> np.ndarray:
    """`adjoint` of each of N poses, (N, 4, 4): (N, 6, 6)."""
    R, turned = X[:, :3, :3], np.zeros((len(X), 6, 6))
    turned[:, :3, :3] = turned[:, 3:, 3:] = R
    turned[:, :3, 3:] = (X[:, :3, 3] @ _SKEW).reshape(-1, 3, 3) @ R
    return turned


def rotation(vector: Sequence[float]) -> np.ndarray:
    """Rotation matrix, (3, 3), of a rotation vector, (3,) [rad] (Rodrigues)."""
    x, y, z = np.asarray(vector, dtype=float).tolist()
    angle = (x * x + y * y + z * z) ** 0.5
    a, b = (sin(angle) / angle, (1.0 - cos(angle)) / angle**2) if angle > _SMALL_RAD else (1.0, 0.5)
    return np.array([
        [1.0 - b * (y * y + z * z), b * x * y - a * z, b * x * z + a * y],
        [b * x * y + a * z, 1.0 - b * (x * x + z * z), b * y * z - a * x],
        [b * x * z - a * y, b * y * z + a * x, 1.0 - b * (x * x + y * y)],
    ])  # fmt: skip


def rotation_vector(R: np.ndarray) -> np.ndarray:
    """Rotation vector, (3,) [rad], of a rotation matrix; its length is in [0, pi].

    Exact to rounding at every angle: at small ones the antisymmetric part of R is the vector itself, near half a turn
    the axis is taken from the quaternion. Of the two vectors of exactly half a turn one is returned.
    """
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = R.tolist()
    cosine = 0.5 * (xx + yy + zz - 1.0)
    if cosine < _NEAR_HALF_TURN:
        return _scipy_rotation().from_matrix(R).as_rotvec()
    sine = 0.5 * np.array([zy - yz, xz - zx, yx - xy])
    size = float(sine @ sine) ** 0.5
    return sine if size < 1e-9 else sine * (atan2(size, cosine) / size)


def rotation_angle(R: np.ndarray) -> float:
    """Angle of a rotation matrix, in [0, pi] [rad]; NaN for a matrix with NaN.

    It is computed from sine and cosine, because the arc cosine of the trace loses half the digits near zero.
    """
    sine = 0.5 * ((R[2, 1] - R[1, 2]) ** 2 + (R[0, 2] - R[2, 0]) ** 2 + (R[1, 0] - R[0, 1]) ** 2) ** 0.5
    return atan2(sine, 0.5 * (np.trace(R) - 1.0))


def rotation_rpy(rpy_rad: Sequence[float]) -> np.ndarray:
    """Rotation matrix of fixed-axis roll, pitch, yaw, as in URDF: Rz(yaw) Ry(pitch) Rx(roll).

    By way of the quaternion, as scipy does, to the last bit.
    """
    roll, pitch, yaw = [0.5 * float(angle) for angle in rpy_rad]
    q = _quaternion_product((0.0, sin(pitch), 0.0, cos(pitch)), (sin(roll), 0.0, 0.0, cos(roll)))
    x, y, z, w = _quaternion_product((0.0, 0.0, sin(yaw), cos(yaw)), q)
    xx, yy, zz, ww = x * x, y * y, z * z, w * w
    return np.array([[xx - yy - zz + ww, 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
                     [2.0 * (x * y + z * w), -xx + yy - zz + ww, 2.0 * (y * z - x * w)],
                     [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), -xx - yy + zz + ww]])


def rpy_of(R: np.ndarray) -> Tuple[float, float, float]:
    """Roll, pitch and yaw of a rotation matrix, floats [rad]: the inverse of `rotation_rpy`."""
    pitch = asin(max(-1.0, min(1.0, -R[2, 0])))
    roll, yaw = atan2(R[2, 1], R[2, 2]), atan2(R[1, 0], R[0, 0])
    if not np.allclose(rotation_rpy([roll, pitch, yaw]), R, atol=1e-6):  # straight up or down: only their sum counts
        roll, yaw = 0.0, atan2(-R[0, 1], R[1, 1])
    return roll, pitch, yaw


def pose_from_rpy(position: Sequence[float], rpy_rad: Sequence[float]) -> np.ndarray:
    """Pose, (4, 4), of a position (3,) and of fixed-axis roll, pitch, yaw, as in URDF."""
    return transform(rotation_rpy(rpy_rad), position)


def _quaternion_product(p, q):
    """Hamilton's product p q of quaternions (x, y, z, w)."""
    return (p[3] * q[0] + q[3] * p[0] + (p[1] * q[2] - p[2] * q[1]),
            p[3] * q[1] + q[3] * p[1] + (p[2] * q[0] - p[0] * q[2]),
            p[3] * q[2] + q[3] * p[2] + (p[0] * q[1] - p[1] * q[0]),
            p[3] * q[3] - p[0] * q[0] - p[1] * q[1] - p[2] * q[2])


def quaternion_xyzw(R: np.ndarray) -> np.ndarray:
    """Unit quaternion (x, y, z, w), w >= 0, of a rotation matrix, shape (4,); NaN for a matrix with NaN.

    As scipy's, to the last bit.
    """
    if not np.all(np.isfinite(R)):
        return np.full(4, np.nan)
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = np.asarray(R, dtype=float).tolist()
    trace = xx + yy + zz
    most = max(xx, yy, zz, trace)  # the largest part of the quaternion is found first, and the others by it
    if most == trace:
        x, y, z, w = zy - yz, xz - zx, yx - xy, 1.0 + trace
    elif most == xx:
        x, y, z, w = 1.0 - trace + 2.0 * xx, yx + xy, zx + xz, zy - yz
    elif most == yy:
        x, y, z, w = xy + yx, 1.0 - trace + 2.0 * yy, zy + yz, xz - zx
    else:
        x, y, z, w = xz + zx, yz + zy, 1.0 - trace + 2.0 * zz, yx - xy
    q = np.array([x, y, z, w]) / sqrt(x * x + y * y + z * z + w * w)
    return q if q[3] >= 0.0 else -q


def pose_from_quaternion(position: Sequence[float], xyzw: Sequence[float]) -> np.ndarray:
    """Pose, (4, 4), of a position (3,) and a quaternion (4,) of any length; its rotation is NaN if that is zero."""
    X = np.eye(4)
    X[:3, 3] = position
    length = np.linalg.norm(xyzw)
    X[:3, :3] = _scipy_rotation().from_quat(xyzw).as_matrix() if length > 0.0 else np.nan
    return X


def _scipy_rotation():
    from scipy.spatial.transform import Rotation  # slow to import, and a servo without half turns never needs it
    return Rotation


def plane_depth(X_WC: np.ndarray, X_WT: np.ndarray, x: float = 0.0, y: float = 0.0) -> float:
    """Returns the depth [m] at which the ray (x, y, 1) of camera C meets the plane z = 0 of T, NaN where it does not.

    Args: X_WC, X_WT: (4, 4).  x, y: normalised image coordinates; the optical axis unless given.
    """
    normal = X_WT[:3, 2]
    along = float(normal @ X_WC[:3, :3] @ np.array([x, y, 1.0]))
    depth = float(normal @ (X_WT[:3, 3] - X_WC[:3, 3])) / along if abs(along) > 1e-3 else 0.0
    return depth if depth > 0.0 else np.nan
