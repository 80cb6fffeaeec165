"""Lights of the world without ROS: what the cameras of all models see of them."""
import numpy
import pytest

from aras_visual_servo_sim import ModelError, ParameterError, UnknownNameError

from gazebo_ros.world.poses import matrix_of
from gazebo_ros.world.settings import WorldSettings
from gazebo_ros.world.world import World

MOST = 8  #: lights of a world

FLOOR = """<robot name='floor'><link name='slab'><inertial><mass value='1'/>
  <inertia ixx='0.01' iyy='0.01' izz='0.01' ixy='0' ixz='0' iyz='0'/></inertial>
  <visual><geometry><box size='4 4 0.02'/></geometry></visual></link>%s
  <gazebo><static>true</static></gazebo><gazebo reference='slab'><material>Gazebo/Grey</material></gazebo></robot>"""
LAMP = "<gazebo reference='slab'><light name='own' type='point'><pose>0 0 1 0 0 0</pose></light></gazebo>"
#: Looks straight down from a metre above.
CAMERA = """<robot name='camera'><link name='body'><inertial><mass value='1'/>
  <inertia ixx='0.01' iyy='0.01' izz='0.01' ixy='0' ixz='0' iyz='0'/></inertial></link>
  <gazebo><static>true</static></gazebo>
  <gazebo reference='body'><sensor type='camera' name='eye'><pose>0 0 0 0 1.5707963267948966 0</pose>
    <update_rate>10</update_rate>
    <camera><horizontal_fov>1.0</horizontal_fov><image><width>40</width><height>30</height></image>
      <clip><near>0.1</near><far>20</far></clip></camera>
    <plugin name='p' filename='libgazebo_ros_camera.so'><cameraName>eye</cameraName></plugin></sensor></gazebo>
</robot>"""
ABOVE = """<light name='any' type='directional'><pose>0 0 5 0 %s 0</pose><diffuse>0.2 0.2 0.2 1</diffuse>
  <specular>0 0 0 1</specular><direction>0 0 -1</direction></light>"""

GREY_DIFFUSE, GREY_AMBIENT, AMBIENT = 0.7, 0.3, 0.4
ROUNDING = 2  #: grey levels; the weak highlight of Gazebo/Grey among them


@pytest.fixture(name="world")
def a_floor_and_a_camera():
    world = World()
    world.spawn("floor", FLOOR % "", pose=matrix_of((0, 0, -0.01), (0, 0, 0, 1), "test"))
    world.spawn("camera", CAMERA, pose=matrix_of((0, 0, 1), (0, 0, 0, 1), "test"))
    return world


def grey(world):
    return int(world.core.render("camera::eye")[15, 20, 0])


def lit(*diffuse):
    return 255 * (AMBIENT * GREY_AMBIENT + GREY_DIFFUSE * sum(diffuse))


SUN_SHARE = 0.8 / numpy.sqrt(1.5)  #: N.L of the sun


def test_the_world_has_the_sun_at_first_and_is_dark_without_it(world):
    assert list(world.lights) == ["sun"]
    assert grey(world) == pytest.approx(lit(SUN_SHARE), abs=ROUNDING)
    world.delete_light("sun")
    assert grey(world) == pytest.approx(lit(), abs=ROUNDING)
    with pytest.raises(UnknownNameError, match="Requested light sun not found!"):
        world.delete_light("sun")


def test_the_ground_plane_is_seen_and_takes_shadows(world):
    world.delete("floor")
    assert grey(world) == pytest.approx(147, abs=ROUNDING), "Gazebo's own"
    roof = FLOOR.replace("4 4 0.02", "0.5 0.5 0.02") % ""
    world.spawn("roof", roof, pose=matrix_of((0.5, -0.5, 1.0), (0, 0, 0, 1), "test"))  # towards the sun
    assert grey(world) == pytest.approx(31, abs=ROUNDING)


