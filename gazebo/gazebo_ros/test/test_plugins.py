"""Plugins of models and worlds that sense and drive, without ROS."""
import math

import numpy
import pytest

from gazebo_ros.sdf.document import NoFolders
from gazebo_ros.sdf.world import read_world
from gazebo_ros.world.description import read_description
from gazebo_ros.world.plugins.bumper import Bumper, collision_of
from gazebo_ros.world.plugins.rotors import RotorMotor, VelocityFlight
from gazebo_ros.world.poses import matrix_of_rpy
from gazebo_ros.world.world import World

MASS = "<inertial><mass value='%g'/><inertia ixx='%g' iyy='%g' izz='%g' ixy='0' ixz='0' iyz='0'/></inertial>"
BOX = ("<link name='%(name)s'>" + MASS % (1.0, 0.002, 0.002, 0.002) +
       "<collision><geometry><box size='0.1 0.1 0.1'/></geometry></collision></link>")
ARM = """<robot name='arm'><link name='world'/><joint name='fix' type='fixed'><parent link='world'/>
  <child link='base'/><origin xyz='0 0 1'/></joint><link name='base'>%(mass)s</link>
  <joint name='j' type='continuous'><parent link='base'/><child link='tip'/><axis xyz='0 0 1'/></joint>
  <joint name='k' type='continuous'><parent link='tip'/><child link='end'/><axis xyz='0 0 1'/>
    <origin xyz='0.5 0 0'/></joint>
  <link name='tip'>%(mass)s</link><link name='end'>%(mass)s</link>%%s</robot>""" % {"mass": MASS % (1, 0.1, 0.1, 0.1)}


def plugin(file, *keys):
    return "<gazebo><plugin name='p' filename='%s'>%s</plugin></gazebo>" % (
        file, "".join("<%s>%s</%s>" % (key, value, key) for key, value in keys))


def alone(urdf, world=None, name="m", **keys):
    """A model in a world without ground, and its one device."""
    world = world or World()
    model = world.spawn(name, urdf, **keys)
    return model, model.description.devices[0]


def test_p3d_gives_pose_and_twist_in_the_frame_that_it_names():
    tag = plugin("libgazebo_ros_p3d.so", ("bodyName", "end"), ("topicName", "truth"), ("frameName", "tip"),
                 ("updateRate", "50"), ("xyzOffset", "1 2 3"))
    world = World()
    model, device = alone(ARM % tag, world)
    assert (device.topic, device.rate_hz, device.frame) == ("/truth", 50.0, "tip")
    model.set_joints({"j": 0.3, "k": 0.2})
    pose, twist = device.measured(model)
    assert pose[:3, 3] == pytest.approx((1.5, 2.0, 3.0))
    assert pose[:3, :3] == pytest.approx(matrix_of_rpy((0, 0, 0), (0, 0, 0.2))[:3, :3])
    assert twist == pytest.approx(numpy.zeros(6))
    model.simulation.push({}, {"j": 1.0})
    world.step(50)
    turning = dict(zip(model.simulation.joint_names, model.simulation.joint_velocities))
    assert turning["j"] > 0.01 and device.measured(model)[1][5] == pytest.approx(turning["k"], abs=1e-9)
    model.set_joints({"j": 0.3, "k": 0.2})
    world_pose = read_description(ARM % tag.replace(">tip<", ">world<"), "", "m").devices[0].measured(model)[0]
    assert world_pose[:3, 3] == pytest.approx((1.0 + 0.5 * math.cos(0.3), 2.0 + 0.5 * math.sin(0.3), 4.0))


def test_the_joint_state_publisher_has_the_joints_that_it_names_in_a_namespace_of_the_models_name():
    tag = plugin("libgazebo_ros_joint_state_publisher.so", ("jointName", "k, j"))
    model, device = alone(ARM % tag)
    assert (device.topic, device.rate_hz) == ("/m/joint_states", 100.0)
    model.set_joints({"j": 0.3, "k": 0.2})
    assert device.measured(model) == (["k", "j"], [0.2, 0.3], [0.0, 0.0])
    assert alone(ARM % tag, namespace="/")[1].topic == "/joint_states", "spawn_model names the root"


