"""What plugins of a model do, without ROS; and what is said of what is ignored."""
import numpy
import pytest

from gazebo_ros.node.notes import summed_up
from gazebo_ros.world.description import read_description
from gazebo_ros.world.poses import matrix_of
from gazebo_ros.world.world import World

MASS = "<inertial><mass value='%g'/><inertia ixx='%g' iyy='%g' izz='%g' ixy='0' ixz='0' iyz='0'/></inertial>"
WHEEL = """<link name='%(side)s_wheel'>""" + MASS % (0.2, 1e-4, 1e-4, 2e-4) + """
    <collision><geometry><cylinder radius='0.05' length='0.02'/></geometry></collision></link>
  <joint name='%(side)s' type='continuous'><parent link='base'/><child link='%(side)s_wheel'/><axis xyz='0 0 1'/>
    <origin xyz='0 %(y)s 0.05' rpy='-1.5707963267948966 0 0'/></joint>"""
CART = """<robot name='cart'>
  <link name='base_footprint'/>
  <joint name='to_base' type='fixed'><parent link='base_footprint'/><child link='base'/></joint>
  <link name='base'>""" + MASS % (2.0, 0.01, 0.01, 0.01) + """</link>
  """ + WHEEL % {"side": "left", "y": 0.15} + WHEEL % {"side": "right", "y": -0.15} + """
  <link name='ball'>""" + MASS % (0.01, 1e-5, 1e-5, 1e-5) + """
    <collision><geometry><sphere radius='0.02'/></geometry></collision></link>
  <joint name='to_ball' type='fixed'><parent link='base'/><child link='ball'/><origin xyz='-0.1 0 0.02'/></joint>
  <link name='nose'>""" + MASS % (0.01, 1e-5, 1e-5, 1e-5) + """
    <collision><geometry><sphere radius='0.02'/></geometry></collision></link>
  <joint name='to_nose' type='fixed'><parent link='base'/><child link='nose'/><origin xyz='0.1 0 0.02'/></joint>
  <gazebo><plugin name='d' filename='libgazebo_ros_diff_drive.so'>
    <leftJoint>left</leftJoint><rightJoint>right</rightJoint><wheelSeparation>0.3</wheelSeparation>
    <wheelDiameter>0.1</wheelDiameter><wheelTorque>2</wheelTorque><updateRate>%s</updateRate></plugin></gazebo>
</robot>"""


def cart_in(world):
    cart = world.spawn("cart", CART % "50", pose=matrix_of((0, 0, 0), (0, 0, 0, 1), "test"))
    world.step(200)
    return cart, cart.description.devices[0]


def test_wheels_roll_on_the_ground_as_fast_as_they_turn():
    world = World()
    cart, drive = cart_in(world)
    cart.turn_wheels(drive, (4.0, 4.0))
    world.step(3000)
    assert cart.pose()[0, 3] == pytest.approx(3.0 * 4.0 * 0.05, rel=0.05) and abs(cart.pose()[1, 3]) < 0.01
    assert abs(cart.pose()[2, 3]) < 1e-3, "it stays on the ground"


def test_wheels_that_turn_against_each_other_turn_the_base():
    world = World()
    cart, drive = cart_in(world)
    cart.turn_wheels(drive, (-1.5, 1.5))
    world.step(1000)
    assert cart.twist()[5] == pytest.approx(1.5 * 0.05 * 2.0 / 0.3, rel=0.1)


def test_a_cart_stands_without_a_command_and_the_same_commands_give_the_same_bytes():
    states = []
    for _ in range(2):
        world = World()
        cart, drive = cart_in(world)
        before = cart.pose()[:2, 3].copy()
        world.step(1000)
        assert abs(cart.pose()[:2, 3] - before).max() < 1e-3
        cart.turn_wheels(drive, (2.0, 3.0))
        world.step(777)
        states.append(cart.simulation.save_state())
    assert states[0] == states[1]


def test_a_plugin_with_a_joint_that_is_not_there_is_named_and_ignored():
    description = read_description((CART % "50").replace("<leftJoint>left<", "<leftJoint>front<"), "", "cart")
    assert not description.devices
    assert "plugin libgazebo_ros_diff_drive.so: there is no joint 'front'" in "\n".join(description.warnings)


