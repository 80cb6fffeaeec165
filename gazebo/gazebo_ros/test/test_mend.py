"""What stands in for a faulty part: the values that the simulator gets, and the names that the warnings have."""
import pathlib
import re
import xml.etree.ElementTree as ElementTree

import numpy
import pytest

from aras_visual_servo_sim import ModelError

from gazebo_ros.faults import FAULTS
from gazebo_ros.sdf.document import NoFolders
from gazebo_ros.sdf.world import EMPTY_WORLD, read_world
from gazebo_ros.urdf.mend import nearest_moments
from gazebo_ros.urdf.tree import lumped_links
from gazebo_ros.world.description import read_description
from gazebo_ros.world.world import World

SOURCES = pathlib.Path(__file__).resolve().parents[1] / "src" / "gazebo_ros"
ROUNDING = 1e-9
LIMIT = "<limit lower='-1' upper='1' effort='9' velocity='2'/>"
INERTIA = "<inertia ixx='0.01' iyy='0.01' izz='0.01' ixy='0' ixz='0' iyz='0'/>"
#: An arm of two joints with a fixed camera at its end; parts in braces.
ARM = """<robot name='arm'><link name='world'/>
<joint name='mount' type='fixed'><parent link='world'/><child link='base'/></joint>
<link name='base'><inertial><mass value='1'/>{inertia}</inertial></link>
<joint name='one' type='{kind}'><parent link='base'/><child link='upper'/><axis xyz='{axis}'/>
{limit}{mimic}{dynamics}</joint>
<link name='upper'>{inertial}{visual}</link>
<joint name='two' type='revolute'><parent link='upper'/><child link='tip'/><origin xyz='0 0 0.2' rpy='0 0 0'/>
<axis xyz='0 1 0'/><limit lower='-1' upper='1' effort='9' velocity='2'/></joint>
<link name='tip'><inertial><mass value='1'/><inertia ixx='0.01' iyy='0.01' izz='0.01' ixy='0' ixz='0' iyz='0'/>
</inertial></link>
<joint name='hold' type='fixed'><parent link='tip'/><child link='eye'/></joint><link name='eye'/>
<gazebo reference='eye'><sensor name='cam' type='camera'>{camera}
<plugin name='p' filename='libgazebo_ros_camera.so'>{plugin}
</plugin></sensor></gazebo>{more}</robot>"""
CAMERA = """<camera><horizontal_fov>1</horizontal_fov><image><width>16</width><height>12</height><format>R8G8B8</format>
</image><clip><near>0.1</near><far>9</far></clip></camera>"""
WHOLE = {"inertia": INERTIA, "kind": "revolute", "axis": "0 1 0", "limit": LIMIT, "mimic": "", "dynamics": "",
         "inertial": "<inertial><mass value='1'/>%s</inertial>" % INERTIA, "visual": "", "camera": CAMERA,
         "plugin": "<cameraName>cam</cameraName>", "more": ""}


def arm(**parts):
    return ARM.format(**{**WHOLE, **parts})


def spawned(text, **keys):
    """World and its model of a document."""
    world = World()
    return world, world.spawn("arm", text, **keys)


def limit_of(text, joint="one"):
    """type, lower, upper, effort, velocity that the simulator gets."""
    element = ElementTree.fromstring(read_description(text, "", "arm").urdf).find("joint[@name='%s']" % joint)
    limit = element.find("limit")
    return (element.get("type"), *(None if limit is None or limit.get(key) is None else float(limit.get(key))
                                   for key in ("lower", "upper", "effort", "velocity")))


def test_a_model_without_a_fault_is_not_told_of_one():
    _, model = spawned(arm())
    assert not [line for line in model.warnings if ": found " in line]
    assert model.simulation.joint_names == ["one", "two"]


