"""The live run without a page: what is asked for acts on the next image, or is refused and changes nothing."""

import json
import re

import numpy as np
import pytest
import yaml

from aras_visual_servo import load_scenario, ParameterError, spatial, Status
from aras_visual_servo.scenario import reach_map
from aras_visual_servo_study.live import aftermath, messages as ask
from aras_visual_servo_study.live.run import LiveRun

WHOLE_NS = 10**12       # to the next image, however far
SLICE_NS = 16_000_000   # as a page at real time asks for
#: The arm is driven from goal to start in some three simulated seconds, and the servo takes three more.
DRIVE_IMAGES, SERVO_IMAGES = 150, 200


def images(run, count, until=lambda run: False):
    for _ in range(count):
        run.advance(WHOLE_NS)
        if until(run):
            return True
    return False


def servoing(run):
    return run.loop.sequence.phase == "servo"


def ended(run):
    return run.loop.sequence.done


def begun():
    run = LiveRun(load_scenario("experiment_1"))
    run.do(ask.Start())
    assert images(run, DRIVE_IMAGES, servoing)
    return run


@pytest.fixture
def run():
    return begun()


def error_of(run):
    return abs(run.record.e[0])


def test_the_run_converges_as_a_run_in_process_does(run):
    assert images(run, SERVO_IMAGES, ended)
    assert run.record.status == Status.CONVERGED and run.goal is not None
    assert run.state()["status"] == "CONVERGED"


def test_what_is_said_after_the_end_is_of_now():
    run = begun()
    assert images(run, SERVO_IMAGES, ended) and images(run, 60) is False
    state = run.state()
    assert (state["status"], state["ended"], state["since"]) == ("CONVERGED", "", "")
    wanted = run.kinematics.by_name(run.joints())["J6"] - 0.3
    run.do(ask.Joint("J6", wanted))
    images(run, 60)
    state, row = run.state(), dict(zip(run.about()["rows"], run.row(1.0)))
    assert (state["status"], state["ended"], state["kind"]) == ("IDLE", "CONVERGED", "moved") and state["since"]
    assert abs(row["e.alpha"]) == pytest.approx(0.3, abs=0.02) and row["q.J6"] == pytest.approx(wanted, abs=0.02)
    run.do(ask.Teach())
    images(run, 1)
    assert abs(run.row(1.0)[4]) < 1e-3 and run.state()["status"] == "IDLE"
    run.do(ask.Start("taught"))
    assert images(run, SERVO_IMAGES, ended) and run.state()["status"] == "CONVERGED" and run.state()["since"] == ""


@pytest.mark.parametrize("changes, change", [
    ({"servo.thresholds.xn": 1e-6}, aftermath.THRESHOLDS), ({}, aftermath.MOVED_TARGET), ({}, aftermath.TAUGHT)])
def test_each_change_after_the_end_is_named(run, changes, change):
    assert images(run, SERVO_IMAGES, ended)
    run.do(ask.Follow(False))
    images(run, 2)
    if changes:
        run.do(ask.Set(changes))
    elif change == aftermath.TAUGHT:
        run.do(ask.Teach())
    else:
        run.loop.sim.set_model_pose(run.target, list(run.target_pose()[:3, 3] + (0.01, 0.0, 0.0)), [0.0, 0.0, 0.0, 1.0])
    images(run, 2)
    assert run.state()["since"] == change and run.record.status == Status.IDLE


def test_a_camera_that_swings_is_named_when_it_ends_elsewhere():
    run = LiveRun(load_scenario("experiment_1"))
    gains = {f"servo.gains_per_s.{name}": 12.0 for name in ("xn", "yn", "an", "alpha")}
    run.do(ask.Set({**gains, "sim.cameras.0.latency_s": 0.16}))
    run.do(ask.Start())
    assert images(run, 1000, ended) and run.record.status != Status.CONVERGED
    assert run.state()["kind"] == "swings"


def test_slices_of_time_change_no_byte_of_the_run():
    hashes = set()
    for most_ns in (WHOLE_NS, SLICE_NS):
        run = LiveRun(load_scenario("experiment_1"))
        run.do(ask.Start())
        while run.images < 60:
            run.advance(most_ns)
        hashes.add(run.loop.sim.run_hash)
    assert len(hashes) == 1


