"""The in-process loop: the real simulator, extractor and sequence; no ROS."""

import numpy as np
import pytest

from aras_visual_servo import judge, load_scenario, ParameterError, RecordBuilder, ServoLoop
from aras_visual_servo.ground.types import PHASES
from aras_visual_servo_study.sweep.judge import trace_hash


@pytest.fixture(scope="module")
def record():
    return ServoLoop(load_scenario("experiment_1")).run()


def test_experiment_1_converges_and_passes_its_judge(record):
    judgement = judge(record)
    assert judgement.passed, judgement.faults


def test_goes_through_the_phases_in_order(record):
    order = list(dict.fromkeys(record.phase.tolist()))
    assert order == [phase for phase in PHASES if phase != "idle"]


def test_has_a_row_for_every_image_from_time_zero(record):
    assert record.stamp_ns[0] == 0
    assert np.all(np.diff(record.stamp_ns) <= 34_000_000)  # 30 Hz on ticks of 1 ms: 33 or 34 ms
    assert np.all(np.diff(record.stamp_ns) >= 33_000_000)


def test_another_seed_of_a_noisy_camera_gives_another_hash(record):
    noisy = {"sim.cameras": [dict(load_scenario("experiment_1").sim["cameras"][0], noise_stddev=1.0)]}
    hashes = set()
    for seed in (1, 2):
        loop = ServoLoop(load_scenario("experiment_1", {**noisy, "sim.seed": seed}))
        loop.start()
        for _ in range(3):
            loop.step()
        hashes.add(loop.sim.run_hash)
    assert len(hashes) == 2


def test_a_camera_of_sixteen_bits_serves_and_what_its_renderer_leaves_out_is_noted():
    scenario = load_scenario("experiment_1")
    camera = dict(scenario.sim["cameras"][0], encoding="mono16", sensor={"adc_bits": 12})
    lamp = {"name": "lamp", "sphere_m": 0.02, "position_m": [3, 3, 1], "material": {"emissive_rgb": [255, 255, 255]}}
    loop = ServoLoop(load_scenario("experiment_1", {"sim.cameras": [camera], "sim.scene.solids": [lamp]}))
    record = loop.run()
    assert loop.sim.render(loop.camera).dtype == np.uint16
    assert judge(record).passed, judge(record).faults
    assert record.initial_image.dtype == np.uint8 and np.ptp(record.initial_image) > 100
    assert len(record.notes) == 1 and "emissive of lamp" in record.notes[0]


@pytest.mark.parametrize("encoding", ("bgr8", "bayer_rggb8", "bayer_bggr8", "bayer_gbrg8", "bayer_grbg8"))
def test_a_camera_whose_images_are_not_rgb_shows_the_same_colours(encoding):
    """Before an orange ground, which the values of a pattern, or red taken for blue, would show as another grey."""
    scene = {"sim.scene.background_rgb": [250, 200, 70]}
    image = {}
    for name in ("rgb8", encoding):
        camera = dict(load_scenario("experiment_1").sim["cameras"][0], encoding=name)
        loop = ServoLoop(load_scenario("experiment_1", {**scene, "sim.cameras": [camera]}))
        loop.start()
        image[name] = np.array(loop.step()[2], dtype=int)
    assert image[encoding].shape == image["rgb8"].shape and np.ptp(image["rgb8"][..., 0] - image["rgb8"][..., 2]) > 150
    flat = np.abs(image[encoding] - image["rgb8"]).max(axis=2)
    assert flat.max() == 0 if encoding == "bgr8" else np.mean(flat > 1) < 0.02  # edges of the object alone differ
    if encoding == "bayer_rggb8":
        assert judge(loop.run()).passed


def test_gives_up_at_the_limit_of_simulated_time():
    record = ServoLoop(load_scenario("experiment_1")).run(limit_s=0.5)
    assert record.t_s[-1] < 0.6
    assert any("given up" in note for note in record.notes)


def test_idle_steps_command_nothing():
    loop = ServoLoop(load_scenario("experiment_1"))
    for _ in range(3):
        answer, features, image = loop.step()
        assert answer.phase == "idle"
        assert image.shape[:2] == (240, 320)
    assert loop.sim.refused_commands == 0


def late(latency_s):
    cameras = load_scenario("experiment_1").sim["cameras"]
    return load_scenario("experiment_1", {"sim.cameras": [dict(cameras[0], latency_s=latency_s)]})


def test_late_images_are_paired_with_the_joints_and_the_camera_of_their_stamp(record):
    loop = ServoLoop(late(0.08))
    loop.start()
    first_q = {}
    for _ in range(40):   # commands come later, so the arm starts later, and from the same place
        answer, _, _ = loop.step()
        assert loop.sim.time_ns == answer.stamp_ns + 80_000_000
        first_q[answer.stamp_ns] = answer.q
        np.testing.assert_array_equal(loop.sim.frame_state("camera")["stamp_ns"], answer.stamp_ns)
    np.testing.assert_array_equal(first_q[0], record.q[0])
    # What is commanded on the first image acts 80 ms later: until then the arm has not been told to move.
    moved = {stamp: np.abs(q - first_q[0]).max() for stamp, q in first_q.items()}
    prompt = next(t for t, q in zip(record.stamp_ns, record.q) if np.abs(q - record.q[0]).max() > 1e-2)
    assert next(stamp for stamp in moved if moved[stamp] > 1e-2) - prompt in (67_000_000, 66_000_000, 100_000_000)


