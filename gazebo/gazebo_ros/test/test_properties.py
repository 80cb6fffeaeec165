"""Properties of links, joints and the world that are changed while time goes on."""
import dataclasses
import math

import numpy
import pytest

from aras_visual_servo_sim import ModelError, ParameterError, UnknownNameError

from gazebo_ros.world.poses import matrix_of
from gazebo_ros.world.snapshot import digest, restore, saved
from gazebo_ros.world.world import World

INERTIAL = """<inertial><origin xyz='%s'/><mass value='%g'/>
  <inertia ixx='0.01' iyy='0.01' izz='0.01' ixy='0' ixz='0' iyz='0'/></inertial>"""
#: A rod on a hinge whose axis is level, with its mass 0.3 m from it.
PENDULUM = ("<robot name='p'><link name='world'/><link name='rod'>" + INERTIAL % ("0 0 -0.3", 1.0) + """</link>
  <joint name='hinge' type='revolute'><parent link='world'/><child link='rod'/><origin xyz='0 0 1'/><axis xyz='0 1 0'/>
    <limit lower='-3' upper='3' effort='50' velocity='50'/></joint>
  <transmission name='t'><joint name='hinge'><hardwareInterface>EffortJointInterface</hardwareInterface></joint>
  </transmission>{camera}</robot>""")
CAMERA = """<gazebo reference='rod'><sensor type='camera' name='eye'><update_rate>20</update_rate>
  <pose>0 0 0 0 1.57 0</pose><camera><horizontal_fov>1.0</horizontal_fov><image><width>32</width><height>24</height>
  </image><clip><near>0.02</near><far>20</far></clip></camera>
  <plugin name='p' filename='libgazebo_ros_camera.so'><cameraName>eye</cameraName></plugin></sensor></gazebo>"""
BOX = "<robot name='b'><link name='l'>" + INERTIAL % ("0 0 0", 1.0) + """<collision>
  <geometry><box size='0.2 0.2 0.2'/></geometry></collision></link></robot>"""
RATE_TOLERANCE = 1e-2  #: of an acceleration that is read from a short swing
SINKS_M = 1e-3


def at(z=0.0, x=0.0):
    return matrix_of((x, 0, z), (0, 0, 0, 1), "test")


def hanging(angle=0.5, camera=""):
    """A pendulum held aside by its effort controller's command, 0."""
    world = World()
    model = world.spawn("p", PENDULUM.format(camera=camera))
    model.load_controller("c", {"type": "effort_controllers/JointEffortController", "joint": "hinge"})
    model.simulation.switch_controllers(["c"])
    model.set_joints({"hinge": angle})
    return world, model


def acceleration(world, model):
    """Of the hinge, over 5 ms [rad/s^2]."""
    before = model.simulation.joint_velocities[0]
    world.step(5)
    return (model.simulation.joint_velocities[0] - before) / (5 * world.settings.period_s)


def expected(mass, com, gravity=9.8, angle=0.5):
    return -mass * gravity * com * math.sin(angle) / (0.01 + mass * com ** 2)


def test_a_link_falls_as_its_new_mass_says_and_the_description_tells_it():
    world, model = hanging()
    assert acceleration(world, model) == pytest.approx(expected(1.0, 0.3), rel=RATE_TOLERANCE)
    world, model = hanging()
    world.change_link("p", "rod", dataclasses.replace(model.properties_of("rod"), mass_kg=3.0, com_m=(0, 0, -0.1)))
    assert model.properties_of("rod").mass_kg == 3.0 and model.properties_of("rod").com_m == (0.0, 0.0, -0.1)
    assert acceleration(world, model) == pytest.approx(expected(3.0, 0.1), rel=RATE_TOLERANCE)


def test_gravity_is_taken_off_a_link_and_given_back_also_after_a_reset():
    world, model = hanging()
    world.spawn("other", BOX, pose=at(5.0, x=3.0))
    world.change_link("p", "rod", dataclasses.replace(model.properties_of("rod"), gravity=False))
    assert not model.properties_of("rod").gravity and acceleration(world, model) == pytest.approx(0.0, abs=1e-9)
    world.reset_simulation()
    model.set_joints({"hinge": 0.5})
    assert acceleration(world, model) == pytest.approx(0.0, abs=1e-9)
    world.change_link("p", "rod", dataclasses.replace(model.properties_of("rod"), gravity=True))
    assert acceleration(world, model) == pytest.approx(expected(1.0, 0.3), rel=RATE_TOLERANCE)


def test_one_link_of_two_that_gravity_does_not_act_on_floats():
    rods = PENDULUM.format(camera="").replace("</robot>", """<link name='tip'>%s</link><joint name='f' type='fixed'>
      <parent link='rod'/><child link='tip'/></joint><gazebo reference='tip'><turnGravityOff>true</turnGravityOff>
      </gazebo></robot>""" % (INERTIAL % ("0 0 -0.3", 1.0)))
    world = World()
    model = world.spawn("p", rods)
    assert not model.properties_of("tip").gravity and model.properties_of("rod").gravity
    model.load_controller("c", {"type": "effort_controllers/JointEffortController", "joint": "hinge"})
    model.simulation.switch_controllers(["c"])
    model.set_joints({"hinge": 0.5})
    assert acceleration(world, model) == pytest.approx(
        -9.8 * 0.3 * math.sin(0.5) / (0.02 + 2.0 * 0.09), rel=RATE_TOLERANCE), "one weight, two masses"