def rate(run, count=6):
    """1/s, of the decay of the first error over some images."""
    before, t_ns = error_of(run), run.record.stamp_ns
    assert not images(run, count, ended)
    return np.log(before / error_of(run)) / (1e-9 * (run.record.stamp_ns - t_ns))


def test_a_gain_that_is_moved_acts_from_the_next_image_on(run):
    images(run, 2)
    assert rate(run) == pytest.approx(3.0, abs=0.5)
    run.do(ask.Set({"servo.gains_per_s.xn": 0.5}))
    images(run, 3)  # the joints come to their new velocities
    assert rate(run) == pytest.approx(0.5, abs=0.35)  # of the camera, tilt and friction included
    assert run.loop.sequence.phase == "servo" and run.goal is not None


def test_the_law_and_its_own_settings_can_be_changed_while_it_servoes(run):
    version = run.version
    run.do(ask.Set({"servo.law": "ibvs", "servo.interaction": "current"}))
    assert run.loop.servo.config.law == "ibvs" and run.version > version
    assert images(run, SERVO_IMAGES, ended) and run.record.status == Status.CONVERGED


def test_other_features_of_the_same_view_get_gains_and_thresholds(run):
    run.do(ask.Set({"servo.law": "ibvs", "servo.features": ["xn", "yn", "an"]}))
    assert run.loop.servo.feature_names == ("xn", "yn", "an")
    images(run, 3)
    assert len(run.record.e) == 3 and run.about()["rows"][1:4] == ["e.xn", "e.yn", "e.an"]
    assert set(run.scenario.servo["gains_per_s"]) == {"xn", "yn", "an"}
    run.do(ask.Set({"servo.features": ["xn", "yn", "an", "alpha"]}))
    images(run, 2)
    assert np.isfinite(run.record.e).all() and set(run.scenario.servo["thresholds"]) == {"xn", "yn", "an", "alpha"}


@pytest.mark.parametrize("values, said", [
    ({"servo.gains_per_s.xn": -1.0}, "servo.gains_per_s.xn: found -1.0, .*> 0"),
    ({"servo.law": "magic"}, "found magic"), ({"servo.nothing": 1}, "unknown key"), ({}, "allowed an object"),
    ({"sim.cameras.7.noise_stddev": 1.0}, "unknown path"), ([1], "allowed an object"),
    ({"servo.features": ["photometric"]}, "vision.photometric")])
def test_what_is_not_allowed_is_refused_and_changes_nothing(run, values, said):
    before, servo = run.scenario, run.loop.servo
    with pytest.raises(ParameterError, match=said):
        run.do(ask.Set(values))
    assert run.scenario is before and run.loop.servo is servo
    assert images(run, 1) is False and servoing(run)


def test_noise_begins_without_disturbing_the_arm(run):
    images(run, 3)
    q, t_ns = run.loop.sim.joint_positions, run.time_ns
    calm = np.array(run.image, dtype=int)
    assert run.do(ask.Set({"sim.cameras.0.noise_stddev": 8.0}))["waiting"] == []
    assert run.time_ns == t_ns and np.array_equal(run.loop.sim.joint_positions, q)
    images(run, 1)
    background = np.array(run.image, dtype=int)[:40, :40]
    assert servoing(run) and calm[:40, :40].std() == 0.0 and background.std() == pytest.approx(8.0, rel=0.2)


def test_a_camera_is_late_at_once_and_after_a_reset(run):
    images(run, 3)
    assert run.do(ask.Set({"sim.cameras.0.latency_s": 0.05}))["waiting"] == []
    images(run, 3)
    assert servoing(run) and run.time_ns - run.record.stamp_ns >= 50_000_000
    run.do(ask.Reset())
    images(run, 3)
    assert run.time_ns - run.record.stamp_ns >= 50_000_000


def test_light_changes_at_once_and_what_waits_goes_on_waiting(run):
    images(run, 3)
    assert run.do(ask.Set({"sim.period_s": 0.002}))["waiting"] == ["sim.period_s"]
    run.do(ask.Set({"sim.scene.background_rgb": [10, 20, 30]}))
    images(run, 1)
    assert tuple(run.image[0, 0]) == (10, 20, 30) and run.loop.sim.period_ns == 1_000_000
    assert run.about()["waiting"] == ["sim.period_s"]
    run.do(ask.Reset())
    images(run, 1)
    assert tuple(run.image[0, 0]) == (10, 20, 30) and run.loop.sim.period_ns == 2_000_000


