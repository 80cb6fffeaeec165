"""The world without ROS: models come and go, each with its controllers, and the same calls give the same bytes."""
import numpy
import pytest

from aras_visual_servo_sim import ModelError, ParameterError, UnknownNameError

from gazebo_ros.world.description import located
from gazebo_ros.world.poses import IDENTITY, matrix_of, quaternion_of, rpy_of
from gazebo_ros.world.world import World

ROUNDING = 1e-9

INERTIAL = ("<inertial><mass value='1'/><inertia ixx='0.01' iyy='0.01' izz='0.01' ixy='0' ixz='0' iyz='0'/></inertial>")
PENDULUM = """<robot name='pendulum'>
  <link name='world'/>
  <joint name='to_world' type='fixed'><parent link='world'/><child link='base'/></joint>
  <link name='base'>%(inertial)s</link>
  <link name='arm'>%(inertial)s
    <visual><origin xyz='0 0 0.2'/><geometry><box size='0.1 0.1 0.4'/></geometry></visual></link>
  <joint name='swing' type='revolute'><parent link='base'/><child link='arm'/><axis xyz='0 1 0'/>
    <limit lower='-2' upper='2' effort='50' velocity='5'/></joint>
  <transmission name='t'><joint name='swing'><hardwareInterface>PositionJointInterface</hardwareInterface></joint>
  </transmission>
  <gazebo><plugin name='c' filename='libgazebo_ros_control.so'/></gazebo>
</robot>""" % {"inertial": INERTIAL}
BALL = ("<robot name='ball'><link name='ball'>" + INERTIAL + "<collision><geometry><sphere radius='0.1'/></geometry>"
        "</collision></link></robot>")
CAMERA = """<robot name='camera'><link name='body'>%s</link>
  <gazebo><static>true</static></gazebo>
  <gazebo reference='body'><sensor type='camera' name='eye'><update_rate>10</update_rate>
    <camera><horizontal_fov>1.0</horizontal_fov><image><width>40</width><height>30</height></image>
      <clip><near>0.1</near><far>20</far></clip></camera>
    <plugin name='p' filename='libgazebo_ros_camera.so'><cameraName>eye</cameraName></plugin></sensor></gazebo>
</robot>""" % INERTIAL
TRAJECTORY = {"type": "position_controllers/JointTrajectoryController", "joints": ["swing"]}


def at(x=0.0, y=0.0, z=0.0):
    return matrix_of((x, y, z), (0, 0, 0, 1), "test")


def swinging(world, name="one"):
    """A pendulum that follows a trajectory."""
    simulation = world.spawn(name, PENDULUM, "/" + name).simulation
    simulation.load_controller("arm", TRAJECTORY)
    simulation.switch_controllers(["arm"])
    simulation.pursue_trajectory("arm", ["swing"], [(1.0, [0.5], [0.0], [])])
    return simulation


def test_the_world_is_empty_at_first_and_its_time_goes_on():
    world = World()
    world.step(250)
    assert world.time_ns == 250000000 and not world.models


def test_a_root_link_world_is_fixed_and_any_other_falls_on_the_ground():
    world = World()
    pendulum, ball = world.spawn("pendulum", PENDULUM, pose=at(z=1.0)), world.spawn("ball", BALL, pose=at(z=1.0))
    world.step(2000)
    assert pendulum.pose()[2, 3] == 1.0
    assert abs(ball.pose()[2, 3] - 0.1) < 1e-3  # the ground gives way by the weight over its stiffness


def test_models_have_their_own_time_and_are_deleted_without_a_trace():
    world = World()
    world.step(500)
    first = swinging(world, "one")
    world.step(1200)
    second = swinging(world, "two")
    assert first.trajectory_report("arm")["goal"] == "succeeded" and first.joint_positions[0] == pytest.approx(0.5)
    world.delete("one")
    world.step(1200)
    assert second.trajectory_report("arm")["goal"] == "succeeded"
    assert list(world.models) == ["two"]
    world.spawn("one", PENDULUM)


def test_the_same_calls_give_the_same_bytes():
    runs = []
    for _ in range(2):
        world = World()
        simulation = swinging(world)
        world.spawn("ball", BALL, pose=at(z=0.3))
        world.step(777)
        runs.append((simulation.save_state(), world.models["ball"].simulation.save_state()))
    assert runs[0] == runs[1]


def test_a_reset_puts_models_back_and_controllers_go_on():
    world = World()
    world.step(100)
    simulation = swinging(world)
    world.step(600)
    world.reset_world()
    assert simulation.joint_positions[0] == 0.0 and world.time_ns == 700000000
    world.reset_simulation()
    assert world.time_ns == 0 and world.core_s(0) == 0.0
    assert [each["state"] for each in simulation.loaded_controllers()] == ["running"]
    simulation.pursue_trajectory("arm", ["swing"], [(0.5, [0.2], [0.0], [])])
    world.step(600)
    assert simulation.joint_positions[0] == pytest.approx(0.2)


