"""Points and poses that come from matched keypoints and from an AprilTag: which features may ask for them, laws on
them, and what the servo does with views that do not match or lack the tag."""

import numpy as np
import pytest

from aras_visual_servo import Features, FeatureSet, load_scenario, ParameterError, ServoLoop, source_named, Status, View
from aras_visual_servo.scenario.check import check
from aras_visual_servo.spatial import quaternion_xyzw

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


def seen(**more):
    view = Features(reference_stamp_ns=3, z_star_m=0.5)
    view.point_x, view.point_y = (-0.1, 0.1, 0.1, -0.1), (-0.1, -0.1, 0.1, 0.1)
    view.position_m, view.orientation = more.get("position_m", ()), more.get("orientation", ())
    return view


def test_a_tag_of_known_size_tells_its_plane_and_one_of_unknown_size_takes_the_given_normal():
    source = source_named("tag")
    assert FeatureSet(("points4",), source="tag").source == "tag"
    plane = source.taught(seen(), 0.5, np.array([0.0, 0.0, 1.0])).plane_C
    np.testing.assert_allclose(plane, [0.0, 0.0, 2.0])
    c, s = np.cos(0.3), np.sin(0.3)  # the face looks at the camera, tilted by 0.3 about x: R = Rx(pi + 0.3)
    turned = [np.cos(0.15), 0.0, 0.0, -np.sin(0.15)]
    found = source.taught(seen(position_m=(0.1, 0.0, 0.5), orientation=turned), 9.0, np.array([0.0, 0.0, 1.0]))
    normal = found.plane_C / np.linalg.norm(found.plane_C)
    np.testing.assert_allclose(normal, [0.0, -s, c], atol=1e-12)
    np.testing.assert_allclose(found.plane_C @ [0.1, 0.0, 0.5], 1.0)
    assert found.view.z_star_m == 9.0 and found.features.point_x == seen().point_x
    assert found.view.target_visible and found.view.valid and found.view.has_reference


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


@pytest.mark.parametrize("name", ["six_dof_matches", "six_dof_tag"])
@pytest.mark.parametrize("changes", [{}, PBVS, POINTS], ids=["hybrid", "pbvs", "points"])
def test_the_camera_comes_home(name, changes):
    pytest.importorskip("aras_visual_servo_sim")
    import aras_visual_servo as avs
    from aras_visual_servo.runs.judge import judge
    judgement = judge(avs.run(load_scenario(name, changes)))
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


@pytest.mark.parametrize("view", ["behind", "half outside", "too small", "gone"])
def test_a_view_without_the_tag_stops_the_arm_with_the_reason(view):
    pytest.importorskip("aras_visual_servo_sim")
    tag = {"family": "36h11", "id": 0, "size_m": 0.16, "min_side_px": 40}
    goal = load_scenario("six_dof_tag").experiment["goal"]
    stay = {"sim.initial_positions": goal["joints"], "experiment.start": goal}  # so that servoing begins soon
    loop = ServoLoop(load_scenario("six_dof_tag", {"experiment.settle_s": 0.1, "vision.tag": tag, **stay}))
    loop.start()
    while loop.sequence.phase != "servo":
        loop.step()
    X_WT, X_WC = loop.sim.model_pose("target").copy(), loop.camera_pose()
    if view == "gone":
        loop.sim.delete_model("target")
    else:
        if view == "behind":
            X_WT[:3, :3] = X_WT[:3, :3] @ np.diag([1.0, -1.0, -1.0])
        elif view == "half outside":
            X_WT[:3, 3] = (X_WC @ [0.85 * 0.6, 0.0, 0.6, 1.0])[:3]  # the image ends at x = 0.85 z
        else:
            X_WT[:3, 3] = (X_WC @ [0.0, 0.0, 2.0, 1.0])[:3]
        loop.sim.set_model_pose("target", X_WT[:3, 3], quaternion_xyzw(X_WT[:3, :3]))
    for _ in range(3):
        record, _, _ = loop.step()
    assert record.status == Status.TARGET_LOST
    assert ("too small" if view == "too small" else "does not show tag 0 of 36h11") in record.status_text
    assert np.array_equal(record.q_dot, np.zeros(len(record.q_dot)))


@pytest.mark.parametrize("name, gone", [("six_dof_matches", {"sim.scene.models": []}),
                                        ("six_dof_tag", {"vision.tag": {"id": 5}})])
def test_a_goal_that_is_not_seen_ends_the_run_with_a_status(name, gone):
    pytest.importorskip("aras_visual_servo_sim")
    loop = ServoLoop(load_scenario(name, {"experiment.settle_s": 0.1, **gone}))
    record = loop.run()
    assert loop.sequence.result.status == Status.TARGET_LOST
    assert "target not in view at the goal" in loop.sequence.result.reason
    assert set(record.phase) <= {"to_goal", "settle_goal", "teach", "done"}  # it never servoed
