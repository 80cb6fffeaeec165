"""Joint states and commands of an arm from a bag, and the bags that `identify` refuses without writing anything."""
import numpy as np
import pytest
import rosbag
import rospy
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64, Float64MultiArray
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from aras_visual_servo import ParameterError
from aras_visual_servo.cli.main import main
from aras_visual_servo_controller.bags.any_bag import AnyBag
from aras_visual_servo_controller.bags.joint_log import read_joint_log

NAMES = ("J1", "J2")
CONTROLLERS = {"c1": {"type": "velocity_controllers/JointVelocityController", "joint": "J1"},
               "c2": {"type": "velocity_controllers/JointVelocityController", "joint": "J2"}}
TIMES = 100.0 + 0.01 * np.arange(300)


def at(t):
    return rospy.Time.from_sec(float(t))


def state(t, position, names=NAMES, **values):
    message = JointState(name=list(names), position=list(position), **values)
    message.header.stamp = at(t)
    return message


def states(topic="/arm/joint_states", times=TIMES, scale=1.0, names=NAMES):
    return [(topic, state(t, scale * np.sin(t) * np.arange(1, len(names) + 1), names), t + 0.004) for t in times]


def write(path, messages):
    with rosbag.Bag(str(path), "w") as bag:
        for topic, message, t in sorted(messages, key=lambda each: each[2]):
            bag.write(topic, message, at(t))
    return str(path)


def log(path, step_s=0.001, **options):
    with AnyBag(path) as bag:
        return read_joint_log(bag, NAMES, CONTROLLERS, step_s=step_s, **options)


def test_states_in_any_order_of_joints_and_commands_of_each_form(tmp_path):
    swapped = [("/arm/joint_states", state(t, (2.0 * t, t), ("J2", "J1"), velocity=[4.0, 3.0]), t + 0.004)
               for t in TIMES]
    swapped.append(("/arm/joint_states", state(TIMES[5], (2.0 * TIMES[5], TIMES[5]), ("J2", "J1"), velocity=[4.0, 3.0]),
                    TIMES[5] + 0.005))  # sent again with an image
    floats = [("/arm/c1/command", Float64(0.5), 100.1), ("/arm/c2/command", Float64(-0.5), 100.2)]
    found = log(write(tmp_path / "a.bag", swapped + floats))
    np.testing.assert_allclose(found.times_s, TIMES)
    np.testing.assert_allclose(found.position, np.column_stack([TIMES, 2.0 * TIMES]))
    np.testing.assert_allclose(found.velocity[0], (3.0, 4.0))
    np.testing.assert_allclose(found.received_s - found.times_s, 0.004, atol=2e-3)
    assert found.kind == "velocity" and found.told.tolist() == [[0.5, 0.0], [0.5, -0.5]] and found.effort is None
    array = [("/arm/group/command", Float64MultiArray(data=[0.1, 0.2]), 100.3)]
    assert log(write(tmp_path / "b.bag", states() + array)).told.tolist() == [[0.1, 0.2]]
    told = JointState(name=["J2"], position=[0.7])
    told.header.stamp = at(100.5)
    found = log(write(tmp_path / "c.bag", states() + [("/arm/joint_command", told, 100.5)]))
    assert (found.kind, found.told[0, 1]) == ("position", 0.7) and found.told[0, 0] == found.position[0, 0]


def test_a_trajectory_is_interpolated_from_where_the_arm_is(tmp_path):
    message = JointTrajectory(joint_names=["J2", "J1"])
    message.points = [JointTrajectoryPoint(positions=[4.0, 2.0], time_from_start=rospy.Duration(1.0))]
    rest = [("/arm/joint_states", state(t, (1.0, 2.0)), t) for t in TIMES]
    found = log(write(tmp_path / "t.bag", rest + [("/arm/arm_controller/command", message, 101.0)]))
    half = found.told[np.argmin(np.abs(found.told_s - 101.5))]
    np.testing.assert_allclose(half, (1.5, 3.0), atol=0.01)
    np.testing.assert_allclose(found.told[-1], (2.0, 4.0))


