"""Contacts between robots, and of a robot with itself."""
import xml.etree.ElementTree as ElementTree

import numpy
import pytest

from gazebo_ros.world.poses import matrix_of
from gazebo_ros.world.snapshot import digest, restore, saved
from gazebo_ros.world.world import World

INERTIAL = """<inertial><origin xyz='%s'/><mass value='1'/>
  <inertia ixx='0.02' iyy='0.02' izz='0.02' ixy='0' ixz='0' iyz='0'/></inertial>"""
#: An arm whose link swings about a vertical axis; a hand at its end can be bent back along it.
ARM = ("<robot name='arm'><link name='world'/><link name='base'>" + INERTIAL % "0 0 0" + """</link>
  <joint name='foot' type='fixed'><parent link='world'/><child link='base'/></joint>
  <link name='upper'>""" + INERTIAL % "0.25 0 0" + """<collision><origin xyz='0.25 0 0'/>
    <geometry><box size='0.5 0.1 0.1'/></geometry></collision></link>
  <joint name='shoulder' type='revolute'><parent link='base'/><child link='upper'/><origin xyz='0 0 0.5'/>
    <axis xyz='0 0 1'/><limit lower='-3' upper='3' effort='20' velocity='2'/></joint>
  <link name='wrist'>""" + INERTIAL % "0.1 0 0" + """</link>
  <joint name='elbow' type='revolute'><parent link='upper'/><child link='wrist'/><origin xyz='0.6 0 0'/>
    <axis xyz='0 0 1'/><limit lower='-3.1' upper='3.1' effort='20' velocity='2'/></joint>
  <link name='hand'>""" + INERTIAL % "0.1 0 0" + """<collision><origin xyz='0.1 0 0'/>
    <geometry><box size='0.3 0.06 0.06'/></geometry></collision></link>
  <joint name='twist' type='revolute'><parent link='wrist'/><child link='hand'/><origin xyz='0.15 0 0'/>
    <axis xyz='1 0 0'/><limit lower='-3.1' upper='3.1' effort='20' velocity='2'/></joint>
  <transmission name='t'><joint name='shoulder'><hardwareInterface>EffortJointInterface</hardwareInterface></joint>
  </transmission><transmission name='u'><joint name='elbow'><hardwareInterface>EffortJointInterface</hardwareInterface>
  </joint></transmission>{more}</robot>""")
#: A free robot of two links.
ROVER = ("<robot name='rover'><link name='body'>" + INERTIAL % "0 0 0" + """<collision>
  <geometry><box size='0.3 0.3 0.2'/></geometry></collision></link>
  <link name='head'>""" + INERTIAL % "0 0 0" + """</link><joint name='neck' type='revolute'><parent link='body'/>
  <child link='head'/><origin xyz='0 0 0.1'/><axis xyz='0 0 1'/><limit lower='-1' upper='1' effort='9' velocity='1'/>
  </joint></robot>""")
BALL = ("<robot name='ball'><link name='l'>" + INERTIAL % "0 0 0" +
        "<collision><geometry><sphere radius='0.1'/></geometry></collision></link></robot>")
SELF = "".join("<gazebo reference='%s'><selfCollide>true</selfCollide></gazebo>" % link for link in ("upper", "hand"))
SINKS_M = 1e-3


def at(x=0.0, y=0.0, z=0.0):
    return matrix_of((x, y, z), (0, 0, 0, 1), "test")


def drive(world, name, joint, effort):
    simulation = world.models[name].simulation
    simulation.load_controller(joint, {"type": "effort_controllers/JointEffortController", "joint": joint})
    simulation.switch_controllers([joint])
    simulation.set_controller_command(joint, effort)


def angle(world, name, joint):
    simulation = world.models[name].simulation
    return simulation.joint_positions[simulation.joint_names.index(joint)]


def stiff():
    """The arm with an elbow that does not bend."""
    robot = ElementTree.fromstring(ARM.format(more=""))
    robot.find("joint[@name='elbow']").set("type", "fixed")
    robot.remove(robot.find("transmission[@name='u']"))
    return ElementTree.tostring(robot, encoding="unicode")


def two_arms():
    world = World()
    world.spawn("left", stiff())
    world.spawn("right", stiff(), pose=at(y=0.6))
    return world


