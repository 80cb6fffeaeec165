"""Circles and spheres against ViSP's vpServo on vpFeatureEllipse, 30 random views each."""
import numpy as np
import round_views as rounds
from views import exponential, plane_of, tilted_pose
from visp import visp_servo

import aras_visual_servo as avs
from aras_visual_servo.laws.base import LawSetup, make_law

CASES = 30
#: Of a twist's length. Rounding times the condition of what is inverted.
SAME = 1e-9
#: Of the largest entry of a row. Central differences of steps of 1e-5: rounding 1e-9, and the step squared.
SLOPE, STEP = 1e-6, 1e-5
CIRCLE, SPHERE = ("xe", "ye", "e20", "e11", "e02"), ("ox", "oy", "oz")
INTERACTIONS = ("desired", "current", "mean")


def poses(seed):
    """(goal, here): two cameras over the target."""
    rng = np.random.default_rng(seed)
    goal = tilted_pose(500 + seed)
    return goal, goal @ exponential(np.r_[rng.uniform(-0.06, 0.06, 3), rng.uniform(-0.3, 0.3, 3)], 1.0)


def test_circle(compared):
    names, ours, asked = CIRCLE, [], []
    for seed in range(CASES):
        goal, here = poses(seed)
        views = [rounds.as_view(rounds.circle(X, 0.07, (0.02, -0.03)), plane_of(X)) for X in (goal, here)]
        s_star, s = (avs.FeatureSet(names).values(view) for view in views)
        law = make_law("ibvs", [2.0] * len(names), LawSetup(names, INTERACTIONS[seed % 3]))
        law.reset(avs.Reference(s_star, view=views[0].features, plane_C=np.array(views[0].plane)))
        ours.append(np.array(law.step(avs.Look(views[1], 0.0)).twist))
        asked.append({"kind": "ellipse", "gain_per_s": 2.0, "interaction": INTERACTIONS[seed % 3], "ellipse": s,
                      "ellipse_star": s_star, "plane": views[1].plane, "plane_star": views[0].plane})
    offs = [np.abs(twist - theirs["twist"]).max() / np.linalg.norm(theirs["twist"])
            for twist, theirs in zip(ours, visp_servo(asked))]
    compared("`ibvs`, circle", "ViSP vpFeatureEllipse", offs, SAME)


def test_sphere(compared):
    """Our features of a sphere are functions of ViSP's ellipse: slopes of these times ViSP's rows are our rows."""
    radius_m, ours, asked = 0.06, [], []
    for seed in range(CASES):
        goal, here = poses(seed)
        (star, _), (ellipse, p) = (rounds.sphere(X, radius_m, (0.02, -0.03, 0.04)) for X in (goal, here))
        rim = p / (p @ p - radius_m**2)
        ours.append((ellipse, avs.FeatureSet(SPHERE).matrix(rounds.as_view(ellipse, (0.0, 0.0, 1.0 / p[2])))))
        asked.append({"kind": "ellipse", "gain_per_s": 1.0, "interaction": "current", "ellipse": ellipse,
                      "ellipse_star": star, "plane": rim, "plane_star": rim})
    offs = []
    for (ellipse, L), theirs in zip(ours, visp_servo(asked)):
        slopes = np.empty((3, 5))
        for k, step in enumerate(STEP * np.maximum(np.abs(ellipse), 0.01)):
            change, sphere = step * np.eye(5)[k], avs.FeatureSet(SPHERE)
            ahead, behind = (sphere.values(avs.View(rounds.features_of(ellipse + sign * change)))
                             for sign in (1.0, -1.0))
            slopes[:, k] = np.subtract(ahead, behind) / (2.0 * step)
        offs.append(np.abs(slopes @ theirs["matrix"] - L).max() / np.abs(L).max())
    compared("interaction rows, sphere", "ViSP vpFeatureEllipse", offs, SLOPE)
