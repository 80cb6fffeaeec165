"""Laws with constraints on exact pictures, and a camera that six joints move along and about its own axes."""

import numpy as np
from views import look_at, plane_of, tilted_pose, view

from aras_visual_servo import expand, FeatureSet, Reference
from aras_visual_servo.arm.limits import joint_bounds
from aras_visual_servo.laws.base import LawSetup, make_law
from aras_visual_servo.laws.constraints import rooms_of
from aras_visual_servo.laws.look import Arm
from aras_visual_servo.laws.mpc import MpcSettings
from aras_visual_servo.laws.qp import QpSettings
from aras_visual_servo.spatial import exponential

POINTS, MOMENTS = expand(["points5"]), ("xn", "yn", "an", "sx", "sy", "alpha")
NAMES = ("a", "b", "c", "d", "e", "f")
DT_S = 1.0 / 30.0
#: Of a program of six unknowns with a condition number below 10^4.
ROUNDING = 1e-8
VIEW = {"half_width": 0.6, "half_height": 0.5, "margin": 0.05}
SETTINGS = {"qp": QpSettings, "mpc": MpcSettings}
GOAL = tilted_pose(1)


def law_of(name, features=POINTS, gain=2.0, interaction="current", **settings):
    setup = LawSetup(features, interaction, settings={name: SETTINGS[name](**settings)})
    law, goal = make_law(name, [gain] * len(features), setup), view(GOAL)
    law.reset(Reference(FeatureSet(features).values(goal), view=goal.features, plane_C=plane_of(GOAL)))
    return law


def arm_of(X, wanted, before=None, q=None, lower=-np.inf, upper=np.inf, velocity=5.0, acceleration=np.inf):
    """A camera that six joints move along and about its own axes."""
    q, before = np.zeros(6) if q is None else q, np.zeros(6) if before is None else before
    limits = [np.full(6, limit) if np.isscalar(limit) else limit for limit in (lower, upper, velocity, acceleration)]
    low, high, at_stop, short = joint_bounds(q, before, *limits, DT_S, 2.0 * DT_S)
    return Arm(NAMES, q, before, X, np.eye(6), wanted, low, high, at_stop,
               tuple(name for name, late in zip(NAMES, short) if late), *limits, DT_S)


def asked(law, X, before=None, **limits):
    """(`Joints`, `Arm`, `Rooms`, twist) of a look from X."""
    seen = view(X, plane=plane_of(X))
    twist = law.step(look_at(seen.features, DT_S, plane_of(X))).twist
    arm = arm_of(X, twist, before, **limits)
    return law.joint_velocity(seen, arm, twist), arm, rooms_of(law.settings, seen, X), twist


def fly(law, X, seconds, **limits):
    """(last X, (n, m) rooms on the way, texts) of a camera that does what the law says."""
    before, rooms, texts = np.zeros(6), [], []
    for _ in range(round(seconds / DT_S)):
        joints, _, room, _ = asked(law, X, before, **limits)
        before = joints.q_dot
        X = X @ exponential(DT_S * before)
        rooms.append(room.h)
        texts.append(joints.text)
    return X, np.array(rooms), texts


def turned(angle_rad, aside_m=0.0):
    return GOAL @ exponential(np.array([aside_m, 0.0, 0.0, 0.0, 0.0, angle_rad]))
