"""Predicts the features at the time at which a command acts, from those at the time of the image.

The joints say how the camera has moved since, X_C0C1, and the target's plane 1/Z = n . (x, y, 1) makes of it a
homography of the image: P1 = R' (P0 - p) with n . P0 = 1 gives H = R' (I - p n'), x1 ~ H x0 (Hartley and Zisserman,
Multiple View Geometry, 2004, section 13.1). Points move by H. About the centroid, d = x0 - x0g, H is exactly

    x1 = x1g + A d / (1 + k . d),   dx1 = det A / (1 + k . d)^3 dd,

and moments are the integrals of that with 1 / (1 + k . d)^n taken as 1 - n k . d, where the moments of the next order
are known; the error is of second order in the change of perspective over the object.
"""

from math import atan2, comb, cos, hypot, pi, remainder, sin, sqrt
from typing import Any

import numpy as np

from aras_visual_servo import DegenerateFeature, Features, ParameterError


def predicted(features: Any, plane_C: np.ndarray, X_C0C1: np.ndarray) -> Features:
    """Features of moments and points after the camera has moved.

    Args:
        features: `Features`, or an object with its attributes, valid.  plane_C: (3,) (A, B, C) of the target's plane
        in the first camera frame [1/m].  X_C0C1: (4, 4) pose of the later camera in the first.
    Returns: `Features`, relative to the same reference.
    Raises:
        DegenerateFeature: the target would be behind the camera.
        ParameterError: features that cannot be predicted (kernel projections).
    """
    found = Features.from_object(features)
    if len(found.kernel_x) or len(found.kernel_y):
        raise ParameterError("real.predict: found kernel projections, allowed features of moments and points")
    H = X_C0C1[:3, :3].T @ (np.eye(3) - np.outer(X_C0C1[:3, 3], plane_C))
    if len(found.point_x):
        x, y = np.array([_moved(H, x, y)[:2] for x, y in zip(found.point_x, found.point_y)]).T
        found.point_x, found.point_y = tuple(x.tolist()), tuple(y.tolist())
    A, k = _expansion(H, found.xg, found.yg)
    x, y, _ = _moved(H, found.xg, found.yg)
    about = _mapped(found.centred_moments(), A, k)
    dx, dy = about["10"] / about["00"], about["01"] / about["00"]
    found.xg, found.yg = x + dx, y + dy
    mu, raw = _shifted(about, -dx, -dy), _shifted(about, x, y)
    found.mu, found.m = (tuple(each[name] for name in found.moment_names) for each in (mu, raw))
    turned = atan2(A[1, 0] * cos(found.alpha) + A[1, 1] * sin(found.alpha),
                   A[0, 0] * cos(found.alpha) + A[0, 1] * sin(found.alpha))
    axis = 0.5 * atan2(2.0 * mu["11"], mu["20"] - mu["02"])
    found.alpha = remainder(turned + remainder(axis - turned, pi), 2.0 * pi)
    found.area = mu["00"]
    if found.has_reference:
        found.an = found.z_star_m * sqrt(found.area_star / found.area)
        found.xn, found.yn = found.an * found.xg, found.an * found.yg
    spread = mu["20"] + mu["02"]
    found.orientation_condition = hypot(mu["20"] - mu["02"], 2.0 * mu["11"]) / spread
    return found


def _moved(H, x, y):
    """(x, y, scale) of an image point, mapped. Raises DegenerateFeature."""
    u, v, w = (H @ np.array([x, y, 1.0])).tolist()
    if not w > 0.0:
        raise DegenerateFeature("the predicted target is behind the camera")
    return u / w, v / w, w


def _expansion(H, x, y):
    """((2, 2) A, (2,) k) of the map H about an image point: x1 = x1g + A d / (1 + k . d)."""
    u, v, w = _moved(H, x, y)
    return (H[:2, :2] - np.outer((u, v), H[2, :2])) / w, H[2, :2] / w


def _mapped(mu, A, k):
    """Moments by name about the mapped centroid, of centred ones before.

    Args: mu: by name, centred.  A: (2, 2).  k: (2,).
    """
    (a, b), (c, d) = A.tolist()
    kx, ky = k.tolist()
    size, result = abs(a * d - b * c), {}
    for name in mu:
        i, j = int(name[0]), int(name[1])
        value, known = 0.0, f"{i + j + 1}0" in mu
        for p in range(i + 1):
            for q in range(j + 1):
                factor = comb(i, p) * a**p * b**(i - p) * comb(j, q) * c**q * d**(j - q)
                x, y = p + q, i + j - p - q
                term = mu[f"{x}{y}"]
                if known:
                    term -= (i + j + 3) * (kx * mu[f"{x + 1}{y}"] + ky * mu[f"{x}{y + 1}"])
                value += factor * term
        result[name] = size * value
    return result


def _shifted(moments, dx, dy):
    """Moments by name, of the same object moved by (dx, dy)."""
    result = {}
    for name in moments:
        i, j = int(name[0]), int(name[1])
        result[name] = sum(comb(i, p) * comb(j, q) * dx**(i - p) * dy**(j - q) * moments[f"{p}{q}"]
                           for p in range(i + 1) for q in range(j + 1))
    return result