def move_target(run, dy):
    """Along the gantry; a little along x the arm hangs straight, which is singular."""
    p = run.loop.target_pose()[:3, 3]
    run.do(ask.PlaceTarget((p[0], p[1] + dy, p[2]), (0.0, 0.0, 2 ** -0.5, 2 ** -0.5)))


def test_the_arm_follows_a_target_that_is_dragged(run):
    assert images(run, SERVO_IMAGES, ended)
    before = run.loop.camera_pose()[:3, 3]
    move_target(run, 0.05)
    assert images(run, 3, servoing) and images(run, SERVO_IMAGES, ended)
    assert run.loop.camera_pose()[:3, 3] - before == pytest.approx([0.0, 0.05, 0.0], abs=1e-3)


def test_a_target_that_is_dragged_until_the_time_is_up_is_followed_to_its_end(run):
    assert images(run, SERVO_IMAGES, ended)
    before = run.loop.camera_pose()[:3, 3]
    run.do(ask.Set({"servo.time_limit_s": 2.0}))
    move_target(run, 0.03)
    assert images(run, 3, servoing) and not images(run, 45, ended)
    move_target(run, 0.02)  # half a second before the end
    assert images(run, 30, lambda run: run.record.status == Status.TIMED_OUT)
    assert images(run, 3, servoing) and images(run, SERVO_IMAGES, ended) and run.record.status == Status.CONVERGED
    assert run.loop.camera_pose()[:3, 3] - before == pytest.approx([0.0, 0.05, 0.0], abs=1e-3)


def test_a_servo_whose_time_was_up_is_not_begun_again_for_a_target_at_rest(run):
    run.do(ask.Set({"servo.time_limit_s": 0.5}))
    assert images(run, SERVO_IMAGES, ended) and run.record.status == Status.TIMED_OUT
    assert not images(run, 10, servoing)


def test_a_target_that_moves_after_the_last_image_was_taken_is_followed(run):
    late = {"sim.cameras.0.latency_s": 0.05}  # the image that ends the servo was taken before the one before it came
    run.do(ask.Set(late))
    assert images(run, SERVO_IMAGES, ended) and run.record.status == Status.CONVERGED
    count, before = run.images, run.loop.camera_pose()[:3, 3]
    again = begun()
    again.do(ask.Set(late))
    assert not images(again, count - 1 - again.images, ended)
    move_target(again, 0.03)
    assert images(again, 1, ended) and again.record.status == Status.CONVERGED
    assert images(again, 5, servoing) and images(again, SERVO_IMAGES, ended)
    assert again.loop.camera_pose()[:3, 3] - before == pytest.approx([0.0, 0.03, 0.0], abs=1e-3)


def place(run, X_WT, way):
    """Puts the target so far from a pose, (4, 4)."""
    run.do(ask.PlaceTarget(tuple(X_WT[:3, 3] + way), tuple(spatial.quaternion_xyzw(X_WT[:3, :3]))))


def reach_of(run, monkeypatch):
    monkeypatch.setattr(reach_map, "SIDE", 7)
    return run.do(ask.Reach())()


def test_the_reach_is_of_the_plane_on_which_the_target_lies(run, monkeypatch):
    images(run, SERVO_IMAGES, ended)
    X_WT, found = run.target_pose(), reach_of(run, monkeypatch)
    assert found["pose"] == pytest.approx([*X_WT[:3, 3], *spatial.quaternion_xyzw(X_WT[:3, :3])], abs=1e-5)
    missing_mm = np.array(found["missing_mm"])
    assert missing_mm.shape == (7, 7) and 0 < (missing_mm == 0).sum() < 40
    json.dumps(found)


def test_the_arm_rests_where_it_is_nearest_and_follows_again(run):
    images(run, SERVO_IMAGES, ended)
    X_WT, X_TC = run.target_pose(), np.linalg.solve(run.target_pose(), run.camera_pose())
    place(run, X_WT, [0.1, 0.1, 0.0])
    assert images(run, 5 * SERVO_IMAGES, lambda run: ended(run) and run.record.status != Status.CONVERGED)
    told = run.state()
    assert told["status"] == "OUT_OF_REACH" and told["kind"] == "out_of_reach"
    off_mm = 1e3 * np.linalg.norm((run.target_pose() @ X_TC)[:3, 3] - run.camera_pose()[:3, 3])
    told_mm = float(re.match(r"out of reach by ([0-9.]+) mm", told["text"]).group(1))
    assert told_mm == pytest.approx(off_mm, abs=1.0) and off_mm > 5.0
    images(run, 10)
    assert run.state()["status"] == "OUT_OF_REACH"  # it does not begin again before the target is dragged
    place(run, X_WT, [0.0, 0.0, 0.0])
    assert images(run, SERVO_IMAGES, lambda run: run.record.status == Status.CONVERGED)