@pytest.mark.parametrize("parts, expected, name", [
    ({"limit": "<limit lower='-1' upper='1' effort='9' velocity='0'/>"}, ("revolute", -1, 1, 9, 1000), "velocity '0'"),
    ({"limit": "<limit lower='-1' upper='1' velocity='2'/>"}, ("revolute", -1, 1, 1e6, 2), "no effort"),
    ({"limit": "<limit lower='-1' upper='1' effort='-3' velocity='2'/>"}, ("revolute", -1, 1, 1e6, 2), "effort '-3'"),
    ({"limit": "<limit lower='2' upper='1' effort='0' velocity='2'/>"}, ("revolute", 1, 2, 0, 2), "lower 2 > upper 1"),
    ({"limit": "<limit lower='x' upper='1' effort='9' velocity='2'/>"}, ("continuous", None, None, 9, 2), "lower 'x'"),
    ({"limit": ""}, ("continuous", None, None, 1e6, 1000), "no <limit>"),
    ({"limit": "", "kind": "prismatic"}, ("prismatic", -1e4, 1e4, 1e6, 1000), "no <limit>"),
    ({"kind": "planar"}, ("fixed", None, None, None, None), "the type 'planar'"),
    ({"kind": "floating"}, ("fixed", None, None, None, None), "the type 'floating'")])
def test_limits_and_types_of_a_joint(parts, expected, name):
    assert limit_of(arm(**parts)) == expected
    _, model = spawned(arm(**parts))
    assert any("joint 'one'" in line and name in line for line in model.warnings), model.warnings


@pytest.mark.parametrize("parts, names", [
    ({"mimic": "<mimic joint='none'/>"}, "'none'"),
    ({"mimic": "<mimic joint='one'/>"}, "'one', which follows this one"),
    ({"mimic": "<mimic joint='hold'/>"}, "'hold', which does not move"),
    ({"mimic": "<mimic joint='two' offset='7'/>"}, "exclude each other"),
    ({"axis": "0 0 0"}, "xyz '0 0 0'"), ({"dynamics": "<dynamics damping='-1'/>"}, "damping"),
    ({"dynamics": "<safety_controller k_velocity='-1'/>"}, "k_velocity '-1'"),
    ({"visual": "<visual><geometry><box size='1 0 1'/></geometry></visual>"}, "<visual>"),
    ({"visual": "<collision><geometry><capsule/></geometry></collision>"}, "<capsule>"),
    ({"visual": "<visual><geometry><mesh filename='file:///none.obj'/></geometry></visual>"}, "none.obj"),
    ({"more": "<gazebo reference='tip'><light name='lamp' type='moon'/></gazebo>"}, "'lamp'"),
    ({"more": "<gazebo reference='tip'><mu1>much</mu1></gazebo>"}, "'much'"),
    ({"more": "<gazebo reference='tip'><mu1>1e6</mu1></gazebo>"}, "1e+06"),
    ({"more": "<gazebo><plugin name='i' filename='libgazebo_ros_imu.so'><bodyName>tip</bodyName>"
              "<updateRate>x</updateRate></plugin></gazebo>"}, "<updateRate> 'x'")])
def test_a_fault_costs_its_part_alone(parts, names):
    world, model = spawned(arm(**parts))
    world.step(3)
    assert model.simulation.joint_names == ["one", "two"] and world.core.camera_names == ["arm::cam"]
    assert any(names in line for line in model.warnings), model.warnings


def test_a_moving_link_without_mass_is_left_out_with_what_hangs_from_it():
    light = "<link name='tip'/>"
    text = re.sub(r"<link name='tip'>.*?</link>", light, arm(), flags=re.DOTALL)
    world, model = spawned(text)
    assert model.simulation.joint_names == ["one"] and model.links == ["base", "upper"]
    assert any("'tip'" in line and "'two'" in line and "eye" in line for line in model.warnings)
    assert not world.core.camera_names
    _, still = spawned(arm(inertial=""))  # moves what has a mass
    assert still.simulation.joint_names == ["one", "two"]


def test_a_free_link_without_mass_is_held():
    world, model = spawned("<robot name='r'><link name='flag'><visual><geometry><sphere radius='1'/></geometry>"
                           "</visual></link></robot>")
    world.step(100)
    assert model.pose()[2, 3] == 0.0 and any("'flag'" in line for line in model.warnings)


def test_moments_are_the_nearest_that_a_body_can_have():
    numbers = numpy.random.default_rng(0)
    for _ in range(50):
        wanted = numpy.sort(numbers.normal(0.5, 1.0, 3))
        found = nearest_moments(wanted)
        assert found.min() >= -ROUNDING and 2.0 * found.max() <= found.sum() + ROUNDING
        d = numpy.abs(numbers.normal(0.0, 1.0, (2000, 3)))  # second moments of a body's mass
        bodies = d.sum(1)[:, None] - d
        assert numpy.linalg.norm(bodies - wanted, axis=1).min() >= numpy.linalg.norm(found - wanted) - ROUNDING
        assert nearest_moments(found) == pytest.approx(found, abs=ROUNDING)


