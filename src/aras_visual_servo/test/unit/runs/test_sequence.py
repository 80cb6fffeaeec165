"""The experiment as a state machine, on the true arm with exact pictures."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from toy_plant import arm, Camera, GOAL, PERIOD_NS, pose_error, START

from aras_visual_servo import ExperimentSequence, FEATURE_NAMES, Observation, ParameterError, Servo, StampPairer, Status
from aras_visual_servo.config.plugins import run_text
from aras_visual_servo.ground.types import PHASES
from aras_visual_servo.runs.sequence import HOLD_PER_S, STRAY

FINAL_POSITION_M = 1e-5  # wanted; thresholds of 1 um leave below 2 um
EXPERIMENT = {"goal": {"joints": GOAL}, "start": {"joints": START}, "z_star_m": 0.5934, "settle_s": 0.5,
              "judge": {"x_mm": 1.0, "y_mm": 1.0, "z_mm": 1.0, "angle_deg": 1.0}}  # fmt: skip
SERVO = {
    "law": "decoupled",
    "mode": "continuous",
    "gains_per_s": dict.fromkeys(FEATURE_NAMES, 3.0),
    "thresholds": dict.fromkeys(FEATURE_NAMES, 1e-6),
    "time_limit_s": 20.0,
}


class Stage:
    """The loop that a simulator, a camera and a node would close."""

    def __init__(self, teach_camera=None, **changes):
        self.arm = arm()
        X_WT = np.eye(4)
        X_WT[:3, 3] = [-0.03, 0.05, 0.19]
        self.camera = Camera(X_WT)
        self.servo = Servo(self.arm, SERVO)
        self.asked, self.areas = [], {}
        experiment = {**EXPERIMENT, **changes}
        self.sequence = ExperimentSequence(self.arm, self.servo, experiment, teach_camera or self.teach_camera)
        self.set_point, self.stamp_ns = np.zeros(6), 0
        self.hidden_in = ()
        self.records, self.set_points = [], []

    def teach_camera(self, stamp_ns, z_star_m):
        self.asked.append((stamp_ns, z_star_m))
        self.camera.star = (z_star_m, self.areas[stamp_ns])

    def step(self):
        features = self.camera.features(self.arm.pose(self.set_point))
        self.areas[self.stamp_ns] = features.area
        features.target_visible = self.sequence.phase not in self.hidden_in
        command, record = self.sequence.step(Observation(self.stamp_ns, features, self.set_point.copy()))
        self.records.append(record)
        for i, name in enumerate(self.arm.joint_names):
            self.set_point[i] = command.position.get(name, self.set_point[i])
        self.set_points.append(self.set_point.copy())
        for i, name in enumerate(self.arm.joint_names):
            self.set_point[i] += command.velocity.get(name, 0.0) * 1e-9 * PERIOD_NS
        self.stamp_ns += PERIOD_NS
        return command, record

    def run(self, steps=600):
        for _ in range(steps):
            self.step()
            if self.sequence.done:
                break
        return self.sequence.result

    def phases(self):
        seen = []
        for record in self.records:
            if not seen or seen[-1] != record.phase:
                seen.append(record.phase)
        return seen


def test_experiment_goes_through_its_phases_and_ends_at_the_true_goal():
    stage = Stage()
    stage.sequence.start()
    result = stage.run()
    assert stage.phases() == list(PHASES[1:])
    assert result.converged and result.status == Status.CONVERGED
    assert stage.asked == [(stage.sequence.teach_stamp_ns, 0.5934)]
    X_WG = stage.arm.pose(stage.arm.vector(GOAL))
    assert pose_error(X_WG, stage.arm.pose(stage.set_point))[0] < FINAL_POSITION_M
    assert np.abs(result.e).max() < 1e-6
    first = next(record for record in stage.records if record.phase == "servo")
    assert stage.sequence.servo_stamp_ns == first.stamp_ns
    assert result.duration_s == pytest.approx(1e-9 * (stage.records[-1].stamp_ns - first.stamp_ns))


def test_the_arm_is_at_the_goal_when_taught_and_at_the_start_when_servoing_begins():
    stage = Stage()
    stage.sequence.start()
    stage.run()
    by_phase = {}
    for record in stage.records:
        by_phase.setdefault(record.phase, record)
    np.testing.assert_allclose(by_phase["teach"].q, stage.arm.vector(GOAL), atol=1e-12)  # rounding
    np.testing.assert_allclose(by_phase["servo"].q, stage.arm.vector(START), atol=1e-12)
    assert by_phase["teach"].stamp_ns == stage.sequence.teach_stamp_ns
    settled = by_phase["teach"].stamp_ns - by_phase["settle_goal"].stamp_ns
    assert 0.5e9 <= settled <= 0.5e9 + 2 * PERIOD_NS


def test_set_points_move_within_the_speed_allowed_and_never_jump():
    stage = Stage()
    stage.sequence.start()
    stage.run()
    steps = np.abs(np.diff(stage.set_points, axis=0)) / (1e-9 * PERIOD_NS)
    phases = [record.phase for record in stage.records[1:]]
    moving = np.array([phase.startswith("to_") for phase in phases])
    assert steps[moving].max() <= 0.3 * 5.0
    assert steps.max() <= 5.0


def test_idle_sequence_acknowledges_and_commands_nothing():
    command, record = Stage().step()
    assert command.position == {} and command.velocity == {}
    assert (record.phase, record.status) == ("idle", Status.IDLE)


def test_finished_sequence_holds_the_joints_where_the_servo_arrived():
    stage = Stage()
    stage.sequence.start()
    stage.run()
    last = stage.records[-1]
    assert last.phase == "done" and last.converged
    command, record = stage.step()
    assert command.position == {}
    back = HOLD_PER_S * (last.q - record.q)  # to where the joints were when the servo arrived
    np.testing.assert_allclose([command.velocity[name] for name in last.joint_names], back, atol=1e-12)
    held = last.q.copy()
    stage.set_point = held + 0.9 * STRAY
    command, _ = stage.step()
    np.testing.assert_allclose(list(command.velocity.values()), -0.9 * STRAY * HOLD_PER_S, atol=1e-9)
    stage.set_point = held + 1.1 * STRAY  # somebody else moves the arm
    assert set(stage.step()[0].velocity.values()) == {0.0}
    stage.set_point = held.copy()
    assert stage.step()[0].velocity == {}
    assert (record.phase, record.status) == ("done", Status.CONVERGED)


@pytest.mark.parametrize("phase, reason", [("settle_goal", "at the goal"), ("settle_start", "at the start")])
def test_target_out_of_view_ends_the_experiment_with_the_reason(phase, reason):
    stage = Stage()
    stage.hidden_in = (phase,)
    stage.sequence.start()
    result = stage.run()
    assert result.status == Status.TARGET_LOST and not result.converged
    assert reason in result.reason


def test_failing_teach_ends_the_experiment_with_its_reason():
    def refuse(stamp_ns, z_star_m):
        raise ValueError("camera node does not answer")

    stage = Stage(refuse)
    stage.sequence.start()
    result = stage.run()
    assert result.status == Status.FAULT and "camera node does not answer" in result.reason
    assert stage.servo.reference is None


def test_an_error_of_own_code_while_the_goal_is_taught_names_file_and_line():
    own = run_text("def refuse(stamp_ns, z_star_m):\n    return {}['speed']\n", "own")
    stage = Stage(own.refuse)
    stage.sequence.start()
    result = stage.run()
    assert result.status == Status.FAULT and "own.py:2: KeyError: 'speed'" in result.reason


def test_a_view_is_taught_by_its_stamp_after_later_ones_came():
    stage = Stage()
    seen = {}
    for gantry in (0.0, 0.02, 0.04):
        stage.set_point[:] = stage.arm.vector({**GOAL, "gantry": gantry})
        seen[stage.stamp_ns] = (stage.camera.features(stage.arm.pose(stage.set_point)), stage.set_point.copy())
        stage.step()
    stamp_ns = PERIOD_NS
    features, q = seen[stamp_ns]
    stage.sequence.teach(stamp_ns, features, q)
    assert stage.asked == [(stamp_ns, 0.5934)] and stage.camera.star == (0.5934, features.area)
    np.testing.assert_allclose(stage.servo.reference.s_star[:3], [0.5934 * features.xg, 0.5934 * features.yg, 0.5934])


def test_a_view_that_is_not_fit_changes_neither_the_servo_nor_the_camera():
    stage = Stage()
    features = stage.camera.features(stage.arm.pose(stage.set_point))
    features.valid = False
    with pytest.raises(ParameterError, match="teach"):
        stage.sequence.teach(0, features, stage.set_point)
    assert stage.asked == [] and stage.servo.reference is None


def test_servo_only_goes_to_the_view_taught_last():
    stage = Stage()
    stage.sequence.start()
    stage.run()
    stage.set_point = stage.arm.vector(START).copy()
    stage.records.clear()
    stage.sequence.start(servo_only=True)
    assert stage.run().converged
    assert stage.phases() == ["servo", "done"]


def test_servo_only_without_a_reference_is_refused():
    with pytest.raises(ParameterError, match="no reference"):
        Stage().sequence.start(servo_only=True)


@pytest.mark.parametrize("steps", [5, 20, 50, 100])
def test_stop_ends_in_any_phase_without_a_jump(steps):
    stage = Stage()
    stage.sequence.start()
    for _ in range(steps):
        stage.step()
    command, record = stage.sequence.stop(stage.stamp_ns, "asked to")
    assert stage.sequence.result.status == Status.STOPPED == record.status
    assert all(value == 0.0 for value in command.velocity.values()) and len(command.velocity) == 6
    for name, value in command.position.items():
        here = stage.set_point[stage.arm.joint_names.index(name)]
        assert value == pytest.approx(here, abs=1e-12)  # rounding of the secant velocity


def test_joint_position_that_is_not_finite_is_a_fault():
    stage = Stage()
    stage.sequence.start()
    stage.step()
    command, record = stage.sequence.step(Observation(stage.stamp_ns, None, np.full(6, np.nan)))
    assert record.status == Status.FAULT
    assert np.isfinite(list(command.position.values())).all()


def test_joints_that_do_not_rest_are_not_waited_for_forever():
    stage = Stage(settle_limit_s=1.0)
    stage.sequence.start()
    rng = np.random.default_rng(5)
    for _ in range(120):
        stage.set_point += rng.normal(0.0, 1e-3, 6)  # 0.03 rad/s of shaking
        stage.step()
    by_phase = {}
    for record in stage.records:
        by_phase.setdefault(record.phase, record.stamp_ns)
    assert by_phase["teach"] - by_phase["settle_goal"] == pytest.approx(1.5e9, abs=2 * PERIOD_NS)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("phase", ["settle_goal", "settle_start"])
@pytest.mark.parametrize("off, held", [(0.0499, False), (0.0501, True)])
def test_a_joint_that_is_held_on_its_way_ends_the_experiment_with_its_name(phase, sign, off, held):
    stage = Stage()
    stage.sequence.start()
    for _ in range(600):
        stage.step()
        if stage.sequence.done:
            break
        if stage.sequence.phase == phase:
            end = GOAL if phase == "settle_goal" else START
            stage.set_point[stage.arm.joint_names.index("J3")] = end["J3"] + sign * off
    result = stage.sequence.result
    assert (result.status == Status.FAULT) is held
    if held:
        assert f"{phase}: joint 'J3'" in result.reason and "0.05" in result.reason
        assert all(velocity == 0.0 for velocity in stage.sequence.stop(stage.stamp_ns)[0].velocity.values())


def test_configuration_lists_every_fault():
    bad = {"goal": {"joints": {"gantry": 9.0, "J9": 0.0}}, "z_star_m": 0.0, "hurry": True}
    with pytest.raises(ParameterError) as caught:
        Stage(**{**bad, "start": {"pose": {}}})
    text = str(caught.value)
    for part in ("gantry: found 9.0", "J9: found", "z_star_m: found 0.0", "hurry: found", "pose: found"):
        assert part in text


CAPACITY = 5
STAMPS = st.integers(0, 12) | st.integers(-2**63, 2**63)


@settings(deadline=None, max_examples=1000, derandomize=True)
@given(st.lists(st.tuples(st.booleans(), STAMPS), max_size=60))
def test_each_features_message_is_handed_out_once_with_the_joints_of_its_stamp(messages):
    pairer, handed = StampPairer(CAPACITY), []
    for n, (is_features, stamp_ns) in enumerate(messages):
        add, what = (pairer.add_features, n) if is_features else (pairer.add_joints, ("joints of", stamp_ns))
        pairs = add(stamp_ns, what)
        for stamp, features, joints in pairs:
            handed.append(features)
            assert messages[features] == (True, stamp) and joints in (None, ("joints of", stamp))
    assert handed == sorted(set(handed)), "each once, in the order in which they came"
    if not pairer.restarts:
        given_ = [n for n, (is_features, _) in enumerate(messages) if is_features]
        assert handed == given_[:len(handed)] and len(given_) - len(handed) <= CAPACITY


def test_features_that_no_joint_state_answers_do_not_pile_up():
    pairer = StampPairer(CAPACITY)
    pairs = [pair for k in range(1000) for pair in pairer.add_features(k, "seen")]
    assert pairs == [(k, "seen", None) for k in range(1000 - CAPACITY)]
