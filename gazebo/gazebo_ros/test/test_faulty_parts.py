"""Descriptions with one fault each, made from models of the repository: the world goes on, and the part is named.

`python3 test_faulty_parts.py 1000` tries as many, from another seed, and prints those that are refused.
"""
import copy
import pathlib
import random
import sys
import xml.etree.ElementTree as ElementTree

from aras_visual_servo_sim import ArasError, ModelError

from gazebo_ros.sdf.document import NoFolders
from gazebo_ros.sdf.world import read_world
from gazebo_ros.world.world import World

ROOT = pathlib.Path(__file__).resolve().parents[3]
URDFS = ["tests/from_gazebo/robot/pan_tilt.urdf", "tests/ci/lab_head/urdf/head.urdf", "examples/scara/scara.urdf",
         "src/aras_visual_servo_sim/test/urdf/mimic_gripper.urdf",
         "src/aras_visual_servo_sim/test/urdf/two_link_full.urdf", "src/aras_description/urdf/free_camera.urdf"]
#: A world as Gazebo saves it.
SAVED = """<sdf version='1.6'><world name='default'>
<gravity>0 0 -9.8</gravity><physics type='ode'><max_step_size>0.001</max_step_size>
<real_time_update_rate>1000</real_time_update_rate></physics>
<scene><ambient>0.4 0.4 0.4 1</ambient><background>0.7 0.7 0.7 1</background><shadows>1</shadows></scene>
<light name='sun' type='directional'><pose frame=''>0 0 10 0 0 0</pose><diffuse>0.8 0.8 0.8 1</diffuse>
<direction>-0.5 0.5 -1</direction><cast_shadows>1</cast_shadows></light>
<model name='arm'><pose frame=''>0 0 0.5 0 0 0</pose>
<link name='base'><pose frame=''>0 0 0 0 0 0</pose><inertial><mass>1</mass><inertia><ixx>0.1</ixx><ixy>0</ixy>
<ixz>0</ixz><iyy>0.1</iyy><iyz>0</iyz><izz>0.1</izz></inertia></inertial>
<collision name='c'><geometry><box><size>0.4 0.4 0.4</size></box></geometry>
<surface><friction><ode><mu>1</mu><mu2>1</mu2></ode></friction></surface></collision></link>
<link name='hand::palm'><pose frame=''>0.5 0 0 0 0 0</pose><inertial><mass>0.2</mass></inertial>
<visual name='v'><pose frame=''>0 0 0 0 0 0</pose>
<geometry><cylinder><radius>0.1</radius><length>0.2</length></cylinder></geometry>
<material><diffuse>1 0 0 1</diffuse></material></visual>
<sensor name='eye' type='camera'><update_rate>10</update_rate><camera><horizontal_fov>1</horizontal_fov><image>
<width>16</width><height>12</height><format>R8G8B8</format></image><clip><near>0.1</near><far>20</far></clip></camera>
<plugin name='p' filename='libgazebo_ros_camera.so'><cameraName>eye</cameraName></plugin></sensor></link>
<joint name='hand::turn' type='revolute'><parent>base</parent><child>hand::palm</child>
<axis><xyz>0 1 0</xyz><limit><lower>-1</lower><upper>1</upper><effort>5</effort><velocity>2</velocity></limit>
<dynamics><damping>0.1</damping><friction>0</friction></dynamics></axis></joint>
<plugin name='imu' filename='libgazebo_ros_imu.so'><bodyName>base</bodyName><updateRate>50</updateRate></plugin></model>
<state world_name='default'><sim_time>1 0</sim_time><model name='arm'><pose frame=''>0 0 1 0 0 0</pose></model></state>
</world></sdf>"""
#: A cart with what plugins do.
CART = """<robot name='cart'><link name='base'><inertial><mass value='5'/>
<inertia ixx='0.1' ixy='0' ixz='0' iyy='0.1' iyz='0' izz='0.1'/></inertial>
<collision><geometry><box size='0.4 0.3 0.1'/></geometry></collision></link>
<link name='left'><inertial><mass value='0.5'/><inertia ixx='0.001' ixy='0' ixz='0' iyy='0.001' iyz='0' izz='0.001'/>
</inertial><collision><geometry><cylinder radius='0.1' length='0.05'/></geometry></collision></link>
<link name='right'><inertial><mass value='0.5'/><inertia ixx='0.001' ixy='0' ixz='0' iyy='0.001' iyz='0' izz='0.001'/>
</inertial><collision><geometry><sphere radius='0.1'/></geometry></collision></link>
<joint name='left_wheel' type='continuous'><origin xyz='0 0.2 0' rpy='-1.57 0 0'/><parent link='base'/>
<child link='left'/><axis xyz='0 0 1'/></joint>
<joint name='right_wheel' type='continuous'><origin xyz='0 -0.2 0' rpy='-1.57 0 0'/><parent link='base'/>
<child link='right'/><axis xyz='0 0 1'/></joint>
<link name='mast'/><joint name='mount' type='fixed'><parent link='base'/><child link='mast'/></joint>
<transmission name='t'><type>transmission_interface/SimpleTransmission</type><joint name='left_wheel'>
<hardwareInterface>VelocityJointInterface</hardwareInterface></joint><actuator name='m'/></transmission>
<gazebo reference='left'><mu1>1.0</mu1><material>Gazebo/Red</material><selfCollide>true</selfCollide></gazebo>
<gazebo reference='mast'><light name='lamp' type='spot'><pose>0 0 1 0 0 0</pose><diffuse>1 1 1 1</diffuse>
<spot><inner_angle>0.2</inner_angle><outer_angle>0.6</outer_angle><falloff>1</falloff></spot></light>
<sensor name='lidar' type='ray'><pose>0 0 0.2 0 0 0</pose><update_rate>10</update_rate><ray><scan><horizontal>
<samples>9</samples><min_angle>-1</min_angle><max_angle>1</max_angle></horizontal></scan><range><min>0.1</min><max>9</max>
</range></ray><plugin name='l' filename='libgazebo_ros_laser.so'><topicName>scan</topicName></plugin></sensor>
<sensor name='kinect' type='depth'><update_rate>20</update_rate><camera><horizontal_fov>1.0</horizontal_fov><image>
<width>16</width><height>12</height><format>B8G8R8</format></image><clip><near>0.05</near><far>8</far></clip></camera>
<plugin name='k' filename='libgazebo_ros_openni_kinect.so'><cameraName>kinect</cameraName>
<pointCloudCutoff>0.3</pointCloudCutoff><frameName>mast</frameName></plugin></sensor></gazebo>
<gazebo><plugin name='d' filename='libgazebo_ros_diff_drive.so'><leftJoint>left_wheel</leftJoint>
<rightJoint>right_wheel</rightJoint><wheelDiameter>0.2</wheelDiameter><updateRate>50</updateRate></plugin></gazebo>
<gazebo><plugin name='i' filename='libgazebo_ros_imu.so'><bodyName>mast</bodyName><gaussianNoise>0.1</gaussianNoise>
</plugin></gazebo></robot>"""
WRONG = ("-1", "0", "nan", "inf", "1e300", "text", "", "1 2", "-0.001", "99999999999", "0 0 0", "-1 -1 -1")
SEED, COUNT = 1, 100
MOST_PIXELS = 4096  #: of an image that is drawn: others take longer than all else
SHARE_OF_SDF = 10  #: one of so many is of SDF, which takes longer