def test_a_word_for_a_number_of_a_plugin_is_the_default():
    found = read_description(CART % "fast", "", "cart")
    assert found.devices[0].rate_hz == 100.0 and any("<updateRate> 'fast'" in line for line in found.warnings)


MIMIC = """<robot name='gripper'><link name='world'/><link name='palm'/>
  <joint name='j' type='fixed'><parent link='world'/><child link='palm'/></joint>
  <link name='a'>%(mass)s</link><link name='b'>%(mass)s</link>
  <joint name='one' type='prismatic'><parent link='palm'/><child link='a'/><axis xyz='0 1 0'/>
    <limit lower='-0.1' upper='0.1' effort='9' velocity='1'/></joint>
  <joint name='two' type='prismatic'><parent link='palm'/><child link='b'/><axis xyz='0 1 0'/>
    <limit lower='-0.1' upper='0.1' effort='9' velocity='1'/><mimic joint='one'/></joint>
  %(transmission)s</robot>"""
OF_TWO = ("<transmission name='t'><joint name='two'><hardwareInterface>EffortJointInterface</hardwareInterface></joint>"
          "</transmission>")


@pytest.mark.parametrize("transmission, alone", [(OF_TWO, True), ("", False)])
def test_a_joint_with_a_transmission_moves_by_itself_though_it_mimics_another(transmission, alone):
    urdf = MIMIC % {"mass": MASS % (0.1, 1e-4, 1e-4, 1e-4), "transmission": transmission}
    model = World().spawn("gripper", urdf)
    model.set_joints({"one": 0.02})
    assert list(model.simulation.joint_positions) == ([0.02, 0.0] if alone else [0.02, 0.02])
    assert any("<mimic> of joint 'two'" in each for each in model.warnings) == alone


def test_elements_that_are_ignored_are_named_once_with_their_places():
    lines = ["URDF string:%d: <kp>: in <gazebo reference='link_%d'>: ignored" % (k, k) for k in range(6)]
    assert summed_up(["first"] + lines + ["URDF string:9: <RefLink>: ignored", "first"]) == [
        "first", "<kp> of link_0, link_1, link_2, link_3 and 2 more: ignored", "<RefLink>: ignored"]


SENSORS = """<robot name='arm'><link name='world'/><link name='base'>%(mass)s</link>
  <joint name='to_world' type='fixed'><parent link='world'/><child link='base'/></joint>
  <link name='arm'>%(arm)s</link>
  <joint name='swing' type='revolute'><parent link='base'/><child link='arm'/><axis xyz='0 1 0'/>
    <limit lower='-3' upper='3' effort='50' velocity='50'/></joint>
  <link name='tool'>%(tool)s</link>
  <joint name='flange' type='fixed'><parent link='arm'/><child link='tool'/><origin xyz='0 0 0.5' rpy='0 0.3 0'/>
  </joint>
  <gazebo><plugin name='f' filename='libgazebo_ros_ft_sensor.so'><jointName>flange</jointName>
    <topicName>ft</topicName><updateRate>100</updateRate></plugin></gazebo>
  <gazebo><plugin name='i' filename='libgazebo_ros_imu.so'><bodyName>tool</bodyName><topicName>imu</topicName></plugin>
  </gazebo></robot>""" % {"mass": MASS % (1.0, 0.1, 0.1, 0.1), "arm": MASS % (1.0, 0.02, 0.03, 0.04),
                          "tool": MASS % (0.7, 0.001, 0.002, 0.003)}
TILT = matrix_of((0, 0, 0), (0.3, 0.1, -0.2, 0.9273618495495703), "test")  # of the whole robot


def swinging():
    """A world with the arm, and the arm."""
    world = World()
    model = world.spawn("arm", SENSORS, pose=TILT)
    model.set_joints({"swing": 0.4})
    return world, model


