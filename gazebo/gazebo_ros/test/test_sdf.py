"""Models and worlds of SDF without ROS: what is read of them moves, collides, is seen and is lit as they say."""
import os

import numpy
import pytest

from aras_visual_servo_sim import ModelError

from gazebo_ros.world.poses import matrix_of
from gazebo_ros.sdf.document import NoFolders, expanded, found
from gazebo_ros.sdf.model import model_of
from gazebo_ros.sdf.world import EMPTY_WORLD, read_world
from gazebo_ros.world.world import World

OWN_MODELS = os.path.join(os.path.dirname(__file__), os.pardir, "models")
ROUNDING = 1e-9
BOX = """<model name='box'><pose>0 0 1 0 0 0</pose><link name='body'>
  <inertial><mass>2</mass><inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz></inertia></inertial>
  <collision name='c'><geometry><box><size>0.4 0.4 0.4</size></box></geometry></collision>
  <visual name='v'><geometry><box><size>0.4 0.4 0.4</size></box></geometry>
    <material><script><name>Gazebo/Red</name></script></material></visual></link></model>"""
#: The joint stands half a metre beside its child link, and its axis is given in the model's frame.
PENDULUM = """<model name='pendulum'>
  <link name='base'><pose>0 0 1 0 0 0</pose></link>
  <link name='arm'><pose>0.5 0 1 0 0 1.5707963267948966</pose>
    <inertial><mass>1</mass><inertia><ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia></inertial></link>
  <joint name='to_world' type='fixed'><parent>world</parent><child>base</child></joint>
  <joint name='swing' type='revolute'><pose relative_to='base'>0 0 0 0 0 0</pose>
    <parent>base</parent><child>arm</child>
    <axis><xyz expressed_in='__model__'>0 1 0</xyz><limit><lower>-3</lower><upper>3</upper></limit></axis></joint>
  <plugin name='c' filename='libgazebo_ros_control.so'/></model>"""
CAMERA = """<model name='watcher'><static>true</static><link name='body'>
  <sensor name='eye' type='camera'><update_rate>10</update_rate><camera><horizontal_fov>1.0</horizontal_fov>
    <image><width>40</width><height>30</height></image><clip><near>0.1</near><far>20</far></clip></camera>
    <plugin name='p' filename='libgazebo_ros_camera.so'><cameraName>eye</cameraName></plugin></sensor></link></model>"""


class OwnModels(NoFolders):
    """The models that come with the package, and those of one other folder."""

    def __init__(self, other=""):
        self._places = [place for place in (str(other), OWN_MODELS) if place]

    def __call__(self, name):
        return next((os.path.join(place, name) for place in self._places if os.path.isdir(os.path.join(place, name))),
                    None)


def sdf(text, version="1.7"):
    return "<sdf version='%s'>%s</sdf>" % (version, text)


def at(x=0.0, y=0.0, z=0.0):
    return matrix_of((x, y, z), (0, 0, 0, 1), "test")


def filled(text, folders=None):
    """World of a world file's text, and what was warned about."""
    folders = folders or OwnModels()
    file = read_world(sdf("<world name='w'>%s</world>" % text), False, folders)
    world = World(file.settings, folders)
    warnings = [*file.warnings, *world.take_lights(file.lights)]
    for model, pose in file.models:
        warnings += world.place_sdf(model.name, model, pose).warnings
    return world, "\n".join(warnings)


def test_a_model_falls_from_where_it_is_spawned_onto_the_ground():
    world = World()
    box = world.spawn_sdf("crate", sdf(BOX), pose=at(x=3.0))
    assert box.pose()[:3, 3] == pytest.approx([3.0, 0.0, 1.0]), "its own pose stands in that of the spawn"
    world.step(2000)
    assert box.pose()[:3, 3] == pytest.approx([3.0, 0.0, 0.2], abs=1e-3)  # the ground gives way by the weight
    assert box.links == ["body"] and list(world.models) == ["crate"]