def test_an_arm_that_swings_into_another_pushes_it_and_does_not_go_through():
    world = two_arms()
    drive(world, "right", "shoulder", 0.0)  # without a controller it would be held
    drive(world, "left", "shoulder", 3.0)
    world.step(1500)
    assert angle(world, "left", "shoulder") > 0.2
    assert abs(angle(world, "right", "shoulder")) > 0.05, "it is pushed"
    alone = World()
    alone.spawn("left", stiff())
    drive(alone, "left", "shoulder", 3.0)
    alone.step(1500)
    assert angle(alone, "left", "shoulder") > angle(world, "left", "shoulder") + 0.5


def test_a_robot_that_is_dropped_rests_on_another():
    world = World()
    world.spawn("low", ROVER, pose=at(z=0.1))
    world.spawn("high", ROVER, pose=at(x=0.05, z=0.5))
    world.step(2000)
    assert world.models["low"].pose()[2, 3] == pytest.approx(0.1, abs=SINKS_M)
    assert world.models["high"].pose()[:3, 3] == pytest.approx((0.05, 0.0, 0.3), abs=SINKS_M)


def test_a_thing_rests_on_any_robot_and_one_that_was_thrown_is_stopped_by_them():
    world = World()
    world.spawn("near", ARM.format(more=""), pose=at(x=5.0))
    world.spawn("ball", BALL, pose=at(x=5.0, y=0.0, z=2.0))
    world.spawn("low", ROVER, pose=at(z=0.1))
    world.models["ball"].place(at(x=-2.0, z=0.12), numpy.array((3.0, 0, 0, 0, 0, 0)))
    world.step(2000)
    assert world.models["ball"].pose()[0, 3] < 0.0, "the rover is in its way"
    assert world.models["low"].pose()[0, 3] > 1e-4, "which it pushed"
    world.models["ball"].place(at(x=0.3, z=2.0), numpy.zeros(6))
    world.spawn("box", BALL.replace("<sphere radius='0.1'/>", "<box size='0.1 0.1 0.1'/>"), pose=at(x=1.0, z=0.8))
    rover = world.models["low"].pose()[:3, 3]
    world.models["box"].place(at(rover[0], rover[1], 0.6), numpy.zeros(6))
    world.step(1000)
    assert world.models["box"].pose()[2, 3] == pytest.approx(0.25, abs=SINKS_M)


@pytest.mark.parametrize("more, stops", [(SELF, True), ("", False)])
def test_a_robot_touches_itself_if_it_says_so(more, stops):
    world = World()
    arm = world.spawn("arm", ARM.format(more=more))
    drive(world, "arm", "elbow", 0.5)
    world.step(2500)
    assert (angle(world, "arm", "elbow") < 2.95) == stops
    touching = {frozenset((each["a"], each["b"])) for each in arm.simulation.contacts}
    assert (frozenset(("upper", "hand")) in touching) == stops


def test_links_that_begin_in_each_other_are_named_and_left_alone():
    world = World()
    big = ARM.format(more=SELF).replace("0.3 0.06 0.06", "0.9 0.06 0.06")
    arm = world.spawn("arm", big)
    assert "links upper and hand are in each other where the model begins: they do not touch each other" in arm.warnings
    world.step(100)
    assert abs(angle(world, "arm", "elbow")) < 1e-6


def test_robots_that_touch_give_the_same_bytes_again_and_from_a_saved_state():
    digests = []
    for _ in range(2):
        world = two_arms()
        drive(world, "left", "shoulder", 3.0)
        while not world.models["left"].simulation.contacts:
            world.step()
            assert world.core.ticks < 1000
        state = saved(world)
        world.step(500)
        digests.append(digest(world))
    assert digests[0] == digests[1]
    restore(world, state)
    for _ in range(50):
        world.step(10)
    assert digest(world) == digests[0], "in other portions, from the saved state"


def test_robots_that_touch_nothing_move_as_they_do_alone():
    world = two_arms()
    world.models["right"].simulation.set_joint_positions({"shoulder": 2.0})
    drive(world, "left", "shoulder", -3.0)
    world.step(600)
    alone = World()
    alone.spawn("left", stiff())
    drive(alone, "left", "shoulder", -3.0)
    alone.step(600)
    assert world.models["left"].simulation.save_state() == alone.models["left"].simulation.save_state()