def test_a_trajectory_goes_through_its_velocities_and_waits_where_the_arm_was_told_to_be(tmp_path):
    message = JointTrajectory(joint_names=["J1", "J2"])
    message.points = [JointTrajectoryPoint(positions=[1.0, 2.0 + 3.0 * k], velocities=[0.0, 0.0],
                                           time_from_start=rospy.Duration(1.0 + k)) for k in range(2)]

    def told(sagged):
        rest = [("/arm/joint_states", state(t, (1.0, 2.0 + sagged)), t) for t in TIMES]
        name = f"{sagged}.bag"
        found = log(write(tmp_path / name, rest + [("/arm/arm_controller/command", message, 100.5)]))
        return found.told_s, found.told
    times, values = told(0.02)
    np.testing.assert_allclose(values[times < 101.5], np.tile((1.0, 2.0), (np.count_nonzero(times < 101.5), 1)),
                               atol=2e-5)
    part = np.clip(times + 0.0005 - 101.5, 0.0, 1.0)
    np.testing.assert_allclose(values[:, 1], 2.0 + 3.0 * part**2 * (3.0 - 2.0 * part), atol=1e-5)
    times, values = told(0.2)
    assert times[0] == pytest.approx(101.5) and values[-1].tolist() == [1.0, 5.0]


@pytest.mark.parametrize("step_s", (0.001, 0.004))
def test_a_simulator_gets_a_set_point_of_a_trajectory_in_each_of_its_periods(tmp_path, step_s):
    message = JointTrajectory(joint_names=["J1", "J2"])
    message.points = [JointTrajectoryPoint(positions=[0.0, 0.0], time_from_start=rospy.Duration(0.0)),
                      JointTrajectoryPoint(positions=[1.0, 2.0], time_from_start=rospy.Duration(1.0))]
    found = log(write(tmp_path / "t.bag", states() + [("/arm/arm_controller/command", message, 101.0)]), step_s=step_s)
    np.testing.assert_allclose(np.diff(found.told_s), step_s, rtol=1e-3)
    ways = np.diff(found.told[:-1], axis=0)
    np.testing.assert_allclose(ways, np.tile((step_s, 2.0 * step_s), (len(ways), 1)), rtol=1e-6)


def test_two_arms_and_other_joints_are_named(tmp_path):
    both = write(tmp_path / "two.bag", states("/left/joint_states") + states("/right/joint_states"))
    with pytest.raises(ParameterError, match="/left/joint_states, /right/joint_states"):
        log(both)
    assert len(log(both, joint_states="/left/joint_states").times_s) == len(TIMES)
    with pytest.raises(ParameterError, match="/arm/joint_states has J1, J3"):
        log(write(tmp_path / "other.bag", states(names=("J1", "J3"))))


@pytest.mark.parametrize("messages, words", [
    (lambda names: states(names=names), "commands: found none"),
    (lambda names: states(names=names, scale=1.0, times=TIMES + 5.0 * (TIMES > 101.0)), "clock jump"),
    (lambda names: states(names=names, scale=40.0), "rad, not degrees"),
    (lambda names: states(names=("a", "b")), "/arm/joint_states has a, b"),
    (lambda names: [("/clock", Float64(1.0), 1.0)], "no topic has joint states"),
    (lambda names: states("/left/joint_states", names=names) + states("/right/joint_states", names=names),
     "choose it with --joint-states"),
    (lambda names: [(topic, state(t - 2.0 * (t > 102.0), message.position, names), at_)
                    for (topic, message, at_), t in zip(states(names=names), TIMES)], "allowed increasing stamps"),
    (lambda names: states(names=names, scale=1e-5) + [
        ("/arm/joint_command", state(t, np.zeros(5), names), t) for t in TIMES], "position: found motions of at most")])
def test_bad_bags_are_named_and_nothing_is_written(tmp_path, capsys, messages, words):
    names = ("elbow_flex", "shoulder_lift", "shoulder_pan", "wrist_flex", "wrist_roll")
    path = write(tmp_path / "bad.bag", messages(names))
    assert main(["identify", path, "--robot", "so101", "--out", str(tmp_path / "out")]) == 2
    assert words in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