def test_a_joint_may_stand_beside_its_child_link():
    world = World()
    model = world.spawn_sdf("one", sdf(PENDULUM))
    assert model.links == ["base", "arm"] and model.simulation.joint_names == ["swing"]
    assert model.description.fixed and model.description.control_namespace == "/one"
    assert model.link_pose("arm")[:3, 3] == pytest.approx([0.5, 0.0, 1.0])
    model.set_joints({"swing": 0.3})
    pose = model.link_pose("arm")
    assert pose[:3, 3] == pytest.approx([0.5 * numpy.cos(0.3), 0.0, 1.0 - 0.5 * numpy.sin(0.3)])
    assert pose[:3, :3] @ (1, 0, 0) == pytest.approx([0, 1, 0], abs=ROUNDING), "the link is turned by its own pose"


def test_a_free_model_is_where_its_own_frame_is():
    world = World()
    model = world.spawn_sdf("m", sdf(BOX.replace("<link name='body'>", "<link name='body'><pose>0 0 0.5 0 0 0</pose>")))
    assert model.pose()[2, 3] == pytest.approx(1.0) and model.link_pose("body")[2, 3] == pytest.approx(1.5)
    model.place(at(z=2.0), numpy.zeros(6))
    assert model.pose()[2, 3] == pytest.approx(2.0) and model.link_pose("body")[2, 3] == pytest.approx(2.5)


def test_joints_take_controllers_by_the_transmissions_of_a_urdf():
    described = """<robot name='r'><transmission name='t'><joint name='swing'>
        <hardwareInterface>PositionJointInterface</hardwareInterface></joint></transmission>
      <transmission name='u'><joint name='nobody'/></transmission></robot>"""
    model = World().spawn_sdf("one", sdf(PENDULUM), transmissions=described)
    assert model.description.actuated == ("swing",)


@pytest.fixture
def crate(tmp_path):
    """Folders with the model crate."""
    folder = tmp_path / "crate"
    folder.mkdir()
    (folder / "model.config").write_text("<model><name>crate</name><sdf version='1.7'>model.sdf</sdf></model>")
    (folder / "model.sdf").write_text(sdf(BOX))
    return OwnModels(tmp_path)


def test_what_is_included_is_found_placed_and_renamed(crate):
    world, warnings = filled("""<include><uri>model://crate</uri><name>first</name><pose>1 0 0.2 0 0 0</pose></include>
        <include><uri>model://crate</uri><static>true</static><pose>2 0 0 0 0 0</pose></include>
        <include><uri>model://nowhere</uri></include>""", crate)
    assert list(world.models) == ["first", "box"] and "model://nowhere" in warnings
    assert world.models["first"].pose()[:3, 3] == pytest.approx([1.0, 0.0, 0.2])
    assert world.models["box"].description.fixed and not world.models["first"].description.fixed


def test_links_of_models_in_a_model_have_their_names_before_theirs_in_the_order_of_the_document(crate):
    world, _ = filled("""<model name='rack'><link name='base'/><include><uri>model://crate</uri><name>cargo</name>
        <pose>0 0 2 0 0 0</pose></include><link name='last'/><model name='shelf'><link name='board'/>
        <model name='edge'><link name='strip'/></model></model>%s</model>""" % "".join(
        "<joint name='j%d' type='fixed'><parent>base</parent><child>%s</child></joint>" % (k, child)
        for k, child in enumerate(("cargo::body", "last", "shelf::board", "shelf::edge::strip"))), crate)
    rack = world.models["rack"]
    assert rack.bodies == ["base", "cargo::body", "last", "shelf::board", "shelf::edge::strip"]
    assert world.frame("rack::cargo::body")[0][2, 3] == rack.link_pose("cargo::body")[2, 3] == pytest.approx(2.0)


