"""The <gazebo> tags of a URDF: namespaces of plugins, and whether the model is free."""
import dataclasses
import re
import typing
import xml.etree.ElementTree as ElementTree

from aras_visual_servo_sim import ModelError

from ..faults import told
from ..sdf.loose_xml import parsed
from ..urdf.mend import base_mass, mend
from ..urdf.sensors import mend_sensors
from ..urdf.tree import PRESERVED, check_tree, lumped_links
from .depth_cameras import CameraTopics, is_realsense, own_name, place_of, read_kinects, read_realsense
from .devices import TRUE, Device, file_of, joined, motorize, named, namespace_of, text
from .lenses import replace_lenses
from .looks import drop_missing_meshes, paint_as_gazebo
from .multicameras import split_multicameras, take_prosilicas
from .plugins import read_device
from ..sdf.gazebo_materials import replace_pictures
from ..urdf.unexpanded import require_expanded

#: Plugins that are part of the simulator, by a piece of their file name.
CONTROL, CAMERA = "gazebo_ros_control", "camera"
#: Plugins whose work is done without them.
NEEDLESS = ("mimic_joint",)
NAMED = re.compile(r"(['\">]\s*)(?:package|model)://([^/'\"<]+)")
MOVING = {"revolute": 0, "continuous": 1, "prismatic": 2}
MOST_FRICTION = 1000.0  #: that the simulator takes


@dataclasses.dataclass(frozen=True)
class Description:
    """A model as it is to be simulated."""
    urdf: str               #: text for the simulator
    fixed: bool             #: held in the world, else free
    control_namespace: str  #: where its controller manager is, "" for none
    cameras: dict           #: name of the camera -> CameraTopics
    collides: bool          #: some link has a shape to collide with
    actuated: tuple         #: joints with a <transmission>, sorted: those of hardware_interface
    joint_types: dict       #: of the joints that move, as gazebo_msgs/GetJointProperties numbers them
    weightless: bool        #: every link that has a mass says that gravity does not act on it
    lifted: frozenset       #: else the links that say so
    parents: dict           #: joint -> parent link
    children: dict          #: joint -> child link
    devices: tuple          #: of world/devices.py: plugins other than cameras and ros_control
    frictions: dict         #: link -> coefficient of friction, mu1 of its <gazebo>
    self_collides: frozenset  #: links that touch others of the model that do so too
    retros: dict            #: link -> laserRetro of its <gazebo>, the intensity that lasers see
    bodies: tuple           #: the links that Gazebo has, in its order: those that no fixed joint puts into another
    warnings: tuple         #: about ignored parts, a line each

    @property
    def jointed(self) -> bool:
        """Whether some joint moves."""
        return bool(self.joint_types)


def located(xml: str, find_folder: typing.Callable[[str], typing.Optional[str]]) -> str:
    """A description whose package:// and model:// names are files.

    Args: find_folder: function of the name of a package or model, returns its folder or None; such names stay.
    """
    def path(match: typing.Match[str]) -> str:
        folder = find_folder(match[2])
        return match[0] if folder is None else match[1] + "file://" + folder
    return NAMED.sub(path, xml)