def test_the_reach_is_refused_without_a_goal_and_where_nothing_limits_the_camera():
    with pytest.raises(ParameterError, match="reach"):
        LiveRun(load_scenario("experiment_1")).do(ask.Reach())
    free = LiveRun(load_scenario("free_camera"))
    free._view = np.eye(4), np.eye(4)
    with pytest.raises(ParameterError, match="reach"):
        free.do(ask.Reach())


def test_a_scenario_that_says_how_the_arm_rests_is_left_alone():
    given = load_scenario("experiment_1", {"servo.out_of_reach": {"rest_s": 7.0}})
    assert LiveRun(given).scenario.servo["out_of_reach"] == {"rest_s": 7.0}
    assert LiveRun(load_scenario("experiment_1")).scenario.servo["out_of_reach"] == {}


def test_without_follow_it_stays(run):
    run.do(ask.Follow(False))
    assert images(run, SERVO_IMAGES, ended)
    move_target(run, 0.05)
    assert not images(run, 10, servoing)


def test_stop_stops_and_servo_goes_on_from_there(run):
    images(run, 3)
    run.do(ask.Stop())
    images(run, 10)
    q = run.loop.sim.joint_positions
    images(run, 10)
    assert ended(run) and run.loop.sim.joint_positions == pytest.approx(q, abs=1e-3)
    run.do(ask.Start("taught"))
    assert images(run, SERVO_IMAGES, ended) and run.record.status == Status.CONVERGED


def test_a_law_comes_with_what_it_needs(run):
    offer = run.do(ask.Offer("pbvs"))
    assert offer["features"] == ["tx", "ty", "tz", "rx", "ry", "rz"] and not offer["reset"]
    run.do(ask.Set(offer["values"]))
    assert images(run, 3, ended) is False and servoing(run) and len(run.record.e) == 6
    there = run.do(ask.Offer("photometric"))
    assert there["reset"] and "vision.photometric" in there["values"]
    run.do(ask.Set(there["values"], reset=True))
    assert run.servo.feature_names == ("photometric",) and run.time_ns == 0 and run.waiting == set()
    back = run.do(ask.Offer("decoupled"))
    assert back["reset"]
    with pytest.raises(ParameterError, match="servo.law: found magic"):
        run.do(ask.Offer("magic"))
    with pytest.raises(ParameterError, match="servo.sliding"):
        run.do(ask.Offer("sliding"))


def test_a_reset_with_settings_that_fail_leaves_the_run(run):
    scenario, loop = run.scenario, run.loop
    with pytest.raises(ParameterError):
        run.do(ask.Set({"sim.cameras.0.width": -5}, reset=True))
    assert run.scenario is scenario and run.loop is loop and images(run, 1) is False


def test_again_servos_from_the_start_to_the_goal_that_stands(run):
    with pytest.raises(ParameterError, match="again: found no taught goal"):
        LiveRun(load_scenario("experiment_1")).do(ask.Again())
    first = run.record.e
    assert images(run, SERVO_IMAGES, ended)
    reference = run.servo.reference
    run.do(ask.Again())
    assert images(run, DRIVE_IMAGES, servoing) and run.servo.reference is reference
    assert run.record.e == pytest.approx(first, rel=0.01)
    assert run.row(1.0)[run.about()["rows"].index("servo")] == 1


def test_again_finds_the_target_after_noise_that_hid_it(run):
    run.do(ask.Set({"sim.cameras.0.noise_stddev": 516.0}))
    run.do(ask.Again())
    assert images(run, DRIVE_IMAGES + SERVO_IMAGES, ended) and run.record.status == Status.TARGET_LOST
    run.do(ask.Set({"sim.cameras.0.noise_stddev": 0.0}))
    run.do(ask.Again())
    assert images(run, DRIVE_IMAGES, servoing) and images(run, SERVO_IMAGES, ended)
    assert run.record.status == Status.CONVERGED