def test_the_empty_world_has_the_ground_and_the_sun():
    file = read_world(EMPTY_WORLD, False, OwnModels())
    assert file.settings == World().settings and not file.models and not file.warnings
    world = World(file.settings)
    world.take_lights(file.lights)
    assert {**World().lights["sun"], "intensity": 1.0} == world.lights["sun"]


def test_the_ground_and_the_sun_of_a_database_are_known_without_it():
    place = "https://fuel.gazebosim.org/1.0/OpenRobotics/models/"
    world, warnings = filled("<include><uri>%sSun</uri></include><include><uri>%sGround Plane</uri></include>"
                             "<include><uri>%sCoke</uri></include>" % (place, place, place))
    assert world.settings.ground and list(world.lights) == ["sun"] and "Coke" in warnings


def test_what_is_used_is_not_said_to_be_ignored():
    model = World().spawn_sdf("m", sdf(BOX.replace("<link", "<static>1</static><link", 1).replace(
        "</geometry></coll", "</geometry><surface><friction><ode><mu>0.3</mu></ode></friction></surface></coll")))
    assert model.warnings == [] and model.description.frictions == {"body": 0.3}


def test_physics_gravity_and_light_are_the_worlds():
    world, _ = filled("""<physics type='ode'><max_step_size>0.002</max_step_size></physics><gravity>0 0 -1.6</gravity>
        <scene><ambient>1 1 1 1</ambient><background>0 0 1 1</background><shadows>0</shadows></scene>
        <light name='lamp' type='point'><pose>0 0 3 0 0 0</pose></light>""" + BOX + CAMERA)
    assert world.settings.period_s == 0.002 and not world.settings.ground and not world.settings.shadows
    assert list(world.lights) == ["lamp"]
    world.step(500)
    fallen_m = 1.0 - world.models["box"].pose()[2, 3]
    assert fallen_m == pytest.approx(0.5 * 1.6 * 1.0 ** 2, rel=2.5e-3)  # first order in the step of 2 ms
    assert world.core.render("watcher::eye")[2, 2].tolist() == [0, 0, 255]


def test_the_state_of_a_saved_world_places_its_models():
    world, _ = filled(BOX + "<state world_name='w'><model name='box'><pose>5 0 3 0 0 0</pose></model></state>")
    assert world.models["box"].pose()[:3, 3] == pytest.approx([5.0, 0.0, 3.0])


def test_visuals_have_the_colours_that_sdf_gives_them():
    colours = {"<script><name>Gazebo/Red</name></script>": lambda r, g, b: r > 50 and g == b == 0,
               "<ambient>0 1 0 1</ambient><diffuse>0 1 0 1</diffuse>": lambda r, g, b: g > 50 and r == b == 0,
               "": lambda r, g, b: r == g == b > 50}
    for inside, right in colours.items():
        material = "<material>%s</material>" % inside if inside else ""
        red = "<material><script><name>Gazebo/Red</name></script></material>"
        world, _ = filled("<include><uri>model://sun</uri></include>" + CAMERA +
                          BOX.replace(red, material).replace("0 0 1 0 0 0", "2 0 0 0 0 0"))
        assert right(*world.core.render("watcher::eye")[15, 20].tolist()), inside


