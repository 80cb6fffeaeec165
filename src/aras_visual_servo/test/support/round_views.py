"""Exact views of circles and spheres, by their conics: for tests only."""

import numpy as np

from aras_visual_servo import Features, View


def ellipse_of(conic):
    """(xg, yg, n20, n11, n02) of the ellipse p^T C p = 0, p = (x, y, 1)."""
    centre = -np.linalg.solve(conic[:2, :2], conic[:2, 2])
    level = -(conic[2, 2] + conic[2, :2] @ centre)
    n = 0.25 * np.linalg.inv(conic[:2, :2] / level)
    return np.r_[centre, n[0, 0], n[0, 1], n[1, 1]]


def features_of(ellipse):
    """`Features` of an object with the image of this ellipse, moments to order 2."""
    x, y, n20, n11, n02 = ellipse
    a = 4.0 * np.pi * np.sqrt(n20 * n02 - n11 * n11)
    moments = {"00": 1.0, "10": x, "01": y, "20": n20 + x * x, "11": n11 + x * y, "02": n02 + y * y}
    centred = {"00": 1.0, "10": 0.0, "01": 0.0, "20": n20, "11": n11, "02": n02}
    return Features(target_visible=True, valid=True, area=a, xg=x, yg=y, moment_names=tuple(moments),
                    m=[a * value for value in moments.values()], mu=[a * value for value in centred.values()])


def circle(X_WC, radius_m, centre=(0.0, 0.0)):
    """Ellipse of a circle in the plane z = 0, seen from X_WC."""
    X_CW = np.linalg.inv(X_WC)
    H = np.linalg.inv(np.c_[X_CW[:3, :2], X_CW[:3, 3]])
    x, y = centre
    own = np.array([[1.0, 0.0, -x], [0.0, 1.0, -y], [-x, -y, x * x + y * y - radius_m**2]])
    return ellipse_of(H.T @ own @ H)


def sphere(X_WC, radius_m, centre=(0.0, 0.0, 0.0)):
    """(Ellipse of a sphere seen from X_WC, its centre in the camera frame)."""
    p = np.linalg.inv(X_WC)[:3] @ np.r_[centre, 1.0]
    return ellipse_of(np.outer(p, p) - (p @ p - radius_m**2) * np.eye(3)), p


def as_view(ellipse, plane=None):
    return View(features_of(ellipse), plane)
