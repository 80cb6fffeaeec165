"""Contacts between models that move: things lie on each other, and robots push them."""
import numpy
import pytest

from gazebo_ros.world.poses import matrix_of
from gazebo_ros.world.snapshot import digest, restore, saved
from gazebo_ros.world.world import World

INERTIAL = """<inertial><mass value='%g'/>
  <inertia ixx='0.01' iyy='0.01' izz='0.01' ixy='0' ixz='0' iyz='0'/></inertial>"""
BOX = "<robot name='b'><link name='l'>" + INERTIAL % 1.0 + """<collision><origin xyz='0 0 0.1'/>
  <geometry><box size='0.2 0.2 0.2'/></geometry></collision></link></robot>"""
#: A plate on a slide, in the way of what lies before it.
PUSHER = ("<robot name='p'><link name='world'/><link name='plate'>" + INERTIAL % 5.0 + """
    <collision><origin xyz='0 0 0.1'/><geometry><box size='0.1 0.4 0.1'/></geometry></collision></link>
  <joint name='slide' type='prismatic'><parent link='world'/><child link='plate'/><axis xyz='1 0 0'/>
    <limit lower='-2' upper='2' effort='500' velocity='2'/></joint>
  <transmission name='t'><joint name='slide'><hardwareInterface>PositionJointInterface</hardwareInterface></joint>
  </transmission></robot>""")
SINKS_M = 2e-3  #: a contact gives way by the weight over its stiffness, and the boxes settle


def at(x=0.0, y=0.0, z=0.0):
    return matrix_of((x, y, z), (0, 0, 0, 1), "test")


def pushed(world, to_m=0.5):
    simulation = world.models["pusher"].simulation
    simulation.load_controller("c", {"type": "position_controllers/JointTrajectoryController", "joints": ["slide"]})
    simulation.switch_controllers(["c"])
    simulation.pursue_trajectory("c", ["slide"], [(1.0, [to_m], [0.0], [])])
    world.step(1500)


def position(world, name):
    return world.models[name].pose()[:3, 3]


def test_boxes_lie_on_each_other():
    world = World()
    for name, z in (("low", 0.0), ("high", 0.3)):
        world.spawn(name, BOX, pose=at(z=z))
    world.step(2000)
    assert position(world, "low")[2] == pytest.approx(0.0, abs=SINKS_M)
    assert position(world, "high") == pytest.approx([0.0, 0.0, 0.2], abs=SINKS_M)


def test_a_robot_pushes_a_box_over_the_ground_and_stops_where_it_stops():
    world = World()
    world.spawn("box", BOX, pose=at(x=0.4))
    world.spawn("pusher", PUSHER)
    pushed(world)
    assert world.models["pusher"].simulation.joint_positions[0] == pytest.approx(0.5, abs=1e-3)
    assert position(world, "box") == pytest.approx([0.65, 0.0, 0.0], abs=2e-2), "half a plate and half a box further"
    assert world.models["box"].link_pose("l")[:3, 3] == pytest.approx(position(world, "box"))


def test_a_thing_goes_on_falling_when_its_robot_is_deleted_and_is_pushed_by_the_next():
    world = World()
    world.spawn("pusher", PUSHER)
    world.spawn("box", BOX, pose=at(x=0.4, z=0.5))
    world.step(100)
    speed = world.models["box"].twist()[2]
    assert speed == pytest.approx(-0.98, rel=2e-2)
    world.delete("pusher")
    assert world.models["box"].twist()[2] == pytest.approx(speed)
    world.step(1500)
    world.spawn("pusher", PUSHER)
    pushed(world)
    assert position(world, "box")[0] == pytest.approx(0.65, abs=2e-2)


def test_a_thing_that_is_placed_stays_there_and_one_that_is_thrown_flies():
    world = World()
    world.spawn("pusher", PUSHER)
    world.spawn("box", BOX, pose=at(x=1.0))
    world.models["box"].place(at(x=0.4), numpy.zeros(6))
    world.step(500)
    assert position(world, "box")[0] == pytest.approx(0.4, abs=SINKS_M)
    world.models["box"].place(at(x=0.4, z=1.0), numpy.array((1.0, 0, 0, 0, 0, 0)))
    world.step(200)
    assert position(world, "box")[0] == pytest.approx(0.6, abs=SINKS_M)


def test_resets_and_snapshots_hold_for_things():
    world = World()
    world.spawn("pusher", PUSHER)
    world.spawn("box", BOX, pose=at(x=0.4))
    world.spawn("other", BOX, pose=at(x=0.4, z=0.25))
    world.step(300)
    state = saved(world)
    there = (world.step(700), saved(world))[1]
    restore(world, state)
    world.step(700)
    assert saved(world) == there
    once = digest(world)
    world.reset_simulation()
    world.step(1000)
    assert digest(world) == once
    world.reset_world()
    assert position(world, "other") == pytest.approx([0.4, 0.0, 0.25])
    world.step(1000)
    assert position(world, "other")[2] == pytest.approx(0.2, abs=SINKS_M)