def test_devices_of_sensors_have_full_names():
    force, imu = read_description(SENSORS, "/here", "arm").devices
    assert (force.joint, force.topic, force.rate_hz) == ("flange", "/here/ft", 100.0)
    assert (imu.link, imu.topic, imu.frame, imu.rate_hz) == ("tool", "/here/imu", "tool", 0.0)


def test_a_link_accelerates_as_its_velocity_changes():
    world, model = swinging()
    simulation = model.simulation
    world.step(300)
    before = model.link_twist("tool")
    world.step(1)
    change = (model.link_twist("tool") - before) / 1e-3
    pose = model.link_pose("tool")
    measured = simulation.link_acceleration("tool")
    assert abs(pose[:3, :3] @ measured[:3] - change[:3]).max() < 5e-3 * abs(change).max(), "step's error"
    assert abs(pose[:3, :3] @ measured[3:] - change[3:]).max() < 5e-3 * abs(change).max()


def test_a_joint_feels_the_momentum_of_what_it_carries():
    """Newton: force on the tool is its mass times its acceleration less gravity; the parent feels the opposite."""
    world, model = swinging()
    for _ in range(3):
        world.step(100)
        acceleration = model.simulation.link_acceleration("tool")
        gravity = model.link_pose("tool")[:3, :3].T @ (0.0, 0.0, -9.8)
        wrench = model.simulation.joint_wrench("flange")
        assert wrench[:3] == pytest.approx(-0.7 * (acceleration[:3] - gravity), abs=1e-9)
        turning = model.simulation.link_twist("tool")[3:]
        inertia = numpy.diag([0.001, 0.002, 0.003])
        assert wrench[3:] == pytest.approx(-(inertia @ acceleration[3:] + numpy.cross(turning, inertia @ turning)),
                                           abs=1e-9)


def test_a_push_on_a_link_is_felt_by_the_joints_that_carry_it_and_ends_with_a_reset():
    world, model = swinging()
    simulation = model.simulation
    axis = model.link_pose("arm")[:3, :3] @ (0.0, 1.0, 0.0)
    arm = model.link_pose("tool")[:3, 3] - model.link_pose("arm")[:3, 3]
    force = numpy.array([3.0, -1.0, 2.0])
    free_world, free = swinging()
    free_world.step(1)
    simulation.push({"tool": [*force, 0.0, 0.0, 0.0]}, {})
    world.step(1)
    torque = axis @ numpy.cross(arm, force)  # the tool's centre of mass is at its origin
    inertia = 0.03 + 0.002 + 0.7 * 0.5 ** 2
    assert simulation.joint_velocities[0] - free.simulation.joint_velocities[0] == pytest.approx(
        1e-3 * torque / inertia, rel=1e-3)
    simulation.push({}, {"swing": 2.0})
    again_world, again = swinging()
    again_world.step(1)
    model.set_joints({"swing": 0.4})
    world.step(1)
    assert simulation.joint_velocities[0] - again.simulation.joint_velocities[0] == pytest.approx(
        1e-3 * 2.0 / inertia, rel=1e-3)
    world.reset_simulation()
    model.set_joints({"swing": 0.4})
    world.step(1)
    assert simulation.joint_velocities[0] == again.simulation.joint_velocities[0]


def test_a_saved_state_has_what_pushes_in_it():
    world, model = swinging()
    model.simulation.push({"tool": [1.0, 2.0, 3.0, 0.1, 0.2, 0.3]}, {"swing": 0.5})
    world.step(10)
    state = world.core.save_state()
    world.step(50)
    end = world.core.save_state()
    other, _ = swinging()
    other.core.restore_state(state)
    other.step(50)
    assert other.core.save_state() == end


def test_wheels_slip_on_links_of_little_friction():
    far = []
    for slippery in ("", "".join("<gazebo reference='%s_wheel'><mu1>0.01</mu1></gazebo>" % side
                                 for side in ("left", "right"))):
        world = World()
        cart = world.spawn("cart", (CART % "50").replace("</robot>", slippery + "</robot>"))
        cart.turn_wheels(cart.description.devices[0], (20.0, 20.0))
        world.step(500)
        far.append(cart.pose()[0, 3])
    assert far[1] < 0.3 * far[0]