WHEEL = ("<link name='%(name)s'>" + MASS % (0.2, 1e-4, 1e-4, 2e-4) +
         "<collision><geometry><cylinder radius='0.05' length='0.02'/></geometry></collision></link>"
         "<joint name='%(name)s_joint' type='continuous'><parent link='base'/><child link='%(name)s'/>"
         "<axis xyz='0 0 1'/><origin xyz='%(x)g %(y)g 0' rpy='-1.5707963267948966 0 0'/></joint>")


def test_a_base_on_four_wheels_drives_ahead_and_turns():
    wheels = "".join(WHEEL % {"name": "%s_%s" % (side, end), "x": x, "y": y}
                     for side, y in (("left", 0.15), ("right", -0.15)) for end, x in (("front", 0.1), ("rear", -0.1)))
    tag = plugin("libgazebo_ros_skid_steer_drive.so", ("wheelSeparation", 0.3), ("wheelDiameter", 0.1), ("torque", 20))
    urdf = "<robot name='r'><link name='base'>%s</link>%s%s</robot>" % (MASS % (2, 0.02, 0.02, 0.02), wheels, tag)
    world = World()
    model, device = alone(urdf, world, pose=matrix_of_rpy((0, 0, 0.06), (0, 0, 0)))
    assert not device.publishes_tf and device.variances == (0.0001, 0.0001, 0.01)
    model.turn_wheels(device, device.speeds(0.2, 0.0))
    world.step(2000)
    assert model.pose()[0, 3] == pytest.approx(0.4, abs=0.05) and abs(model.pose()[1, 3]) < 0.02
    model.turn_wheels(device, device.speeds(0.0, 1.0))
    world.step(500)
    assert model.twist()[5] > 0.2, "to the left"


def test_a_base_that_slides_takes_its_twist_in_its_own_heading():
    tag = plugin("libgazebo_ros_planar_move.so", ("odometryRate", 10))
    world = World()
    model, device = alone("<robot name='r'>%s%s</robot>" % (BOX % {"name": "base"}, tag), world,
                          pose=matrix_of_rpy((0, 0, 0.05), (0, 0, math.pi / 2)))
    for _ in range(250):
        device.move(model, 0.5, 0.0, 0.0)
        world.step(2)
    assert model.pose()[:2, 3] == pytest.approx((0.0, 0.25), abs=0.02)


SENSOR = """<robot name='r'><link name='world'/><joint name='fix' type='fixed'><parent link='world'/>
  <child link='eye'/><origin xyz='0 0 0.5'/></joint><link name='eye'/><gazebo reference='eye'>
  <sensor type='ray' name='s'><update_rate>20</update_rate><ray><scan><horizontal><samples>3</samples>
  <min_angle>-0.1</min_angle><max_angle>0.1</max_angle></horizontal></scan><range><min>0.05</min><max>4</max></range>
  </ray><plugin name='p' filename='%s'><topicName>seen</topicName>%s</plugin></sensor></gazebo></robot>"""
WALL = ("<robot name='w'><link name='world'/><joint name='j' type='fixed'><parent link='world'/><child link='wall'/>"
        "</joint><link name='wall'><collision><geometry><box size='0.2 5 5'/></geometry></collision></link></robot>")


def test_a_range_sensor_has_the_nearest_of_its_rays():
    model, device = alone(SENSOR % ("libgazebo_ros_range.so", "<radiation>infrared</radiation><fov>0.2</fov>"))
    assert (device.topic, device.infrared, device.field_of_view_rad, device.rate_hz) == ("/seen", True, 0.2, 20.0)
    assert device.nearest(numpy.array([2.0, numpy.inf, 1.5]), 4.0) == 1.5
    assert device.nearest(numpy.array([numpy.inf]), 4.0) == 4.0
    assert model.description.warnings == (), "the sensor is simulated"


def test_a_laser_of_points_has_them_in_its_own_axes():
    from gazebo_ros.world.devices import directions_of, resampled
    world = World()
    world.spawn("wall", WALL, pose=matrix_of_rpy((2.1, 0, 0), (0, 0, 0)))
    model, device = alone(SENSOR % ("libgazebo_ros_block_laser.so", "<gaussianNoise>0.01</gaussianNoise>"), world)
    directions = directions_of(device.horizontal, device.vertical)
    ranges, _ = world.cast_rays(model.link_pose("eye"), directions, device.range_min_m, device.range_max_m, False)
    points = device.points(resampled(ranges, device.horizontal, device.vertical), directions)
    assert points[:, 0] == pytest.approx([2.0] * 3) and points[1] == pytest.approx((2.0, 0.0, 0.0))
    assert points[0, 1] == pytest.approx(-2.0 * math.tan(0.1)) and device.noise == 0.01


