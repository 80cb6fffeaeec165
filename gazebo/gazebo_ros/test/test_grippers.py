"""Plugins that hold bodies: links that are attached, vacuum grippers, hands that do not let slip. Without ROS."""
import numpy
import pytest

from aras_visual_servo_sim import ArasError, ParameterError, UnknownNameError

from gazebo_ros.world import snapshot
from gazebo_ros.world.plugins.grasp_fix import Grasp, GraspFix
from gazebo_ros.world.plugins.vacuum_gripper import Suction
from gazebo_ros.world.poses import matrix_of_rpy
from gazebo_ros.world.world import World

MASS = "<inertial><mass value='%g'/><inertia ixx='%g' iyy='%g' izz='%g' ixy='0' ixz='0' iyz='0'/></inertial>"


def box(name, size, mass_kg=0.2):
    return ("<link name='%s'>%s<collision><geometry><box size='%g %g %g'/></geometry></collision></link>" %
            (name, MASS % (mass_kg, 1e-4, 1e-4, 1e-4), *size))


THING = "<robot name='thing'>%s</robot>" % box("body", (0.06, 0.06, 0.06))
STAND = ("<robot name='stand'><link name='world'/><joint name='j' type='fixed'><parent link='world'/>"
         "<child link='top'/></joint>%s</robot>" % box("top", (0.1, 0.1, 0.1)))


def at(x, y, z):
    return matrix_of_rpy((x, y, z), (0, 0, 0))


def height(world, model="thing"):
    return world.models[model].pose()[2, 3]


def test_a_link_that_is_attached_stays_where_it_is_until_it_is_let_go():
    world = World()
    world.spawn("stand", STAND, pose=at(0, 0, 1))
    world.spawn("thing", THING, pose=at(0.2, 0, 1))
    world.attach("stand::top", "thing::body")
    with pytest.raises(ParameterError):
        world.attach("thing::body", "stand::top")
    world.step(1000)
    assert world.models["thing"].pose()[:3, 3] == pytest.approx((0.2, 0.0, 1.0), abs=1e-4)
    assert world.is_attached("thing::body", "stand::top")
    world.detach("thing::body", "stand::top")
    world.step(300)
    assert height(world) == pytest.approx(1.0 - 0.5 * 9.8 * 0.3 ** 2, abs=5e-3)
    with pytest.raises(UnknownNameError):
        world.detach("stand::top", "thing::body")
    with pytest.raises(ArasError):
        world.attach("stand::top", "thing::nothing")


def test_what_is_attached_turns_with_its_carrier_and_pulls_at_it():
    """Two bodies that were pushed at one of them move as one: momentum over the mass of both."""
    world = World()
    for name, x in (("one", 0.0), ("other", 0.3)):
        world.spawn(name, THING.replace("</robot>", "<gazebo><turnGravityOff>1</turnGravityOff></gazebo></robot>"),
                    pose=at(x, 0, 1))
    world.set_physics(0.001, (0.0, 0.0, 0.0))
    world.attach("one::body", "other::body")
    one, other = world.models["one"], world.models["other"]
    one.place(one.pose(), numpy.array((0.0, 0.4, 0.0, 0, 0, 0)))
    world.step(500)
    velocity = 0.5 * (one.twist()[:3] + other.twist()[:3])
    assert velocity == pytest.approx((0.0, 0.2, 0.0), abs=1e-3), "momentum"
    assert numpy.linalg.norm(one.pose()[:3, 3] - other.pose()[:3, 3]) == pytest.approx(0.3, abs=1e-3)
    assert one.twist()[3:] == pytest.approx(other.twist()[3:], abs=1e-3) and one.twist()[5] < -0.5


def test_a_saved_state_and_another_period_keep_what_is_attached_and_a_reset_ends_it():
    world = World()
    world.spawn("stand", STAND, pose=at(0, 0, 1))
    world.spawn("thing", THING, pose=at(0.2, 0, 1))
    world.attach("stand::top", "thing::body")
    state = snapshot.saved(world)
    world.set_physics(0.002, (0.0, 0.0, -9.8))
    world.step(200)
    assert world.is_attached("stand::top", "thing::body") and height(world) == pytest.approx(1.0, abs=1e-3)
    world.delete("stand")
    assert world.core.welds == []
    snapshot.restore(world, state)
    world.step(200)
    assert world.is_attached("stand::top", "thing::body") and height(world) == pytest.approx(1.0, abs=1e-3)
    world.reset_world()
    assert world.core.welds == []


LIFT = """<robot name='lift'><link name='world'/><link name='mast'/>
  <joint name='up' type='prismatic'><parent link='world'/><child link='palm'/><origin xyz='0 0 0.5'/><axis xyz='0 0 1'/>
    <limit lower='-0.5' upper='1' effort='200' velocity='1'/></joint>%s%%s
  <joint name='m' type='fixed'><parent link='world'/><child link='mast'/></joint>
  <transmission name='t'><joint name='up'><hardwareInterface>hardware_interface/PositionJointInterface
    </hardwareInterface></joint></transmission></robot>""" % box("palm", (0.04, 0.04, 0.02), 1.0)