def test_nothing_casts_shadows_in_a_world_without_them():
    world = World(WorldSettings(shadows=False))
    world.spawn("camera", CAMERA, pose=matrix_of((0, 0, 1), (0, 0, 0, 1), "test"))
    bright = grey(world)
    world.spawn("roof", FLOOR.replace("4 4 0.02", "0.5 0.5 0.02") % "",
                pose=matrix_of((0.5, -0.5, 1.0), (0, 0, 0, 1), "test"))
    assert grey(world) == bright
    world.reset_simulation()
    world.set_light({**world.lights["sun"], "casts_shadows": True})
    assert grey(world) == bright


def test_lights_come_change_and_shine_for_cameras_that_come_later(world):
    world.delete_light("sun")
    world.spawn_light("lamp", ABOVE % 0)
    assert grey(world) == pytest.approx(lit(0.2), abs=ROUNDING)
    world.set_light(dict(world.lights["lamp"], intensity=2.0))
    assert grey(world) == pytest.approx(lit(0.4), abs=ROUNDING)
    world.delete("camera")
    world.spawn("camera", CAMERA, pose=matrix_of((0, 0, 1), (0, 0, 0, 1), "test"))
    assert grey(world) == pytest.approx(lit(0.4), abs=ROUNDING)


def test_lights_and_other_models_are_there_after_a_reset(world):
    world.delete_light("sun")
    world.spawn_light("lamp", ABOVE % 0)
    world.step(10)
    world.reset_simulation()
    assert list(world.lights) == ["lamp"] and grey(world) == pytest.approx(lit(0.2), abs=ROUNDING)


def test_a_spawned_light_stands_in_the_frame_and_pose_it_is_given(world):
    world.delete_light("sun")
    world.spawn_light("aslant", ABOVE % 0, matrix_of((0, 0, 0), (0, numpy.sin(0.5), 0, numpy.cos(0.5)), "test"))
    assert grey(world) == pytest.approx(lit(0.2 * numpy.cos(1.0)), abs=ROUNDING)
    bulb = "<light name='b' type='point'><pose>0 0 1 0 0 0</pose></light>"
    world.spawn_light("bulb", bulb, matrix_of((1, 0, 0), (0, 0, 0, 1), "test"), "camera")
    assert world.lights["bulb"]["position_m"] == pytest.approx([1.0, 0.0, 2.0])


def test_lights_of_links_are_seen_by_the_cameras_of_other_models():
    world = World()
    world.spawn("camera", CAMERA, pose=matrix_of((0, 0, 1), (0, 0, 0, 1), "test"))
    world.spawn("floor", FLOOR % LAMP, pose=matrix_of((0, 0, -0.01), (0, 0, 0, 1), "test"))
    world.delete_light("sun")
    # One metre above the slab's middle, of the attenuation 1 / (1 + d) that SDF has where none is given.
    assert grey(world) == pytest.approx(lit(1.0 / (1.0 + 0.99)), abs=ROUNDING + 1)


def test_what_cannot_be_is_refused_and_changes_nothing(world):
    before = grey(world)
    for name, xml, text in (("sun", ABOVE % 0, "entity already exists"),
                            ("lamp", "<light name='a' type='laser'/>", "laser"),
                            ("lamp", "<light name='a' type='directional'><direction>0 0 0</direction></light>", "zero"),
                            ("lamp", "<light", "format is invalid")):
        with pytest.raises(ModelError, match=text):
            world.spawn_light(name, xml)
    for place in (world, World()):
        with pytest.raises(ParameterError, match="color_rgb"):
            place.set_light(dict(place.lights["sun"], color_rgb=[-1.0, 0.0, 0.0]))
        with pytest.raises(ParameterError, match="zero of light 'sun'"):
            place.set_light(dict(place.lights["sun"], direction=[0.0, 0.0, 0.0]))
    assert list(world.lights) == ["sun"] and grey(world) == before
    for k in range(MOST - 1):
        world.spawn_light("lamp%d" % k, ABOVE % 0)
    with pytest.raises(ParameterError, match="found 9, allowed up to 8"):
        world.spawn_light("one_more", ABOVE % 0)
