"""Colours of a model, as Gazebo has them."""
from gazebo_ros.world.description import read_description
from gazebo_ros.world.poses import matrix_of
from gazebo_ros.world.world import World

PLATE = """<robot name='plate'><link name='world'/>
  <joint name='j' type='fixed'><parent link='world'/><child link='plate'/></joint>
  <material name='grey'><color rgba='0.3 0.3 0.3 1'/></material>
  <link name='plate'><visual><geometry><box size='2 2 0.01'/></geometry><material name='grey'/></visual></link>
  <joint name='k' type='fixed'><parent link='world'/><child link='eye'/>
    <origin xyz='0 0 1' rpy='0 1.5707963 0'/></joint>
  <link name='eye'/>%s
  <gazebo reference='eye'><sensor type='camera' name='eye'><update_rate>10</update_rate>
    <camera><horizontal_fov>0.5</horizontal_fov><image><width>8</width><height>8</height></image>
      <clip><near>0.1</near><far>20</far></clip></camera>
    <plugin name='p' filename='libgazebo_ros_camera.so'><cameraName>eye</cameraName></plugin></sensor></gazebo>
</robot>"""


def seen(extra=""):
    world = World()
    world.spawn("plate", PLATE % extra, pose=matrix_of((0, 0, 1.0), (0, 0, 0, 1), "test"))
    return world.core.render("plate::eye")


def test_a_plate_under_the_sun_is_white_whatever_colour_the_urdf_gives_it():
    """Ambient light and that of the sun add up to more than white: nodes that look for what is darker rely on it."""
    assert seen().min() == 255


def test_gazebos_material_has_the_last_word():
    assert seen("<gazebo reference='plate'><material>Gazebo/Black</material></gazebo>").max() < 10


def test_a_mesh_that_is_not_there_is_named_and_left_out():
    gone = "<visual><geometry><mesh filename='package://nowhere/arm.dae'/></geometry></visual>"
    model = World().spawn("plate", (PLATE % "").replace("<link name='eye'/>", "<link name='eye'>%s%s</link>" % (
        gone, gone.replace("visual", "collision"))))
    assert "mesh package://nowhere/arm.dae of eye: there is no such file: ignored" in model.warnings


def test_a_picture_of_gazebos_own_is_a_plain_colour_in_both_forms():
    plain = "<gazebo reference='plate'><material>Gazebo/Bricks</material></gazebo>"
    script = ("<gazebo reference='plate'><visual><material><script><name>Gazebo/Bricks</name></script></material>"
              "</visual></gazebo>")
    for tag in (plain, script):
        red, green, blue = seen(tag)[4, 4].tolist()
        assert red > 1.5 * green and red > 1.5 * blue and red > 60, "the tone of bricks"
        warnings = read_description(PLATE % tag, "", "plate").warnings
        assert [each for each in warnings if "Gazebo/Bricks" in each] == list(warnings)
        assert not any("ignored" in each for each in World().spawn("plate", PLATE % tag).warnings if "Bricks" in each)
    mine = plain.replace("Gazebo/Bricks", "Mine/Bricks")
    assert any("Mine/Bricks" in each for each in World().spawn("plate", PLATE % mine).warnings)