LIFT = LIFT.replace("\n    </hardwareInterface>", "</hardwareInterface>")
CUP = """<gazebo><plugin name='v' filename='libgazebo_ros_vacuum_gripper.so'><robotNamespace>/vac</robotNamespace>
  <bodyName>palm</bodyName><topicName>grasping</topicName></plugin></gazebo>"""


def drive(model, **joints):
    """Lets position controllers of these joints run from now on, with these commands."""
    for joint, position in joints.items():
        if joint not in model.loaded:
            model.load_controller(joint, {"type": "position_controllers/JointPositionController", "joint": joint})
            model.simulation.switch_controllers([joint], [], True)
        model.simulation.set_controller_command(joint, position)


def test_a_vacuum_gripper_lifts_what_is_near_and_lets_it_go():
    world = World()
    lift = world.spawn("lift", LIFT % CUP)
    drive(lift, up=-0.43)
    world.spawn("thing", THING, pose=at(0, 0, 0.03))
    world.spawn("far", THING, pose=at(0.2, 0, 0.03))
    device = lift.description.devices[0]
    assert (device.topic, device.services, device.max_distance_m) == ("/vac/grasping", ("/vac/on", "/vac/off"), 0.05)
    suction = Suction(device, world, lift)
    world.step(1000)
    assert not suction.update() and height(world) == pytest.approx(0.03, abs=1e-3)
    suction.switch(True)
    assert suction.update() and suction.held == ["thing::body"]
    drive(lift, up=0.0)
    world.step(2000)
    assert height(world) == pytest.approx(0.03 + 0.43, abs=5e-3) and height(world, "far") < 0.04
    assert suction.update()
    suction.switch(False)
    assert not suction.update()
    world.step(1000)
    assert height(world) == pytest.approx(0.03, abs=5e-3)


FINGER = """<link name='%(name)s'>""" + MASS % (0.1, 1e-4, 1e-4, 1e-4) + """<collision>
  <geometry><box size='0.04 0.01 0.08'/></geometry></collision></link>
  <joint name='%(name)s' type='prismatic'><parent link='palm'/><child link='%(name)s'/><axis xyz='0 %(way)d 0'/>
    <origin xyz='0 %(y)g -0.06'/><limit lower='-0.02' upper='0.05' effort='15' velocity='0.2'/></joint>
  <transmission name='t_%(name)s'><joint name='%(name)s'><hardwareInterface>hardware_interface/PositionJointInterface
    </hardwareInterface></joint></transmission>"""
FINGER = FINGER.replace("\n    </hardwareInterface>", "</hardwareInterface>")
HAND = (FINGER % {"name": "left", "y": 0.06, "way": -1} + FINGER % {"name": "right", "y": -0.06, "way": 1} +
        """<gazebo><plugin name='g' filename='libgazebo_grasp_fix.so'><arm><arm_name>a</arm_name>
  <palm_link>palm</palm_link><gripper_link>left</gripper_link><gripper_link>right</gripper_link></arm>
  <update_rate>100</update_rate><grip_count_threshold>3</grip_count_threshold></plugin></gazebo>""")


def test_a_hand_holds_what_its_fingers_press_and_lets_go_when_they_open():
    world = World()
    lift = world.spawn("lift", LIFT % HAND)
    device = lift.description.devices[0]
    assert isinstance(device, GraspFix) and (device.threshold, device.most, device.release_m) == (3, 10, 0.005)
    drive(lift, up=-0.37, left=0.0, right=0.0)
    world.step(1000)
    world.spawn("thing", THING, pose=at(0, 0, 0.03))
    grasp = Grasp(device, world, lift)

    def look(times):
        for _ in range(times):
            world.step(10)
            grasp.update()

    look(20)
    assert not grasp.held, "nothing presses"
    up, down, weak = numpy.array((0.0, 1, 0)), numpy.array((0.0, -1, 0)), numpy.array((0.0, -0.2, 0))
    assert grasp.is_gripped([up, down]) and not grasp.is_gripped([up, up]) and not grasp.is_gripped([up, weak])
    drive(lift, left=0.03, right=0.03)
    look(60)
    assert set(grasp.held) == {"thing::body"} and set(grasp.held["thing::body"]) == {"left", "right"}
    drive(lift, up=0.0)
    look(150)
    assert grasp.held and height(world) == pytest.approx(0.03 + 0.37, abs=5e-3)
    drive(lift, left=-0.01, right=-0.01)
    look(60)
    assert not grasp.held and world.core.welds == []
    look(60)
    assert height(world) < 0.1