def test_late_images_from_before_the_arm_was_placed_are_not_answered():
    scenario = late(0.1)
    loop = ServoLoop(scenario)
    loop.step()
    loop.place({"gantry": 0.2}, settle_s=0.05)
    placed_ns = loop.sim.time_ns
    answer, _, _ = loop.step()
    assert answer.stamp_ns >= placed_ns
    assert loop.camera_pose()[1, 3] == pytest.approx(loop.sim.camera_pose("camera")[1, 3], abs=1e-3)


def test_a_late_loop_converges_and_goes_on_for_the_closing_time():
    loop = ServoLoop(late(0.12))
    late_record = loop.run(closing_s=0.5)
    assert judge(late_record).passed, judge(late_record).faults
    done_ns = next(t for t, phase in zip(late_record.stamp_ns, late_record.phase) if phase == "done")
    assert loop.sim.time_ns == done_ns + 500_000_000
    assert late_record.stamp_ns[-1] <= loop.sim.time_ns - 120_000_000


def test_a_latency_that_the_controller_would_call_stale_is_refused():
    with pytest.raises(ParameterError, match=r"sim.cameras\[0\].latency_s: found 0.17, allowed .* 0.1647"):
        late(0.17)
    longest_s, = load_scenario("experiment_1").longest_latencies
    assert longest_s == pytest.approx(0.2 - 1.0 / 30.0 - 0.002) and late(longest_s).longest_latencies == (longest_s,)
    with pytest.raises(ParameterError, match="latency_s"):
        late(longest_s + 1e-6)


#: Scenarios of one extractor, and of two.
SHORT = {"experiment_1": {}, "six_dof_tag": {"servo.time_limit_s": 0.5},
         "six_dof_photometric": {"servo.time_limit_s": 0.3}}


@pytest.mark.parametrize("name", SHORT)
def test_a_loop_that_begins_again_gives_the_bytes_of_a_new_one(name):
    changes = {"experiment.settle_s": 0.1, **SHORT[name]}
    first, other = load_scenario(name, changes), load_scenario(name, {**changes, "experiment.settle_s": 0.2})
    loop = ServoLoop(first)
    whole = loop.run(closing_s=0.0, limit_s=4.0)
    for scenario in (other, first):
        loop.begin_again(scenario)
        again = loop.run(closing_s=0.0, limit_s=4.0)
        assert (again.run_hash == whole.run_hash) == (scenario is first)
    assert (again.run_hash, trace_hash(again)) == (whole.run_hash, trace_hash(whole))


def placed_run(loop, start, goal=None):
    """(hashes of the taught view and of twelve images after it, `TaughtGoal`) of a loop that has just begun."""
    config, builder = loop.sequence.config, RecordBuilder("placed", loop.kinematics.joint_names,
                                                          feature_names=loop.servo.feature_names)
    if goal is None:
        loop.place(config.goal.joints, 0.1)
        for answer in loop.teach(config.z_star_m):
            builder.add_answer(*answer)
        goal = loop.taught_goal()
    else:
        for answer in goal.answers:
            builder.add_answer(*answer)
    loop.place(start, 0.1)
    loop.start(servo_only=True)
    for _ in range(12):
        record, features, image = loop.step()
        builder.add_answer(record, loop.camera_pose(), features, image, loop.moving_target_pose())
    assert loop.frame == len(builder) - 1
    record = builder.finish(run_hash=loop.sim.run_hash)
    return (record.run_hash, trace_hash(record), record.raw.tobytes(), record.desired_image.tobytes()), goal


@pytest.mark.parametrize("name", SHORT)
def test_a_loop_goes_on_from_a_taught_goal_with_the_bytes_of_one_that_is_taught_it_again(name):
    scenario = load_scenario(name)
    start = ServoLoop(scenario).sequence.config.start.joints
    near = {joint: 0.98 * q for joint, q in start.items()}
    from_near = load_scenario(name, {"experiment.start": {"joints": near}})
    loop = ServoLoop(scenario)
    first, goal = placed_run(loop, start)
    loop.begin_again(from_near, goal)
    assert loop.sequence.config.start.joints == near
    assert placed_run(loop, near, goal)[0] == placed_run(ServoLoop(from_near), near)[0] != first
    loop.begin_again(scenario, goal)
    assert placed_run(loop, start, goal)[0] == first


def test_a_goal_that_needs_depth_images_or_many_is_not_kept():
    assert ServoLoop(load_scenario("experiment_1")).taught_goal() is None  # nothing was taught
    noisy = [dict(load_scenario("experiment_1").sim["cameras"][0], noise_stddev=2.0)]
    few, many = {"experiment.teach_images": 2}, {"sim.cameras": noisy, "experiment.teach_images": 3}
    for name, changes, images in (("six_dof_rgbd", few, 2), ("experiment_1", many, 3)):
        loop = ServoLoop(load_scenario(name, changes))
        loop.place(loop.sequence.config.goal.joints, 0.1)
        assert len(list(loop.teach(loop.sequence.config.z_star_m))) == images
        assert loop.taught_goal() is None


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_another_start_is_checked_as_the_first_one(sign):
    loop = ServoLoop(load_scenario("experiment_1"))
    loop.place(loop.sequence.config.goal.joints, 0.1)
    list(loop.teach(0.5))
    outside = load_scenario("experiment_1")
    outside.experiment["start"]["joints"]["gantry"] = sign * 1.6
    with pytest.raises(ParameterError, match=f"experiment.start.joints.gantry: found {sign * 1.6}, allowed .*1.5"):
        loop.begin_again(outside, loop.taught_goal())