def read_description(xml: str, namespace: str, model: str) -> Description:
    """
    Args:
        xml: a URDF document.
        namespace: of plugins that name none of their own; "" for none.
        model: name of the model, the namespace of a controller plugin that has none at all.
    Returns: Description
    Raises: ModelError: no URDF, or links and joints that are no tree.
    """
    try:
        robot = parsed(xml)
    except (ElementTree.ParseError, ValueError) as error:
        raise ModelError("SpawnModel: Failure - entity format is invalid: %s" % error) from error
    if robot.tag != "robot":
        raise ModelError("SpawnModel: Failure - entity format is invalid: found <%s>, allowed is <robot>" % robot.tag)
    require_expanded(robot)
    check_tree(robot)
    warnings = []
    mend(robot, warnings)
    warnings += drop_strangers(robot) + drop_missing_meshes(robot)
    mend_sensors(robot, warnings)
    free_followers(robot, warnings)
    split_multicameras(robot, warnings)
    replace_lenses(robot, warnings)
    take_prosilicas(robot, warnings)
    warnings += replace_pictures(robot)
    paint_as_gazebo(robot)
    control, devices = "", []
    cameras = cameras_of(robot, namespace, model, warnings)
    for gazebo, plugin in [(each, plugin) for each in robot.findall("gazebo") for plugin in each.findall("plugin")]:
        gazebo.remove(plugin)  # the simulator would warn about it, although it is used here
        file = plugin.get("filename", "")
        device = read_device(robot, plugin, None, "", namespace_of(plugin, namespace, model), warnings)
        if CONTROL in file:
            control = joined(text(plugin, "robotNamespace", namespace or model))
        elif device is not None:
            devices.append(device)
        elif not is_realsense(plugin) and not any(piece in file for piece in NEEDLESS):
            warnings.append("plugin %s is not simulated: ignored" % file)
    devices += sensors_of(robot, namespace, model, warnings)
    actuated = tuple(sorted({end.get("name") for end in robot.findall("transmission/joint")}))
    for device in devices:
        if device.motors():
            motorize(robot, device)
    links = {link.get("name") for link in robot.findall("link")}
    heavy = {link.get("name") for link in robot.findall("link") if link.find("inertial") is not None}
    parents, children = ends_of(robot, "parent"), ends_of(robot, "child")
    bodies = lumped_links(robot)
    for _ in said(robot, *PRESERVED):
        pass
    fixed = links - set(children.values()) == {"world"}
    static = [is_true(words) for _, words in said(robot, "static")]
    fixed = fixed or any(static)
    if not fixed and base_mass(robot) <= 0.0:
        warnings.append(told("massless base", "link '%s'" % next(iter(links - set(children.values()))), "no mass"))
        fixed = True
    self_collides = {link for link, words in said(robot, "selfCollide", "self_collide") if is_true(words)}
    off = {link for link, words in said(robot, "turnGravityOff") if is_true(words)}
    off |= {link for link, words in said(robot, "gravity") if words.lower() in ("false", "0")}
    frictions, retros = (numbers_of(said(robot, *tags), links, fault, warnings) for fault, tags in
                         (("coefficient", ("mu1", "mu2")), ("intensity", ("laserRetro", "laser_retro"))))
    for link, value in frictions.items():
        if value > MOST_FRICTION:
            warnings.append(told("friction", "link '%s': friction" % link, "%g" % value))
            frictions[link] = MOST_FRICTION
    return Description(
        urdf=ElementTree.tostring(robot, encoding="unicode"),
        fixed=fixed, bodies=tuple(bodies),
        control_namespace=control, cameras=cameras,
        collides=robot.find("link/collision") is not None,
        weightless=bool(heavy) and heavy <= off, lifted=frozenset() if heavy <= off else frozenset(off & heavy),
        joint_types={joint.get("name"): MOVING[joint.get("type")] for joint in robot.findall("joint")
                     if joint.get("type") in MOVING},
        actuated=actuated, parents=parents, children=children, devices=tuple(devices), frictions=frictions,
        retros=retros, self_collides=frozenset(links if None in self_collides else self_collides),
        warnings=tuple(warnings))


def said(robot: ElementTree.Element, *tags: str) -> typing.Iterator[typing.Tuple[typing.Optional[str], str]]:
    """Takes these tags out of every <gazebo>, since the simulator would warn of them, and yields the link, or None, and
    the text of each."""
    for gazebo in robot.findall("gazebo"):
        for tag in tags:
            for element in gazebo.findall(tag):
                gazebo.remove(element)
                yield gazebo.get("reference"), (element.text or "").strip() or element.get("value", "")


def is_true(words: str) -> bool:
    return words.lower() in TRUE


def numbers_of(entries: typing.Iterable[typing.Tuple[typing.Optional[str], str]], links: typing.Set[str], fault: str,
               warnings: typing.List[str]) -> typing.Dict[str, float]:
    """Returns dict of link -> its first number >= 0. Args: fault: key of FAULTS for the warning about other values."""
    found = {}
    for link, words in entries:
        try:
            value = float(words)
        except ValueError:
            value = -1.0
        if link in links and value >= 0.0:
            found.setdefault(link, value)
        elif link in links:
            warnings.append(told(fault, "link '%s'" % link, "'%s'" % words))
    return found


def ends_of(robot: ElementTree.Element, end: str) -> typing.Dict[str, str]:
    """dict of joint -> link at one of its ends, "parent" or "child"."""
    return {joint.get("name"): joint.find(end).get("link") for joint in robot.findall("joint")
            if joint.find(end) is not None}


