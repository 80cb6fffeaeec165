"""A made-up run whose outcome is known exactly: what a perfect exponential servo would leave behind."""

import math

import numpy as np

from aras_visual_servo import FEATURE_NAMES, RecordBuilder, Status

JOINT_NAMES = ("J1", "J2", "gantry")
IMAGE_PERIOD_NS = 33_333_333
RATE_PER_S = 3.0
FEATURE_ERROR = np.array([0.06, -0.09, 0.12, 0.17])
#: True pose of the taught view: looks straight down (x_C = x_W, y_C = -y_W, z_C = -z_W).
X_WCG = np.array([[1.0, 0.0, 0.0, 0.05], [0.0, -1.0, 0.0, 0.05], [0.0, 0.0, -1.0, 0.78], [0.0, 0.0, 0.0, 1.0]])
SETTINGS = {
    "servo": {"law": "decoupled", "mode": "continuous",
              "gains_per_s": dict.fromkeys(("xn", "yn", "an", "alpha"), RATE_PER_S),
              "thresholds": dict.fromkeys(("xn", "yn", "an", "alpha"), 1e-4)},
    "sim": {"seed": 0},
    "experiment": {"judge": {"x_mm": 0.2, "y_mm": 0.2, "z_mm": 0.5, "angle_deg": 0.05}},
}


def rotation_z(angle):
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def pose_CgC(p_m, angle_rad):
    X = np.eye(4)
    X[:3, :3], X[:3, 3] = rotation_z(angle_rad), p_m
    return X


def blob(shift_px):
    """A grey image with a dark, slightly blue bar, (48, 64, 3) rgb."""
    image = np.full((48, 64, 3), 230, dtype=np.uint8)
    image[16:34, 20 + shift_px:36 + shift_px] = (20, 40, 60)
    return image


def make_record(final_p_m=(1e-4, -5e-5, 2e-4), final_angle_rad=1e-4, servo_images=120, status=Status.CONVERGED,
                settings=SETTINGS, scenario="experiment_1", feature_names=FEATURE_NAMES):
    """A record whose camera ends at exactly X_CgC = (final_p_m, rotation about z) and whose errors decay at 3 /s.

    Other features than the usual four have the errors of these, in turn.
    """
    builder = RecordBuilder(scenario, JOINT_NAMES, settings=settings, feature_names=feature_names)
    k = len(feature_names)
    s_star = np.resize([0.0, 0.0, 0.59, 0.3], k)
    stamps = iter(range(0, 10**15, IMAGE_PERIOD_NS))
    for phase in ("to_goal", "settle_goal", "teach", "to_start", "settle_start"):
        builder.add_row(next(stamps), phase, q=[0.0, -0.09, 0.05], X_WC=X_WCG,
                        image=blob(0) if phase == "teach" else None)
    for i in range(servo_images):
        e = FEATURE_ERROR * math.exp(-RATE_PER_S * i * IMAGE_PERIOD_NS * 1e-9)
        last = i == servo_images - 1
        X_CgC = pose_CgC(final_p_m, final_angle_rad) if last else pose_CgC(-e[:3] + [0, 0, 2 * e[2]], -e[3])
        builder.add_row(next(stamps), "servo", status if last else Status.SERVOING, status.name if last else "",
                        s=s_star + np.resize(e, k), s_star=s_star, e=np.resize(e, k),
                        twist=np.append(-RATE_PER_S * e, [0.0, 0.0])[[0, 1, 2, 4, 5, 3]],
                        q=[0.1 * i / servo_images, -0.09, 0.05], set_point=[0.0, -0.09, 0.05], X_WC=X_WCG @ X_CgC,
                        raw=[0.05, 0.0, 0.0, 0.3], image=blob(8 - min(8, i)))
    builder.add_row(next(stamps), "done", status, X_WC=np.eye(4), image=blob(15))
    return builder.finish(run_hash="0123456789abcdef", wall_s=0.2)
