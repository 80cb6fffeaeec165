"""The servo with laws that choose the joint velocities themselves: what is commanded, said and recorded."""

import numpy as np
import pytest
from bench import Bench, resting

from aras_visual_servo.ground.types import Status
from aras_visual_servo.servo.servo import Servo

WIDE = {"half_width": 0.8, "half_height": 0.6}
#: The object is larger than this view.
NARROW = {"half_width": 0.05, "half_height": 0.05, "margin": 0.0}
ROUNDING = 1e-9


@pytest.mark.parametrize("law", ["qp", "mpc"])
def test_the_camera_arrives_within_the_accelerations_of_the_joints(law):
    most = {"gantry": 0.5, "J1": 2.0, "J2": 2.0, "J3": 2.0, "J5": 2.0, "J6": 2.0}
    bench = Bench(law=law, limits={"joint_acceleration": most}, **{law: WIDE})
    names, before = bench.arm.joint_names, np.zeros(6)
    for _ in range(200):
        command, record = bench.step()
        if record.status != Status.SERVOING:
            break
        q_dot = np.array([command.velocity[name] for name in names])
        allowed = np.array([most[name] for name in names]) / 30.0
        assert (np.abs(q_dot - before) <= allowed + ROUNDING).all()
        np.testing.assert_allclose(record.twist, bench.arm.jacobian(record.q) @ q_dot, atol=ROUNDING)
        before = q_dot
    bench.run()
    assert bench.records[-1].status == Status.CONVERGED
    bench.assert_at_goal()
    assert any("held back by joint" in record.status_text for record in bench.records)


@pytest.mark.parametrize("law", ["qp", "mpc"])
def test_an_infeasible_program_is_a_status_with_its_slack_or_a_still_camera(law):
    command, record = Bench(law=law, **{law: NARROW}).step()
    assert record.status == Status.JOINT_LIMIT
    assert "infeasible, slack" in record.status_text and "point 1 at the left border by" in record.status_text
    command, record = Bench(law=law, **{law: {**NARROW, "slack": False}}).step()
    assert record.status == Status.JOINT_LIMIT and record.status_text.startswith("standing still")
    assert resting(command)


@pytest.mark.parametrize("law", ["qp", "mpc"])
@pytest.mark.parametrize("plane", [(0.0, 0.0, -1.0), (0.0, 0.0, np.nan)])
def test_a_depth_that_is_not_known_is_a_lost_target_and_a_still_camera(law, plane, monkeypatch):
    bench = Bench(law=law, **{law: WIDE})
    monkeypatch.setattr(Servo, "_plane", lambda servo, X_BC: plane)
    command, record = bench.step()
    assert record.status in (Status.TARGET_LOST, Status.FAULT) and resting(command)
    assert record.status_text


@pytest.mark.parametrize("law", ["qp", "mpc"])
def test_whatever_the_law_raises_the_arm_stands_still(law, monkeypatch):
    bench = Bench(law=law, **{law: WIDE})
    monkeypatch.setattr(bench.servo._law, "joint_velocity", lambda *arguments: 1 / 0)
    command, record = bench.step()
    assert record.status == Status.FAULT and "ZeroDivisionError" in record.status_text and resting(command)