def test_a_bumper_feels_what_the_link_stands_on_and_what_stands_on_it():
    tag = ("<gazebo reference='low'><sensor type='contact' name='c'><update_rate>30</update_rate>"
           "<plugin name='b' filename='libgazebo_ros_bumper.so'><bumperTopicName>hit</bumperTopicName></plugin>"
           "</sensor></gazebo>")
    world = World()
    model, device = alone("<robot name='r'>%s%s</robot>" % (BOX % {"name": "low"}, tag), world, "low",
                          pose=matrix_of_rpy((0, 0, 0.05), (0, 0, 0)))
    world.spawn("high", "<robot name='r'>%s</robot>" % BOX % {"name": "top"},
                pose=matrix_of_rpy((0, 0, 0.15), (0, 0, 0)))
    world.spawn("table", WALL, pose=matrix_of_rpy((0.15, 0, 0), (0, 0, 0)))
    assert device == Bumper("low", "/hit", "world", 30.0)
    world.step(1000)
    touched = device.touched(world, model)
    assert {"ground_plane", "high::top"} <= set(touched) <= {"ground_plane", "high::top", "table::wall"}
    assert sum(touch.force[2] for touch in touched["ground_plane"]) == pytest.approx(2 * 9.8, rel=1e-3)
    assert sum(touch.force[2] for touch in touched["high::top"]) == pytest.approx(-9.8, rel=1e-3)
    assert all(touch.normal[2] == pytest.approx(-1.0) for touch in touched["high::top"])
    above = world.touches("high", "top")
    assert {touch.other for touch in above} <= {"low::low", "table::wall"}
    assert sum(touch.force[2] for touch in above) == pytest.approx(9.8, rel=1e-3)
    assert all(touch.normal[2] == pytest.approx(1.0) for touch in above if touch.other == "low::low")
    assert collision_of("high::top") == "high::top::top_collision"


PAIR = """<robot name='post'><link name='world'/><joint name='j' type='fixed'><parent link='world'/>
  <child link='post'/></joint><link name='post'/><gazebo reference='post'><sensor type='multicamera' name='pair'>
  <update_rate>20</update_rate>%s%s<plugin name='p' filename='%s'><cameraName>pair</cameraName>
  <imageTopicName>image_raw</imageTopicName><cameraInfoTopicName>camera_info</cameraInfoTopicName>
  <frameName>post</frameName><hackBaseline>0.1</hackBaseline></plugin></sensor></gazebo></robot>"""
LENS = ("<camera name='%s'>%s<horizontal_fov>1.2</horizontal_fov><image><width>32</width><height>24</height>"
        "<format>R8G8B8</format></image><clip><near>0.02</near><far>50</far></clip></camera>")


def test_the_cameras_of_a_multicamera_are_single_ones_with_the_baseline_in_p_of_the_right_one():
    lenses = LENS % ("left", ""), LENS % ("right", "<pose>0 -0.1 0 0 0 0</pose>")
    world = World()
    model = world.spawn("m", PAIR % (*lenses, "libgazebo_ros_multicamera.so"))
    topics = {name: (each.image, each.info) for name, each in model.description.cameras.items()}
    assert topics == {"pair/" + side: ("/pair/%s/image_raw" % side, "/pair/%s/camera_info" % side)
                      for side in ("left", "right")}
    left, right = (world.core.camera_info("m::pair/" + side) for side in ("left", "right"))
    assert (left["P"][3], right["P"][3]) == (0.0, pytest.approx(-0.1 * right["P"][0]))
    assert left["frame_id"] == right["frame_id"] == "post"
    apart = world.core.camera_pose("m::pair/right")[:3, 3] - world.core.camera_pose("m::pair/left")[:3, 3]
    assert apart == pytest.approx((0.0, -0.1, 0.0))