def test_a_changed_link_goes_on_from_where_it_is():
    world, model = hanging()
    world.step(200)
    position, velocity = model.simulation.joint_positions[0], model.simulation.joint_velocities[0]
    world.change_link("p", "rod", dataclasses.replace(model.properties_of("rod"), mass_kg=2.0))
    assert (model.simulation.joint_positions[0], model.simulation.joint_velocities[0]) == (position, velocity)
    assert [each["state"] for each in model.simulation.loaded_controllers()] == ["running"]
    assert world.core.time_s == pytest.approx(0.2)


def test_damping_friction_and_limits_of_a_joint_act():
    world, model = hanging()
    world.change_joint("p", "hinge", {"damping": 2.0})
    assert model.damping_of("hinge") == 2.0
    world.step(300)
    damped = model.simulation.joint_positions[0]
    free_world, free = hanging()
    free_world.step(300)
    assert damped > free.simulation.joint_positions[0] + 0.1
    world.change_joint("p", "hinge", {"lower": 0.2})
    world.step(3000)
    assert model.simulation.joint_positions[0] == pytest.approx(0.2, abs=1e-6), "the stop"
    world, model = hanging()
    world.change_joint("p", "hinge", {"friction": 5.0})
    world.step(500)
    assert model.simulation.joint_positions[0] == pytest.approx(0.5, abs=1e-6), "more than its weight"


def test_a_changed_thing_is_as_heavy_for_who_pushes_it():
    world = World()
    world.spawn("low", BOX, pose=at(0.1))
    high = world.spawn("high", BOX, pose=at(0.3))
    world.step(500)
    world.change_link("high", "l", dataclasses.replace(high.properties_of("l"), mass_kg=50.0))
    world.step(1000)
    force = sum(each["force_n"][2] for each in world.models["low"].simulation.contacts if each["b"] == "ground_plane")
    assert force == pytest.approx(51.0 * 9.8, rel=1e-3)


def test_gravity_of_the_world_changes_for_all_at_once():
    world, model = hanging()
    box = world.spawn("box", BOX, pose=at(2.0, x=2.0))
    world.set_physics(0.001, (0.0, 0.0, -1.6))
    assert world.settings.gravity_m_s2 == (0.0, 0.0, -1.6)
    assert acceleration(world, model) == pytest.approx(expected(1.0, 0.3, 1.6), rel=RATE_TOLERANCE)
    assert box.twist()[2] == pytest.approx(-1.6 * 0.005, rel=1e-6)


def test_another_period_leaves_robots_where_they_are_and_time_goes_on():
    world, model = hanging()
    box = world.spawn("box", BOX, pose=at(5.0, x=2.0))
    world.step(100)
    position, speed = model.simulation.joint_positions[0], box.twist()[2]
    world.set_physics(0.002, (0.0, 0.0, -9.8))
    assert world.time_ns == 100000000 and model.simulation.joint_positions[0] == position
    assert box.twist()[2] == pytest.approx(speed)
    assert [each["state"] for each in model.simulation.loaded_controllers()] == ["running"]
    world.step(50)
    assert world.time_ns == 200000000 and world.core_s(world.time_ns) == pytest.approx(0.1)
    assert box.twist()[2] == pytest.approx(-0.2 * 9.8, rel=1e-2)
    state = saved(world)
    end = (world.step(20), digest(world))[1]
    restore(world, state)
    world.step(20)
    assert digest(world) == end
    world.reset_simulation()
    assert world.time_ns == 0
    world.step(5)
    assert world.time_ns == 10000000


def test_the_ground_plane_is_deleted_and_comes_back():
    world, model = hanging(camera=CAMERA)
    box = world.spawn("box", BOX, pose=at(0.1, x=2.0))
    world.step(100)
    before = world.core.render("p::eye").copy()
    world.remove_ground()
    world.step(500)
    assert box.pose()[2, 3] < -0.5 and not world.settings.ground
    model.set_joints({"hinge": 0.5})
    assert (world.core.render("p::eye") != before).any(), "the sky is below"
    with pytest.raises(UnknownNameError):
        world.remove_ground()
    box.place(at(0.5, x=2.0), numpy.zeros(6))
    ground = ("<sdf version='1.6'><model name='g'><static>true</static><link name='l'><collision name='c'><geometry>"
              "<plane><normal>0 0 1</normal><size>9 9</size></plane></geometry></collision></link></model></sdf>")
    assert world.spawn_sdf("ground_plane", ground) is None and world.settings.ground
    world.step(1500)
    assert box.pose()[2, 3] == pytest.approx(0.1, abs=SINKS_M)
    assert "ground_plane" in world.core.model_names


@pytest.mark.parametrize("change", [{"mass_kg": 0.0}, {"mass_kg": -1.0}, {"inertia_kg_m2": (-1, 0, 0, 1, 0, 1)}])
def test_what_no_link_can_be_is_refused_and_the_world_goes_on(change):
    world, model = hanging()
    with pytest.raises((ModelError, ParameterError)):
        world.change_link("p", "rod", dataclasses.replace(model.properties_of("rod"), **change))
    assert acceleration(world, model) == pytest.approx(expected(1.0, 0.3), rel=RATE_TOLERANCE)


@pytest.mark.parametrize("change", [{"damping": -1.0}, {"lower": 1.0, "upper": -1.0}])
def test_what_no_joint_can_be_is_refused(change):
    world, model = hanging()
    with pytest.raises((ModelError, ParameterError)):
        world.change_joint("p", "hinge", change)
    assert acceleration(world, model) == pytest.approx(expected(1.0, 0.3), rel=RATE_TOLERANCE)
