"""Points and poses that come from matched keypoints: which features may ask for them, and what the servo does with
views that do not match."""

import numpy as np
import pytest

from aras_visual_servo.features.base import FeatureSet
from aras_visual_servo.features.sources.base import source_named
from aras_visual_servo.features.base import View
from aras_visual_servo.ground.errors import ParameterError
from aras_visual_servo.ground.types import Features, Status
from aras_visual_servo.runs.loop import ServoLoop
from aras_visual_servo.scenario.check import check
from aras_visual_servo.scenario.scenario import load_scenario

POINTS = {"servo.law": "ibvs", "servo.features": ["points4"], "servo.gains_per_s": {"points4": 2.0},
          "servo.thresholds": {"points4": 0.0005}, "servo.interaction": "mean"}
PBVS = {"servo.law": "pbvs", "servo.features": ["tx", "ty", "tz", "rx", "ry", "rz"],
        "servo.gains_per_s": dict.fromkeys(("tx", "ty", "tz", "rx", "ry", "rz"), 2.0),
        "servo.thresholds": dict.fromkeys(("tx", "ty", "tz", "rx", "ry", "rz"), 0.002)}


def test_points_and_poses_may_come_from_matches_and_moments_may_not():
    assert FeatureSet(("points4",), source="matches").source == "matches"
    assert FeatureSet(("tx", "xr", "alpha2")).source == "moments"
    with pytest.raises(ParameterError, match="source: found 'matches', .*xn"):
        FeatureSet(("xn", "x1"), source="matches")


def test_a_scenario_with_an_unknown_source_or_without_its_section_is_refused():
    document = load_scenario("six_dof_matches").as_dict()
    assert check(document) == []
    document["servo"]["source"] = "sonar"
    assert [fault.path for fault in check(document)] == [("servo", "source")]
    document["servo"]["source"] = "matches"
    del document["vision"]["matches"]
    assert [fault.path for fault in check(document)] == [("vision", "matches")]


def test_several_views_of_a_goal_are_averaged_point_by_point():
    source = source_named("matches")
    views = [Features(xg=0.1 * k, yg=0.0, point_x=(k, 1.0), point_y=(0.0, 2.0 * k)) for k in (1, 3)]
    mean = source.mean(views)
    assert (mean.point_x, mean.point_y, mean.xg) == ((2.0, 1.0), (0.0, 4.0), pytest.approx(0.2))
    assert FeatureSet(("x1", "y2"), source="matches").values(View(mean)) == (2.0, 4.0)


def test_a_goal_without_noise_takes_two_images():
    pytest.importorskip("aras_visual_servo_sim")
    loop = ServoLoop(load_scenario("vit_vs"))
    loop.place(loop.sequence.config.goal.joints, 0.1)
    assert len(list(loop.teach(0.6))) == 2


@pytest.mark.parametrize("changes", [{}, PBVS, POINTS], ids=["hybrid", "pbvs", "points"])
def test_the_camera_comes_home(changes):
    pytest.importorskip("aras_visual_servo_sim")
    import aras_visual_servo as avs
    from aras_visual_servo.runs.judge import judge
    judgement = judge(avs.run(load_scenario("six_dof_matches", changes)))
    assert judgement.passed, judgement.faults


def test_a_view_that_does_not_match_stops_the_arm_with_the_reason():
    pytest.importorskip("aras_visual_servo_sim")
    scenario = load_scenario("six_dof_matches", {"experiment.settle_s": 0.1})
    loop = ServoLoop(scenario)
    loop.start()
    while loop.sequence.phase != "servo":
        loop.step()
    loop.sim.delete_model("target")
    for _ in range(3):
        record, _, _ = loop.step()
    assert record.status == Status.TARGET_LOST and "keypoints, needed at least 12" in record.status_text
    assert np.array_equal(record.q_dot, np.zeros(len(record.q_dot)))


def test_a_goal_without_texture_ends_the_run_with_a_status():
    pytest.importorskip("aras_visual_servo_sim")
    loop = ServoLoop(load_scenario("six_dof_matches", {"experiment.settle_s": 0.1, "sim.scene.models": []}))
    record = loop.run()
    assert loop.sequence.result.status == Status.TARGET_LOST
    assert "target not in view at the goal" in loop.sequence.result.reason
    assert set(record.phase) <= {"to_goal", "settle_goal", "teach", "done"}  # it never servoed
