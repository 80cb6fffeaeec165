"""Exact pictures of a planar polygon, and an arm that does what it is told: for tests only."""

from pathlib import Path
import numpy as np

from aras_visual_servo.arm.kinematics import Kinematics
from aras_visual_servo.ground.types import Features

URDF = (Path(__file__).parent.parent / "urdf" / "arm.urdf").read_text()
GOAL = {"gantry": 0.05, "J1": 0.0, "J2": -0.09, "J3": 0.045, "J5": 0.045, "J6": 0.0}
START = {"gantry": -0.1, "J1": 0.0, "J2": 0.34906585, "J3": -0.26179939, "J5": -0.08726646, "J6": 0.17453293}
#: Asymmetric and elongated, metres in the plane z = 0 of the target, centroid near the origin.
OUTLINE = np.array([[-0.09, -0.045], [0.10, -0.03], [0.06, 0.02], [0.02, 0.05], [-0.07, 0.04]])
ORDER = 4
PERIOD_NS = 33_333_333
#: Gauss-Legendre nodes of [0, 1]: exact to degree 9, moments to order 5 need 7.
NODES, WEIGHTS = np.polynomial.legendre.leggauss(5)
NODES, WEIGHTS = 0.5 * (NODES + 1.0), 0.5 * WEIGHTS


def arm():
    return Kinematics(URDF, "world", "camera_optical_frame")


def polygon_moments(xy, order, about=(0.0, 0.0)):
    """{"ij": moment} of a polygon by Green's theorem: m_ij = 1/(i+1) contour integral of x^(i+1) y^j dy, area > 0."""
    p = xy - np.asarray(about)
    way = np.vstack((p[1:], p[:1])) - p
    x, y = (p[:, axis, None] + way[:, axis, None] * NODES for axis in (0, 1))
    x_dy, y = (x * (way[:, 1, None] * WEIGHTS)).ravel(), y.ravel()
    powers = np.arange(order + 1)[:, None]
    all_of_them = (x_dy * x.ravel() ** powers) @ (y ** powers).T / (powers + 1)
    all_of_them *= np.sign(all_of_them[0, 0])
    return {f"{i}{j}": all_of_them[i, j].item() for i in range(order + 1) for j in range(order + 1 - i)}


def picture(X_WC, X_WT=None, outline=OUTLINE):
    """Vertices (k, 2) of the outline in normalised image coordinates, seen from camera pose X_WC."""
    X_WT = np.diag([1.0, 1.0, 1.0, 1.0]) if X_WT is None else X_WT
    corners = np.c_[outline, np.zeros(len(outline)), np.ones(len(outline))]
    in_camera = (np.linalg.inv(X_WC) @ X_WT @ corners.T)[:3]
    assert (in_camera[2] > 0.0).all(), "target behind the camera"
    return (in_camera[:2] / in_camera[2]).T


def angle_between(a, b):
    return (a - b + np.pi) % (2.0 * np.pi) - np.pi


class Camera:
    """Features of exact pictures; the followed points are the vertices of the outline."""

    def __init__(self, X_WT, outline=OUTLINE):
        self.X_WT, self.outline, self.star = X_WT, outline, None

    def features(self, X_WC):
        xy = picture(X_WC, self.X_WT, self.outline)
        m = polygon_moments(xy, ORDER)
        xg, yg = m["10"] / m["00"], m["01"] / m["00"]
        mu = polygon_moments(xy, ORDER, (xg, yg))
        alpha = 0.5 * np.arctan2(2.0 * mu["11"], mu["20"] - mu["02"])
        third = mu["30"] * np.cos(alpha) ** 3 + 3 * mu["21"] * np.cos(alpha) ** 2 * np.sin(alpha) \
            + 3 * mu["12"] * np.cos(alpha) * np.sin(alpha) ** 2 + mu["03"] * np.sin(alpha) ** 3
        if third < 0.0:  # the heavier end tells which way the axis points
            alpha = angle_between(alpha + np.pi, 0.0)
        f = Features(target_visible=True, valid=True, has_reference=self.star is not None, area=m["00"], xg=xg, yg=yg,
                     alpha=alpha, moment_names=tuple(m), m=list(m.values()), mu=[mu[name] for name in m],
                     point_x=xy[:, 0].tolist(), point_y=xy[:, 1].tolist())
        if self.star is not None:
            z_star, area_star = f.z_star_m, f.area_star = self.star
            f.an = z_star * np.sqrt(area_star / m["00"])
            f.xn, f.yn = f.an * xg, f.an * yg
        return f


def pose_error(X_WA, X_WB):
    """Distance [m] and angle [rad] between two poses."""
    X = np.linalg.inv(X_WA) @ X_WB
    R = X[:3, :3]
    sine = 0.5 * np.linalg.norm([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    return np.linalg.norm(X[:3, 3]), np.arctan2(sine, 0.5 * (np.trace(R) - 1.0))