def with_one_fault(text, numbers):
    """A document with one fault, and the names of which one must be said: of what has the fault, and around it.

    Args: numbers: random.Random.
    """
    root = ElementTree.fromstring(text)
    parents = {child: parent for parent in root.iter() for child in parent}
    element = numbers.choice(list(parents))
    names, at = {element.tag}, element
    while at is not None:
        names |= {at.get(key) for key in ("name", "reference", "filename") if at.get(key)}
        at = parents.get(at)
    names |= {each.get("name") for each in element.iter() if each.get("name")}
    names |= {each.get("link") for each in element.iter() if each.get("link")}
    kind = numbers.choice(("attribute", "attribute", "value", "value", "drop", "double", "rename"))
    if kind == "attribute" and element.attrib:
        del element.attrib[numbers.choice(sorted(element.attrib))]
    elif kind == "value" and (element.attrib or element.text and element.text.strip()):
        if element.attrib and not (element.text and element.text.strip() and numbers.random() < 0.5):
            element.set(numbers.choice(sorted(element.attrib)), numbers.choice(WRONG))
        else:
            element.text = numbers.choice(WRONG)
    elif kind == "double":
        parents[element].append(copy.deepcopy(element))
    elif kind == "rename":
        element.tag += "_2"
    else:
        parents[element].remove(element)
    return ElementTree.tostring(root, encoding="unicode"), {name for name in names if name}


class Packages(NoFolders):
    """The packages and models of the repository."""

    def __call__(self, name):
        return next((str(place / name) for place in (ROOT / "src", ROOT / "gazebo/gazebo_ros/models")
                     if (place / name).is_dir()), None)


def come_up(text):
    """Spawns what a document describes, steps, draws; returns the world and what was warned about."""
    folders = Packages()
    if text.lstrip().startswith("<sdf"):
        file = read_world(text, False, folders)
        world = World(file.settings, folders)
        warnings = [*file.warnings, *world.take_lights(file.lights)]
        for model, pose in file.models:
            try:
                warnings += world.place_sdf(model.name, model, pose).warnings
            except ModelError as error:
                warnings.append("%s: %s" % (model.name, error))
    else:
        world = World(None, folders)
        warnings = list(world.spawn("m", text).warnings)
    world.step(20)
    for camera in world.core.camera_names:
        info = world.core.camera_info(camera)
        if info["width"] * info["height"] <= MOST_PIXELS:
            world.core.render(camera)
    for model in world.models.values():
        for link in model.bodies:
            model.link_pose(link)
    return world, warnings


def faulty(count, seed):
    """Yields the number of a fault, the document, and the names of which one must be said."""
    numbers = random.Random(seed)
    for k in range(count):
        text = SAVED if k % SHARE_OF_SDF == 0 else numbers.choice([CART, *URDFS])
        text = text if text.startswith("<") else (ROOT / text).read_text()
        yield (k, *with_one_fault(text, numbers))


def test_a_fault_of_a_part_leaves_the_world_and_is_named():
    came_up = 0
    for k, text, names in faulty(COUNT, SEED):
        try:
            world, _ = come_up(text)
            came_up += bool(world.models)
        except ModelError as error:
            assert any(name in str(error) for name in names), (k, names, str(error))
    assert came_up > 0.7 * COUNT  # the rest has no tree of links and joints, which urdfdom refuses too


def main():
    count, seed = int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else SEED + 1
    refused = silent = 0
    for k, text, names in faulty(count, seed):
        try:
            come_up(text)
        except ArasError as error:
            refused += 1
            said = any(name in str(error) for name in names)
            silent += not said
            print(k, "" if said else "NAMELESS", type(error).__name__, str(error)[:200])
    print("%d of %d refused, %d without a name" % (refused, count, silent))


if __name__ == "__main__":
    main()