def test_another_start_shows_the_target_and_is_servoed_from(run):
    draws = [run.do(ask.DrawStart())["start"] for _ in range(2)]
    assert draws[0] != draws[1] and run.loop.sequence.phase == "servo"
    run.do(ask.Stop())
    run.do(ask.Set({"experiment.start": draws[1]}))
    run.do(ask.Again())
    assert images(run, DRIVE_IMAGES, servoing)
    q = dict(zip(run.kinematics.joint_names, run.joints()))
    assert q == pytest.approx(draws[1]["joints"], abs=0.02)  # the first image of the servo moves it
    assert images(run, SERVO_IMAGES, ended) and run.record.status == Status.CONVERGED


def test_a_start_is_not_drawn_where_the_target_is_out_of_view(run):
    run.do(ask.PlaceTarget((3.0, 0.0, 0.2), (0.0, 0.0, 0.0, 1.0)))
    with pytest.raises(ParameterError, match="draw_start: none of"):
        run.do(ask.DrawStart())


def test_teach_makes_this_view_the_goal(run):
    with pytest.raises(ParameterError, match="phase servo, allowed when it is stopped"):
        run.do(ask.Teach())
    run.do(ask.Stop())
    images(run, 20)
    answer = run.do(ask.Teach())
    X_WC = run.loop.camera_pose()
    assert answer["z_star_m"] == pytest.approx((X_WC[2, 3] - 0.193394) / -X_WC[2, 2], rel=1e-6)
    run.do(ask.Start("taught"))
    images(run, 2)
    assert np.abs(run.record.e).max() < 2e-3  # the arm only settles a little


def test_a_joint_goes_where_the_slider_is(run):
    with pytest.raises(ParameterError, match="joint: found the run in phase servo"):
        run.do(ask.Joint("J1", 0.1))
    run.do(ask.Stop())
    with pytest.raises(ParameterError, match="allowed J1, J2"):
        run.do(ask.Joint("J9", 0.1))
    with pytest.raises(ParameterError, match="J1: found 3, allowed -2.09"):
        run.do(ask.Joint("J1", 3.0))
    images(run, 5)
    names, begin = list(run.loop.sim.joint_names), run.time_ns
    run.do(ask.Joint("J1", 0.4))
    images(run, 5)
    assert abs(run.loop.sim.joint_positions[names.index("J1")]) < 0.2  # no jump
    images(run, 60)
    assert run.loop.sim.joint_positions[names.index("J1")] == pytest.approx(0.4, abs=0.01) and run.time_ns > begin


def test_the_target_gets_a_motion_and_rests_again(run):
    with pytest.raises(RuntimeError, match="radius_m"):
        run.do(ask.MoveTarget({"type": "circle"}))
    run.do(ask.MoveTarget({"type": "constant_velocity", "linear_m_per_s": [0.03, 0.0, 0.0]}))
    before = run.loop.target_pose()[0, 3]
    images(run, 30)
    assert run.loop.target_pose()[0, 3] - before == pytest.approx(0.03, abs=0.002)
    run.do(ask.MoveTarget(None))
    rest = run.loop.target_pose()[0, 3]
    images(run, 5)
    assert run.loop.target_pose()[0, 3] == rest


def test_what_stands_there_is_a_scenario_that_loads(run, tmp_path):
    run.do(ask.Set({"servo.gains_per_s.xn": 1.25}))
    run.do(ask.PlaceTarget((0.05, 0.06, 0.2), (0.0, 0.0, 0.6, 0.8)))
    path = tmp_path / "mine.yaml"
    path.write_text(run.do(ask.Save("mine", True))["yaml"])
    saved = load_scenario(str(path))
    assert saved.name == "mine" and saved.servo["gains_per_s"]["xn"] == 1.25
    again = LiveRun(saved)
    assert again.loop.target_pose() == pytest.approx(run.loop.target_pose(), abs=1e-5)
    start = yaml.safe_load(path.read_text())["experiment"]["start"]["joints"]
    assert list(start.values()) == pytest.approx(run.state()["q"], abs=1e-5)


def test_a_target_that_does_not_exist_cannot_be_moved():
    run = LiveRun(load_scenario("experiment_1"))
    with pytest.raises(ParameterError, match="q_xyzw: found a length of 2"):
        run.do(ask.PlaceTarget((0.0, 0.0, 0.2), (0.0, 0.0, 0.0, 2.0)))
