"""Law pbvs on a known target, whose pose its moments give: straight home, the decay of each part, what is refused."""

import numpy as np
import pytest
from toy_plant import OUTLINE
from views import exponential, look_at, plane_of, tilted_pose, view

from aras_visual_servo import DegenerateFeature, ParameterError, PlanarTarget, Reference
from aras_visual_servo.laws.base import LawSetup, make_law
from aras_visual_servo.spatial import rotation_vector

POSE = ("tx", "ty", "tz", "rx", "ry", "rz")
GAINS = (2.0,) * 6
DT_S = 1.0 / 30.0
TARGET = PlanarTarget([OUTLINE])


def look(X_WC, outline=OUTLINE):
    return view(X_WC, outline).features


def law_at(goal, **more):
    law = make_law("pbvs", GAINS, LawSetup(POSE, target=TARGET, **more))
    law.reset(Reference(np.zeros(6), view=look(goal), plane_C=plane_of(goal)))
    return law


def answer_to(law, goal, X, wrong=None):
    X_CgC = np.linalg.inv(goal) @ X @ (np.eye(4) if wrong is None else wrong)
    return law.step(look_at(look(X), DT_S, X_CgC=X_CgC))


def step(law, goal, X, wrong=None):
    return answer_to(law, goal, X, wrong).twist


def test_the_camera_goes_straight_home_and_each_part_decays_at_its_gain():
    goal = tilted_pose(1)
    law, X = law_at(goal), goal @ exponential([0.05, -0.04, -0.06, 0.15, -0.1, 0.4], 1.0)
    first = np.linalg.inv(goal) @ X
    for _ in range(60):
        X = X @ exponential(step(law, goal, X), DT_S)
    last, decayed = np.linalg.inv(goal) @ X, np.exp(-2.0 * 60 * DT_S)
    angle = rotation_vector(first[:3, :3])
    np.testing.assert_allclose(rotation_vector(last[:3, :3]), decayed * angle, atol=1e-6)
    off_line = np.cross(last[:3, 3], first[:3, 3]) / np.linalg.norm(first[:3, 3])
    assert np.linalg.norm(off_line) < 1e-3  # the twist is held while the camera turns: second order in dt
    assert np.linalg.norm(last[:3, 3]) == pytest.approx(decayed * np.linalg.norm(first[:3, 3]), abs=1e-3)


def test_joints_that_are_a_little_wrong_do_not_matter():
    goal = tilted_pose(1)
    law, X = law_at(goal), goal @ exponential([0.05, -0.04, -0.06, 0.15, -0.1, 0.4], 1.0)
    wrong = exponential([0.004, -0.003, 0.002, 0.01, -0.01, 0.01], 1.0)
    for _ in range(400):
        X = X @ exponential(step(law, goal, X, wrong), DT_S)
    np.testing.assert_allclose(X, goal, atol=1e-9)


def test_the_target_must_be_known():
    with pytest.raises(ParameterError, match="target_model: found nothing"):
        make_law("pbvs", GAINS, LawSetup(POSE))
    with pytest.raises(ParameterError, match="teach the goal again"):
        make_law("pbvs", GAINS, LawSetup(POSE, target=TARGET)).reset(np.zeros(6))


def test_a_view_of_something_else_is_refused():
    goal = tilted_pose(1)
    law = law_at(goal)
    bar = np.array([[-0.3, -0.004], [0.3, -0.004], [0.3, 0.004], [-0.3, 0.004]])
    with pytest.raises(DegenerateFeature, match="the best pose leaves a residual"):
        law.step(look_at(look(goal, bar), DT_S, X_CgC=np.eye(4)))