def free_followers(robot: ElementTree.Element, warnings: typing.List[str]) -> None:
    """Takes <mimic> out of joints that have a <transmission>: Gazebo drives them like others."""
    driven = {end.get("name") for end in robot.findall("transmission/joint")}
    for joint in robot.findall("joint"):
        mimic = joint.find("mimic")
        if mimic is not None and joint.get("name") in driven:
            joint.remove(mimic)
            warnings.append("<mimic> of joint '%s': it has a <transmission> and moves by itself, as in Gazebo: ignored"
                            % joint.get("name"))


def sensors_of(robot: ElementTree.Element, namespace: str, model: str,
               warnings: typing.List[str]) -> typing.List[Device]:
    """Devices of the <sensor> tags that are no cameras; these tags are taken out."""
    devices = []
    for gazebo in robot.findall("gazebo"):
        for sensor in [each for each in gazebo.findall("sensor") if "camera" not in each.get("type", "")]:
            gazebo.remove(sensor)
            for plugin in sensor.findall("plugin"):
                told_before = len(warnings)
                device = read_device(robot, plugin, sensor, gazebo.get("reference", ""),
                                     namespace_of(plugin, namespace, model), warnings)
                if device is not None:
                    devices.append(device)
                elif len(warnings) == told_before:
                    warnings.append(not_simulated(sensor, plugin))
    return devices


def not_simulated(sensor: ElementTree.Element, plugin: ElementTree.Element) -> str:
    """The line about a plugin of a sensor that does nothing here."""
    return "sensor '%s' of type %s: plugin %s is not simulated: ignored" % (
        sensor.get("name"), sensor.get("type"), file_of(plugin) or "without a file")


def drop_strangers(robot: ElementTree.Element) -> typing.List[str]:
    """Removes references to missing links and joints, as Gazebo does. Returns a line for each."""
    known = {each.get("name") for each in robot if each.tag in ("link", "joint")}
    warnings = []
    for gazebo in robot.findall("gazebo"):
        reference = gazebo.get("reference")
        if reference is None or reference in known:
            continue
        robot.remove(gazebo)
        warnings.append("<gazebo reference='%s'>: there is no such link or joint: ignored" % reference)
    joints = {joint.get("name") for joint in robot.findall("joint")}
    for transmission in robot.findall("transmission"):
        strangers = [end.get("name", "") for end in transmission.findall("joint") if end.get("name", "") not in joints]
        if strangers:
            robot.remove(transmission)
            warnings.append("<transmission name='%s'>: there is no joint '%s': ignored" %
                            (transmission.get("name"), "', '".join(strangers)))
    return warnings


def cameras_of(robot: ElementTree.Element, namespace: str, model: str,
               warnings: typing.List[str]) -> typing.Dict[str, CameraTopics]:
    """dict of camera -> CameraTopics. Cameras without a plugin have no topics and are taken out."""
    done = []  # sensors that see depth
    cameras = read_kinects(robot, namespace, model, done, warnings)
    for plugin in filter(is_realsense, robot.findall("gazebo/plugin")):
        cameras.update(read_realsense(robot, plugin, done, warnings))
    for gazebo in robot.findall("gazebo"):
        for sensor in list(gazebo.findall("sensor")):
            plugins = sensor.findall("plugin")
            if "camera" not in sensor.get("type", "") or any(sensor is each for each in done):
                continue
            plugin = next((each for each in plugins if CAMERA in each.get("filename", "")), None)
            if plugin is None or sensor.get("type") == "multicamera":
                gazebo.remove(sensor)
                warnings += [not_simulated(sensor, each) for each in plugins] or [
                    "camera '%s' has no plugin that publishes it: ignored" % sensor.get("name")]
                continue
            for each in plugins:
                if each is not plugin:
                    sensor.remove(each)
                    warnings.append(not_simulated(sensor, each))
            place = place_of(plugin, namespace, model)
            cameras[own_name(sensor, plugin, cameras, warnings)] = CameraTopics(
                image=named(place, text(plugin, "imageTopicName", "image_raw")),
                info=named(place, text(plugin, "cameraInfoTopicName", "camera_info")),
                trigger=named(place, text(plugin, "triggerTopicName", "image_trigger")))
    return cameras