def test_a_camera_that_is_placed_shows_the_new_view_and_other_models():
    world = World()
    camera = world.spawn("camera", CAMERA, pose=at(x=-2.0, z=0.2))
    ground_and_sky = 147 - 5, 178 + 5  # grey levels of Gazebo's, and what edges between them and rounding leave

    def sees_something():
        image = world.core.render("camera::eye").astype(int)
        return image.min() < ground_and_sky[0] or image.max() > ground_and_sky[1]
    assert not sees_something()
    world.spawn("pendulum", PENDULUM)
    assert sees_something()
    camera.place(at(x=2.0, z=0.2), numpy.zeros(6))
    assert not sees_something(), "it looks away now"
    camera.place(at(x=-2.0, z=0.2), numpy.zeros(6))
    world.delete("pendulum")
    assert not sees_something()


def test_what_cannot_be_is_refused_and_the_world_goes_on():
    world = World()
    world.spawn("one", PENDULUM)
    for name, xml, frame, text in (("one", PENDULUM, "", "entity already exists"),
                                   ("", PENDULUM, "", "found the name ''"),
                                   ("two", "<robot", "", "entity format is invalid"),
                                   ("two", "<sdf/>", "", "allowed is <robot>"),
                                   ("two", PENDULUM, "nowhere", "reference_frame not found"),
                                   ("two", "<robot name='r'/>", "", "found no <link>")):
        with pytest.raises(ModelError, match=text):
            world.spawn(name, xml, frame=frame)
    with pytest.raises(UnknownNameError, match="models are: one"):
        world.delete("two")
    with pytest.raises(UnknownNameError):
        world.frame("one::nothing")
    with pytest.raises(ParameterError, match="fixed"):
        world.models["one"].place(at(1.0), numpy.zeros(6))
    with pytest.raises(ParameterError, match="not finite"):
        matrix_of((numpy.nan, 0, 0), (0, 0, 0, 1), "pose")
    with pytest.raises(UnknownNameError, match="swong"):
        world.models["one"].set_joints({"swong": 1.0})
    assert list(world.models) == ["one"]
    world.step(10)


def test_a_model_is_spawned_relative_to_another():
    world = World()
    world.spawn("one", PENDULUM, pose=at(1.0, 2.0, 3.0))
    two = world.spawn("two", PENDULUM, pose=at(0.5), frame="one::arm")
    assert two.pose()[:3, 3] == pytest.approx([1.5, 2.0, 3.0])


def test_namespaces_are_those_of_the_plugin_else_of_the_spawn_else_the_name_of_the_model():
    world = World()
    assert world.spawn("a", PENDULUM).description.control_namespace == "/a"
    assert world.spawn("b", PENDULUM, "/left/").description.control_namespace == "/left"
    own = PENDULUM.replace("control.so'/>", "control.so'><robotNamespace>mine</robotNamespace></plugin>")
    assert world.spawn("c", own, "/left").description.control_namespace == "/mine"


def test_what_refers_to_nothing_is_ignored_by_name():
    stray = PENDULUM.replace("</robot>", "<gazebo reference='ghost'><mu1>1</mu1></gazebo><transmission name='u'>"
                             "<joint name='none'/></transmission><gazebo><plugin filename='libdrive.so'/></gazebo>"
                             "</robot>")
    warnings = "\n".join(World().spawn("one", stray).warnings)
    assert "plugin libdrive.so is not simulated" in warnings and "<plugin>" not in warnings, warnings
    assert "<gazebo reference='ghost'>" in warnings and "<transmission name='u'>: there is no joint 'none'" in warnings


def test_files_of_packages_are_found_wherever_they_are():
    text = """<robot name='r'><mesh filename="package://pack/meshes/a.stl"/><uri> model://box/b.dae</uri>
              <mesh filename='package://nowhere/c.stl'/></robot>"""
    found = located(text, {"pack": "/deep/in/pack", "box": "/models/box"}.get)
    assert 'filename="file:///deep/in/pack/meshes/a.stl"' in found and "<uri> file:///models/box/b.dae" in found
    assert "package://nowhere/c.stl" in found


def test_poses_survive_the_way_there_and_back():
    generator = numpy.random.default_rng(3)
    for quaternion in generator.normal(size=(20, 4)):
        pose = matrix_of((1, 2, 3), quaternion, "pose")
        again = matrix_of((1, 2, 3), quaternion_of(pose), "pose")
        assert numpy.abs(again - pose).max() < ROUNDING
        roll, pitch, yaw = rpy_of(pose)
        assert numpy.abs(rotation(yaw, 2) @ rotation(pitch, 1) @ rotation(roll, 0) - pose[:3, :3]).max() < ROUNDING
    assert (quaternion_of(IDENTITY) == (0, 0, 0, 1)).all()


def rotation(angle, axis):
    matrix = numpy.eye(3)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix[i, i] = matrix[j, j] = numpy.cos(angle)
    matrix[j, i] = numpy.sin(angle)
    matrix[i, j] = -matrix[j, i]
    return matrix
