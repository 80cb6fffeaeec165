"""Runs, snapshots and resets of a world of several robots: the same bytes every time."""
import pytest

from aras_visual_servo_sim import ParameterError

from gazebo_ros.world.poses import matrix_of
from gazebo_ros.world.snapshot import digest, restore, saved
from gazebo_ros.world.world import World

INERTIAL = ("<inertial><mass value='1'/><inertia ixx='0.01' iyy='0.01' izz='0.01' ixy='0' ixz='0' iyz='0'/></inertial>")
#: An arm of two joints with a camera at its end; what it reaches is above the table.
ROBOT = """<robot name='r'><link name='world'/><link name='base'>%(i)s</link><link name='upper'>%(i)s
    <visual><origin xyz='0.2 0 0'/><geometry><box size='0.4 0.1 0.1'/></geometry></visual></link><link name='hand'>%(i)s
    <collision><geometry><sphere radius='0.05'/></geometry></collision></link>
  <joint name='w' type='fixed'><parent link='world'/><child link='base'/></joint>
  <joint name='a' type='revolute'><parent link='base'/><child link='upper'/><axis xyz='0 1 0'/>
    <limit lower='-2' upper='2' effort='50' velocity='5'/></joint>
  <joint name='b' type='revolute'><origin xyz='0.4 0 0'/><parent link='upper'/><child link='hand'/><axis xyz='0 1 0'/>
    <limit lower='-2' upper='2' effort='50' velocity='5'/></joint>
  <gazebo reference='hand'><sensor type='camera' name='eye'><update_rate>20</update_rate><camera>
    <horizontal_fov>1.0</horizontal_fov><image><width>40</width><height>30</height></image>
    <clip><near>0.02</near><far>20</far></clip></camera>
    <plugin name='p' filename='libgazebo_ros_camera.so'><cameraName>eye</cameraName></plugin></sensor></gazebo>
  <transmission name='t'><joint name='a'><hardwareInterface>PositionJointInterface</hardwareInterface></joint>
  </transmission><gazebo><plugin name='c' filename='libgazebo_ros_control.so'/></gazebo></robot>""" % {"i": INERTIAL}
TABLE = """<robot name='t'><link name='top'>%s<collision><geometry><box size='2 2 0.1'/></geometry></collision>
  <visual><geometry><box size='2 2 0.1'/></geometry></visual></link><gazebo><static>true</static></gazebo>
</robot>""" % INERTIAL
TRAJECTORY = {"type": "position_controllers/JointTrajectoryController", "joints": ["a"]}


def furnished():
    """Two robots at a table, the second spawned while time goes on."""
    world = World()
    world.spawn("table", TABLE, pose=matrix_of((0, 0, 0.2), (0, 0, 0, 1), "test"))
    for k, name in enumerate(("left", "right")):
        world.spawn(name, ROBOT, "/" + name, matrix_of((0, k - 0.5, 0.6), (0, 0, 0, 1), "test"))
        world.models[name].simulation.load_controller("arm", TRAJECTORY)
        world.models[name].simulation.switch_controllers(["arm"])
        world.step(50)
    return world


def worked(world, ticks=600):
    """Lets both robots move and look."""
    for name, goal in (("left", 0.4), ("right", -0.6)):
        world.models[name].simulation.pursue_trajectory("arm", ["a"], [(0.5, [goal], [0.0], [])])
    world.step(ticks // 2)
    world.core.step_to_image("left::eye")
    world.step(ticks // 2)
    return world


def test_two_runs_have_the_same_hash_and_another_run_has_another():
    first, second = worked(furnished()), worked(furnished())
    assert digest(first) == digest(second) and saved(first) == saved(second)
    assert digest(worked(furnished(), 602)) != digest(first)


def test_a_hand_comes_to_rest_on_the_table_of_another_model():
    world = furnished()
    world.step(3000)  # joint b has no controller: the hand hangs down, the arm is held
    for name in ("left", "right"):
        assert world.models[name].link_pose("hand")[2, 3] == pytest.approx(0.6, abs=1e-3)
    for name in ("left", "right"):
        world.models[name].simulation.pursue_trajectory("arm", ["a"], [(1.0, [1.0], [0.0], [])])
    world.step(4000)
    for name in ("left", "right"):  # 0.34 m further down but for the table, whose top is at 0.25
        assert world.models[name].link_pose("hand")[2, 3] == pytest.approx(0.25 + 0.05, abs=1e-3)


def test_a_world_that_gets_its_state_back_goes_on_with_the_same_bytes():
    world = worked(furnished())
    state = saved(world)
    there = saved(worked(world))
    restore(world, state)
    assert saved(world) == state and saved(worked(world)) == there


def test_models_that_have_come_and_gone_are_as_they_were():
    world = World()
    world.spawn("table", TABLE)
    world.spawn("box", TABLE.replace("<gazebo><static>true</static></gazebo>", ""),
                pose=matrix_of((0, 0, 1), (0, 0, 0, 1), "test"))
    world.step(100)
    state = saved(world)
    there = (world.step(1500), saved(world))[1]
    world.delete("table")
    world.spawn("other", TABLE)
    world.delete_light("sun")
    restore(world, state)
    assert list(world.models) == ["table", "box"] and list(world.lights) == ["sun"]
    world.step(1500)
    assert saved(world) == there


def test_a_reset_repeats_the_run():
    world = World()
    world.spawn("left", ROBOT, pose=matrix_of((0, 0, 0.6), (0, 0, 0, 1), "test"))
    world.spawn("table", TABLE)
    world.step(700)
    once = digest(world)
    world.reset_simulation()
    assert world.time_ns == 0
    world.step(700)
    assert digest(world) == once


def test_bytes_that_are_no_state_are_refused_and_nothing_changes():
    world = furnished()
    before = saved(world)
    for state in (b"", b"[]", b'{"format": "other"}'):
        with pytest.raises(ParameterError, match="no state of a world"):
            restore(world, state)
    with pytest.raises(ParameterError, match="restore_state"):
        restore(world, before.replace(b'"state": "', b'"state": "AAAA', 1))
    assert saved(world) == before