def test_an_inertia_that_no_body_has_becomes_one():
    wrong = "<inertia ixx='0.1' iyy='0.1' izz='0.05' ixy='0.1' ixz='0.1' iyz='0.1'/>"
    _, model = spawned(arm(inertia=wrong))
    values = ElementTree.fromstring(model.description.urdf).find("link[@name='base']/inertial/inertia").attrib
    xx, yy, zz, xy, xz, yz = (float(values[key]) for key in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz"))
    moments = numpy.linalg.eigvalsh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    assert moments[0] >= -ROUNDING and moments[2] <= moments[0] + moments[1] + ROUNDING
    assert any("link 'base'" in line and "-0.0350781" in line for line in model.warnings)


def test_a_mass_and_an_inertia_that_are_no_numbers_are_those_of_sdf():
    _, model = spawned(arm(inertial="<inertial><mass value='heavy'/><inertia ixx='x'/></inertial>"))
    own = model.properties_of("upper")
    assert own.mass_kg == 1.0 and own.inertia_kg_m2 == (1.0, 0.0, 0.0, 1.0, 0.0, 1.0)


@pytest.mark.parametrize("camera, size, f_px", [
    ("", (320, 240), 160.0 / numpy.tan(0.5 * 1.047)), ("<camera/>", (320, 240), 160.0 / numpy.tan(0.5 * 1.047)),
    (CAMERA.replace("<width>16</width>", ""), (320, 12), 160.0 / numpy.tan(0.5)),
    (CAMERA.replace("<height>12", "<height>-12"), (16, 240), 8.0 / numpy.tan(0.5)),
    (CAMERA.replace("<horizontal_fov>1", "<horizontal_fov>nan"), (16, 12), 8.0 / numpy.tan(0.5 * 1.047)),
    (CAMERA.replace("R8G8B8", "RGB8"), (16, 12), 8.0 / numpy.tan(0.5)),
    (CAMERA.replace("<near>0.1", "<near>90"), (16, 12), 8.0 / numpy.tan(0.5)),
    (CAMERA.replace("</camera>", "<pose>1 2</pose><noise><stddev>-1</stddev></noise></camera>"), (16, 12),
     8.0 / numpy.tan(0.5))])
def test_a_camera_gets_the_defaults_of_sdf(camera, size, f_px):
    world, model = spawned(arm(camera=camera))
    info = world.core.camera_info("arm::cam")
    assert (info["width"], info["height"]) == size and info["K"][0] == pytest.approx(f_px, rel=ROUNDING)
    assert world.core.camera_encoding("arm::cam") == "rgb8"
    assert any("'cam'" in line and ": found " in line for line in model.warnings)


def test_a_mesh_whose_picture_cannot_be_read_is_seen_without_it(tmp_path):
    (tmp_path / "m.mtl").write_text("newmtl red\nKd 1 0 0\nmap_Kd picture.webp\n")
    (tmp_path / "picture.webp").write_bytes(b"RIFF....WEBP")
    mesh = tmp_path / "m.obj"
    mesh.write_text("mtllib m.mtl\nusemtl red\nv 0 -9 -9\nv 0 9 -9\nv 0 0 9\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n")
    world, model = spawned(arm(visual="<visual><geometry><mesh filename='%s'/></geometry></visual>" % mesh))
    assert any("link 'upper'" in line and "picture.webp" in line for line in model.warnings), model.warnings
    kept = ElementTree.fromstring(model.description.urdf).find("link[@name='upper']/visual/geometry/mesh")
    assert kept is not None and kept.get("filename") != str(mesh)
    world.change_link("arm", "upper", model.properties_of("upper"))  # goes on without the picture


def test_a_picture_of_a_script_that_cannot_be_read_leaves_its_visual_white(tmp_path):
    (tmp_path / "m.material").write_text("material M { technique { pass { texture_unit { texture bad.png } } } }")
    (tmp_path / "bad.png").write_bytes(b"no picture")
    look = ("<gazebo reference='upper'><visual><material><script><uri>file://%s</uri><name>M</name></script></material>"
            "</visual></gazebo>" % tmp_path)
    _, model = spawned(arm(visual="<visual><geometry><box size='1 1 1'/></geometry></visual>", more=look))
    assert any("link 'upper'" in line and "bad.png" in line for line in model.warnings), model.warnings
    color = ElementTree.fromstring(model.description.urdf).find("link[@name='upper']/visual/material/color")
    assert color is not None and color.get("rgba") == "1 1 1 1"


@pytest.mark.parametrize("change, names", [
    ("<child link='eye'/>", ("hold", "[eyes]")), ("<link name='eye'/>", ("hold", "[eye]")),
    ("name='two'", ("'one'", "twice"))])
def test_links_and_joints_that_are_no_tree_are_refused_by_name(change, names):
    instead = {"<child link='eye'/>": "<child link='eyes'/>", "name='two'": "name='one'"}
    text = arm().replace(change, instead.get(change, ""))
    world = World()
    with pytest.raises(ModelError) as caught:
        world.spawn("arm", text)
    assert all(name in str(caught.value) for name in names) and not world.models
    world.spawn("arm", arm())


def test_a_macro_that_xacro_left_is_named_with_its_prefix():
    with pytest.raises(ModelError, match="<xacro:make_eye>"):
        World().spawn("arm", arm().replace("<link name='eye'/>", "<make_eye/>"))


def test_a_property_that_no_part_can_have_is_still_refused():
    world, model = spawned(arm())
    with pytest.raises(ModelError):
        world.change_joint("arm", "one", {"lower": 1.0, "upper": -1.0})
    assert limit_of(model.spawned[1])[1:3] == (-1, 1)


# --- topics and names


@pytest.mark.parametrize("plugin, namespace, image, info", [
    ("<cameraName>c</cameraName>", "", "/c/image_raw", "/c/camera_info"),
    ("<cameraName>c</cameraName>", "/r", "/r/c/image_raw", "/r/c/camera_info"),
    ("<cameraName>/c</cameraName><robotNamespace>q</robotNamespace>", "/r", "/q/c/image_raw", "/q/c/camera_info"),
    ("<cameraName>c</cameraName><robotNamespace/>", "/r", "/arm/c/image_raw", "/arm/c/camera_info"),
    ("", "/r", "/r/image_raw", "/r/camera_info"), ("", "", "/image_raw", "/camera_info"),
    ("<cameraName>c</cameraName><imageTopicName>/a/b</imageTopicName><cameraInfoTopicName>x/i</cameraInfoTopicName>",
     "/r", "/a/b", "/r/c/x/i"),
    ("<cameraName>c</cameraName><imageTopicName>x/</imageTopicName><cameraInfoTopicName>/i</cameraInfoTopicName>", "",
     "/c/x", "/i")])
def test_topics_of_a_camera_are_resolved_as_a_node_handle_does(plugin, namespace, image, info):
    topics = next(iter(read_description(arm(plugin=plugin), namespace, "arm").cameras.values()))
    assert (topics.image, topics.info) == (image, info)


@pytest.mark.parametrize("sensor_hz, plugin_hz, rate_hz", [
    (None, "25.0", 25.0), ("0", "25", 25.0), ("30", "10", 10.0), ("30", "25", 15.0), ("30", "30", 30.0),
    ("30", "60", 30.0), ("30", "0", 30.0), ("30", None, 30.0)])
def test_the_plugin_of_a_camera_leaves_out_images_that_come_sooner_than_its_rate(sensor_hz, plugin_hz, rate_hz):
    text = arm(plugin="" if plugin_hz is None else "<updateRate>%s</updateRate>" % plugin_hz)
    text = re.sub("<update_rate>.*?</update_rate>", "", text)
    if sensor_hz is not None:
        text = text.replace("<camera>", "<update_rate>%s</update_rate><camera>" % sensor_hz, 1)
    sensor = ElementTree.fromstring(read_description(text, "", "arm").urdf).find(".//sensor")
    assert float(sensor.findtext("update_rate")) == pytest.approx(rate_hz)
    assert not any("updateRate" in line for line in spawned(text)[1].warnings)


def test_topics_of_a_camera_that_sees_depth():
    keys = ("<cameraName>k</cameraName><depthImageTopicName>/d</depthImageTopicName><pointCloudTopicName>cloud"
            "</pointCloudTopicName><depthImageCameraInfoTopicName>/i</depthImageCameraInfoTopicName>")
    text = arm(plugin=keys).replace("type='camera'", "type='depth'").replace("ros_camera", "ros_openni_kinect")
    depth = read_description(text, "/r", "arm").cameras["k"].depth
    assert (depth.image, depth.info, depth.points) == ("/d", "/i", "/r/k/cloud")


def test_two_cameras_of_one_name_publish_each_under_its_own_topics():
    second = arm(plugin="<cameraName>rig</cameraName><imageTopicName>%s/image</imageTopicName>")
    sensor = re.search(r"<gazebo reference='eye'>.*?</gazebo>", second, re.DOTALL)[0]
    text = second.replace(sensor, sensor % "left" + (sensor % "right").replace("name='cam'", "name='cam2'"))
    world, model = spawned(text)
    assert {topics.image for topics in model.description.cameras.values()} == {"/rig/left/image", "/rig/right/image"}
    assert set(world.core.camera_names) == {"arm::" + name for name in model.description.cameras}


@pytest.mark.parametrize("tag, links", [
    ("", ["base", "upper", "tip"]),
    ("<gazebo reference='hold'><preserveFixedJoint>true</preserveFixedJoint></gazebo>",
     ["base", "upper", "tip", "eye"]),
    ("<gazebo reference='hold'><disableFixedJointLumping>false</disableFixedJointLumping></gazebo>",
     ["base", "upper", "tip"])])
def test_fixed_joints_put_their_links_into_their_parents(tag, links):
    _, model = spawned(arm(more=tag))
    assert model.bodies == links and "eye" in model.links
    assert model.link_pose("eye") == pytest.approx(model.link_pose("tip"))
    assert not any("preserveFixedJoint" in line or "Lumping" in line for line in model.warnings)


def test_links_come_depth_first_by_the_names_of_their_joints():
    ends = (("b", "root", "x"), ("a", "root", "z"), ("c", "z", "y"))
    joints = ["<joint name='%s' type='continuous'><parent link='%s'/><child link='%s'/></joint>" % each
              for each in ends]
    links = ["<link name='%s'/>" % name for name in ("x", "y", "z", "root")]
    text = "<robot name='r'>%s</robot>" % "".join(links + joints)
    assert lumped_links(ElementTree.fromstring(text)) == ["root", "z", "y", "x"]


def test_models_are_counted_in_the_order_in_which_they_came():
    world = World()
    for name in ("a", "b"):
        world.spawn(name, arm())
    assert world.names == ["ground_plane", "a", "b"]
    world.remove_ground()
    assert world.names == ["a", "b"]
    world.before_ground = set(world.models)
    world.delete("a")
    world.spawn("a", arm())
    assert world.names == ["b", "a"]


# --- SDF


def read(text, version="1.6", folders=NoFolders()):
    return read_world("<sdf version='%s'><world name='w'>%s</world></sdf>" % (version, text), False, folders)


def place(file):
    """World of a file, and all that was warned about."""
    world = World(file.settings)
    warnings = list(file.warnings)
    for model, X_WM in file.models:
        warnings += world.place_sdf(model.name, model, X_WM).warnings
    return world, warnings


@pytest.mark.parametrize("version", ["1.4", "1.6", "1.7"])
def test_names_that_gazebo_saves_stay_as_they_are(version):
    box = ("<visual name='v'><pose frame=''>0 0 0 0 0 0</pose><geometry><sphere><radius>1</radius></sphere></geometry>"
           "</visual>")
    world, warnings = place(read("""<model name='m'><link name='base'/>
        <link name='a::b'><pose frame=''>0 0 1 0 0 0</pose>%s</link>
        <joint name='a::j' type='revolute'><parent>base</parent><child>a::b</child><axis><xyz>0 0 1</xyz></axis></joint>
        </model>""" % box, version))
    model = world.models["m"]
    assert model.bodies == ["base", "a::b"] and model.simulation.joint_names == ["a::j"] and not warnings
    assert model.link_pose("a::b")[2, 3] == 1.0


@pytest.mark.parametrize("text, names, links", [
    ("<link name='l'><pose>0 0 0</pose></link>", ("'l'", "<pose>"), ["l"]),
    ("<link name='l'><inertial><mass>heavy</mass></inertial></link>", ("'l'", "<mass>", "'heavy'"), ["l"]),
    ("<link name='l'/><joint name='j' type='fixed'><parent>l</parent></joint>", ("'j'", "child"), ["l"]),
    ("<link/>", ("<link>", "no name"), ["link_1"]),
    ("<link name='world'/>", ("'world'",), ["world_link"]),
    ("<link name='l'><visual name='v'><geometry><box><size>1 1</size></box></geometry></visual></link>", ("'v'", "1 1"),
     ["l"])])
def test_what_libsdformat_refuses_is_taken_out_by_name(text, names, links):
    world, warnings = place(read("<model name='m'>%s</model><model name='other'><link name='o'/></model>" % text))
    assert [world.models[name].bodies for name in ("m", "other")] == [links, ["o"]]
    assert any(all(name in line for name in names) for line in warnings), warnings


def test_the_world_of_a_file_has_the_defaults_of_sdf_for_what_is_wrong():
    file = read("<physics type='ode'><max_step_size>9</max_step_size></physics><gravity>down</gravity>"
                "<scene><ambient>dark</ambient></scene><model name='m'><link name='l'/></model>")
    known = read_world(EMPTY_WORLD, False, NoFolders()).settings
    assert file.settings.period_s == known.period_s and file.settings.gravity_m_s2 == known.gravity_m_s2
    assert [model.name for model, _ in file.models] == ["m"]
    assert sum(any(tag in line for line in file.warnings) for tag in ("max_step_size", "gravity", "ambient")) == 3


def test_what_a_file_includes_is_mended_too(tmp_path):
    folder = tmp_path / "cup"
    folder.mkdir()
    (folder / "model.config").write_text("<model><name>cup</name><sdf version='1.6'>model.sdf</sdf></model>")
    (folder / "model.sdf").write_text("""<sdf version='1.6'><model name='cup'><link name='a::l'><pose>0 0</pose>
        <visual name='v'><geometry><mesh><uri>cup.obj</uri></mesh></geometry></visual></link></model></sdf>""")
    (folder / "cup.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")

    class Models(NoFolders):
        def __call__(self, name):
            return str(tmp_path / name) if (tmp_path / name).is_dir() else None

    file = read("<include><uri>model://cup</uri></include>", folders=Models())
    world, warnings = place(file)
    assert world.models["cup"].bodies == ["a::l"] and any("model.sdf" in line and "<pose>" in line for line in warnings)
    assert str(folder / "cup.obj") in file.models[0][0].urdf


def test_a_file_may_have_comments_of_any_encoding(tmp_path):
    model = "<model name='a::b'><link name='l'/></model>"
    text = "<sdf version='1.6'><!-- \u4e16\u754c --><world name='w'>%s</world></sdf>" % model
    (tmp_path / "gbk.world").write_bytes(text.encode("gbk"))
    file = read_world(str(tmp_path / "gbk.world"), True, NoFolders())
    assert [model.name for model, _ in file.models] == ["a_b"] and any("a::b" in line for line in file.warnings)


def test_comments_and_ampersands_that_expat_refuses_are_read(tmp_path):
    model = "<model name='%s'><link name='l'><!-- -- <pose>a</pose> ---></link></model>"
    (tmp_path / "loose.world").write_text("<sdf version='1.6'><world name='w'>%s%s</world></sdf>" % (
        model % "cup & can", model % "a&amp;b"))
    file = read_world(str(tmp_path / "loose.world"), True, NoFolders())
    assert [model.name for model, _ in file.models] == ["cup & can", "a&b"] and not file.warnings


@pytest.mark.parametrize("text, cause", [("<sdf version='1.6'><world", "no XML"), ("", "no XML"),
                                         ("<sdf version='1.6'/>", "<world>")])
def test_a_world_that_cannot_be_read_is_refused_with_its_file(tmp_path, text, cause):
    (tmp_path / "bad.world").write_text(text)
    with pytest.raises(ModelError, match="bad.world") as caught:
        read_world(str(tmp_path / "bad.world"), True, NoFolders())
    assert cause in str(caught.value)


def test_every_fault_of_the_table_is_told_somewhere():
    told = set()
    for path in SOURCES.rglob("*.py"):
        told |= set(re.findall(r"[(,] *\"([a-z ]+)\"", path.read_text()))
    assert set(FAULTS) <= told