def test_what_is_not_simulated_is_ignored_by_name():
    world, warnings = filled("""<actor name='walker'/><population name='crowd'><model name='x'><link name='l'/></model>
        </population><plugin name='p' filename='libweather.so'/><strange/>
        <model name='m'><static>true</static><odd/><link name='l'>
          <visual name='v'><geometry><heightmap><uri>h.png</uri></heightmap></geometry></visual>
          <collision name='c'><geometry><heightmap><uri>h.png</uri></heightmap></geometry></collision>
          <visual name='w'><geometry><mesh><uri>model://gone/a.dae</uri></mesh></geometry></visual>
          <visual name='x'><geometry><box><size>1 1 1</size></box></geometry>
            <material><script><name>Own/Marble</name></script></material></visual></link></model>
        <model name='n'><link name='l'/><joint name='j' type='revolute'><parent>l</parent><child>ghost</child>
          <axis><xyz>0 0 1</xyz></axis></joint><plugin name='p' filename='libspin.so'/></model>""")
    for text in ("<actor name='walker'>", "<population name='crowd'>", "libweather.so", "strange", "odd",
                 "<visual> of link 'l': terrain (<heightmap>) is not simulated: ignored, cameras do not see it",
                 "<collision> of link 'l': terrain (<heightmap>) is not simulated: ignored, nothing can touch it",
                 "model://gone/a.dae", "Own/Marble", "joint 'j': there is no link 'ghost'", "libspin.so"):
        assert text in warnings, warnings
    assert list(world.models) == ["m", "n"]
    world.step(10)


def test_loops_and_unknown_joints_are_held_or_left_out():
    legs = "".join("<link name='%s'/>" % name for name in "abc")
    ends = (("a", "b", "revolute"), ("b", "c", "ball"), ("c", "a", "revolute"))
    joint = "<joint name='%s%s' type='%s'><parent>%s</parent><child>%s</child><axis><xyz>0 0 1</xyz></axis></joint>"
    joints = "".join(joint % (a, b, kind, a, b) for a, b, kind in ends)
    root, _ = expanded(sdf("<model name='m'>%s</model>" % (legs + joints)), False, NoFolders())
    model = model_of(root.find("model"), NoFolders())
    warnings = "\n".join(model.warnings)
    assert "joint 'ca' closes a loop" in warnings and "joint 'bc' of type ball is not simulated: it is held" in warnings
    assert World().place_sdf("m", model, at()).simulation.joint_names == ["ab"]


def test_what_is_no_sdf_is_refused_and_the_world_goes_on():
    world = World()
    world.spawn_sdf("one", sdf(BOX))
    for name, text, message in (("one", sdf(BOX), "entity already exists"), ("two", "<sdf", "format is invalid"),
                                ("two", sdf(""), "neither <model> nor <light>"),
                                ("two", sdf("<include><uri>model://none</uri></include>"), "model://none")):
        with pytest.raises(ModelError, match=message):
            world.spawn_sdf(name, text)
    with pytest.raises(ModelError, match="found no <world>"):
        read_world(sdf(BOX), False, NoFolders())
    assert list(world.models) == ["one"]
    world.step(10)


@pytest.mark.parametrize("is_path", (False, True))
def test_times_of_a_saved_state_need_no_nanoseconds(tmp_path, is_path):
    text = ("<sdf version='1.7'><world name='w'><state world_name='w'><sim_time>0</sim_time><real_time> 7 </real_time>"
            "<wall_time>3 4</wall_time><iterations>66</iterations></state></world></sdf>")
    path = tmp_path / "saved.world"
    path.write_text(text, encoding="utf-8")
    root, _ = expanded(str(path) if is_path else text, is_path, NoFolders())
    assert [root.findtext("world/state/" + key).split() for key in ("sim_time", "real_time", "wall_time")] == [
        ["0", "0"], ["7", "0"], ["3", "4"]]


def test_a_path_of_another_machine_is_found_in_the_package_that_it_names(tmp_path):
    (tmp_path / "arm" / "meshes").mkdir(parents=True)
    mesh = tmp_path / "arm" / "meshes" / "base.stl"
    mesh.write_text("")

    class Packages(NoFolders):
        def __call__(self, name):
            return str(tmp_path / name) if (tmp_path / name).is_dir() else None

    for place in ("/opt/ros/melodic/share/arm", "file:///home/Somebody/ws/src/arm"):
        assert found(place + "/meshes/base.stl", Packages()) == str(mesh)
        assert found(place + "/meshes/other.stl", Packages()) == ""
    assert found("/meshes/base.stl", Packages()) == "" and found(str(mesh), NoFolders()) == str(mesh)