def test_plugins_that_are_not_simulated_are_named_with_their_files():
    multi = read_description(PAIR % (LENS % ("left", ""), "", "libmine.so"), "", "m").warnings
    assert len(multi) == 1 and "libgazebo_ros_multicamera.so" in multi[0] and "libmine.so" in multi[0]
    other = read_description(SENSOR % ("libother.so", ""), "", "m").warnings
    assert len(other) == 1 and "libother.so" in other[0]
    camera = PAIR.replace("multicamera", "camera") % (LENS % ("left", ""), "", "libgazebo_ros_prosilica.so")
    prosilica = read_description(camera, "", "m")
    assert list(prosilica.cameras) == ["pair"] and "libgazebo_ros_prosilica.so" in prosilica.warnings[0]


ROTOR = ("<link name='rotor_%(k)d'>" + MASS % (0.005, 1e-6, 1e-6, 1e-5) + "</link><joint name='rotor_%(k)d_joint' "
         "type='continuous'><parent link='base'/><child link='rotor_%(k)d'/><axis xyz='0 0 1'/>"
         "<origin xyz='%(x)g %(y)g 0.02'/></joint>")


def test_four_rotors_at_their_hovering_speed_carry_the_body():
    places = [(0.2, 0.0), (0.0, 0.2), (-0.2, 0.0), (0.0, -0.2)]
    rotors = "".join(ROTOR % {"k": k, "x": x, "y": y} for k, (x, y) in enumerate(places))
    tags = "".join(plugin("librotors_gazebo_motor_model.so", ("jointName", "rotor_%d_joint" % k), ("motorNumber", k),
                          ("linkName", "rotor_%d" % k), ("turningDirection", "ccw" if k % 2 else "cw"))
                   for k in range(4))
    world = World()
    model = world.spawn("m", "<robot name='r'><link name='base'>%s</link>%s%s</robot>" %
                        (MASS % (0.7, 0.007, 0.007, 0.012), rotors, tags), pose=matrix_of_rpy((0, 0, 2), (0, 0, 0)))
    motors = model.description.devices
    assert [motor.number for motor in motors] == [0, 1, 2, 3] and all(isinstance(m, RotorMotor) for m in motors)
    hover = math.sqrt(0.72 * 9.8 / 4 / 8.54858e-06)
    assert motors[0].speed(0.0, hover, 10.0) == pytest.approx(hover) and motors[0].speed(0.0, 1e6, 10.0) == 838.0
    for motor in motors:  # one that turns counter-clockwise turns the body clockwise
        assert motor.wrench(model, hover)[5] == pytest.approx(-motor.turn * 0.72 * 9.8 / 4 * 0.016)
    for _ in range(250):
        for motor in motors:
            model.thrust(motor.link, motor.wrench(model, hover))
        world.step(4)
    assert model.pose()[2, 3] == pytest.approx(2.0, abs=1e-3) and abs(model.twist()).max() < 1e-3


def test_a_flying_body_hovers_level_and_follows_its_velocity():
    tag = plugin("libhector_gazebo_quadrotor_simple_controller.so", ("topicName", "cmd_vel"))
    world = World()
    model, device = alone("<robot name='r'>%s%s</robot>" % (BOX % {"name": "base"}, tag), world,
                          pose=matrix_of_rpy((0, 0, 1), (0.1, 0, math.pi / 2)))
    assert isinstance(device, VelocityFlight) and device.topic == "/cmd_vel"
    for _ in range(200):
        device.fly(model, (0.5, 0.0, 0.1), 0.0, 0.01)
        world.step(10)
    assert model.twist() == pytest.approx((0.0, 0.5, 0.1, 0, 0, 0), abs=1e-3)
    assert model.pose()[2, 3] == pytest.approx(1.0 + 0.1 * 1.9, abs=0.01) and model.pose()[2, 2] == pytest.approx(1.0)


def test_a_world_with_the_link_attacher_has_its_services():
    file = read_world("<sdf version='1.6'><world name='w'><plugin name='a' filename='libgazebo_ros_link_attacher.so'/>"
                      "<plugin name='b' filename='libother.so'/></world></sdf>", False, NoFolders())
    assert [device.namespace for device in file.devices] == ["/link_attacher_node"]
    assert len(file.warnings) == 1 and "libother.so" in file.warnings[0]
