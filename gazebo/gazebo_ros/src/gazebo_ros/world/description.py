"""What a URDF says to Gazebo besides what it says to everybody: namespaces of plugins, whether the model is free."""
import dataclasses
import re
import xml.etree.ElementTree as ElementTree

from .errors import SpawnError

#: Plugins that are part of the simulator, by a piece of their file name.
CONTROL, CAMERA = "gazebo_ros_control", "camera"
#: Plugins whose work is done without them.
NAMED = re.compile(r"(['\">]\s*)(?:package|model)://([^/'\"<]+)")
NEEDLESS = ("mimic_joint",)
MOVING = {"revolute": 0, "continuous": 1, "prismatic": 2}


@dataclasses.dataclass(frozen=True)
class CameraTopics:
    """Topics of one camera, full names."""
    image: str
    info: str
    trigger: str


@dataclasses.dataclass(frozen=True)
class Description:
    """A model as it is to be simulated."""
    urdf: str               #: what the simulator reads
    fixed: bool             #: held in the world, else free
    control_namespace: str  #: where its controller manager is, "" for none
    cameras: dict           #: name of the camera -> CameraTopics
    collides: bool          #: some link has a shape to collide with
    actuated: tuple         #: joints with a <transmission>, sorted: what hardware_interface knows
    joint_types: dict       #: of the joints that move, as gazebo_msgs/GetJointProperties numbers them
    weightless: bool        #: every link that has a mass says that gravity does not act on it
    jointed: bool           #: some joint moves
    warnings: tuple         #: what is ignored, a line each


def joined(*parts):
    """A full name of its parts, each with or without slashes: joined("/a/", "b") is "/a/b", of nothing "/"."""
    return "/" + "/".join(part.strip("/") for part in parts if part.strip("/"))


def text_of(element, key, otherwise=""):
    child = element.find(key)
    return child.text.strip() if child is not None and child.text else otherwise


def located(xml, find_folder):
    """A description whose package:// and model:// names are files.

    Args:
        find_folder: function of the name of a package or model, returns its folder or None; such names stay.
    """
    def path(match):
        folder = find_folder(match[2])
        return match[0] if folder is None else match[1] + "file://" + folder
    return NAMED.sub(path, xml)


def read_description(xml, namespace, model):
    """
    Args:
        xml: a URDF document.
        namespace: of plugins that name none of their own; "" for none.
        model: name of the model, the namespace of a controller plugin that has none at all.
    Returns:
        Description
    Raises:
        SpawnError: no URDF.
    """
    try:
        robot = ElementTree.fromstring(xml)
    except ElementTree.ParseError as error:
        raise SpawnError("SpawnModel: Failure - entity format is invalid: %s" % error) from error
    if robot.tag != "robot":
        raise SpawnError("SpawnModel: Failure - entity format is invalid: found <%s>, allowed is <robot>" % robot.tag)
    warnings = drop_strangers(robot)
    control = ""
    for gazebo, plugin in [(each, plugin) for each in robot.findall("gazebo") for plugin in each.findall("plugin")]:
        gazebo.remove(plugin)  # the simulator would warn of what is used here
        file = plugin.get("filename", "")
        if CONTROL in file:
            control = joined(text_of(plugin, "robotNamespace", namespace or model))
        elif not any(piece in file for piece in NEEDLESS):
            warnings.append("plugin %s of model '%s' is not simulated: ignored" % (file, model))
    links = {link.get("name") for link in robot.findall("link")}
    children = {joint.find("child").get("link") for joint in robot.findall("joint") if joint.find("child") is not None}
    return Description(
        urdf=ElementTree.tostring(robot, encoding="unicode"),
        fixed=links - children == {"world"} or any(text_of(each, "static") in ("true", "1")
                                                   for each in robot.findall("gazebo")),
        control_namespace=control, cameras=cameras_of(robot, namespace, warnings),
        collides=robot.find("link/collision") is not None, weightless=weightless(robot),
        joint_types={joint.get("name"): MOVING[joint.get("type")] for joint in robot.findall("joint")
                     if joint.get("type") in MOVING},
        actuated=tuple(sorted({end.get("name") for end in robot.findall("transmission/joint")})),
        jointed=any(joint.get("type") in MOVING for joint in robot.findall("joint")), warnings=tuple(warnings))


def weightless(robot):
    """Whether gravity acts on no link."""
    off = {gazebo.get("reference") for gazebo in robot.findall("gazebo")
           if text_of(gazebo, "turnGravityOff").lower() in ("true", "1")
           or text_of(gazebo, "gravity").lower() in ("false", "0")}
    heavy = {link.get("name") for link in robot.findall("link") if link.find("inertial") is not None}
    return bool(heavy) and heavy <= off


def drop_strangers(robot):
    """Takes out what refers to links and joints that are not there, as Gazebo does. Returns a line for each."""
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
        strangers = [end.get("name") for end in transmission.findall("joint") if end.get("name") not in joints]
        if strangers:
            robot.remove(transmission)
            warnings.append("<transmission name='%s'>: there is no joint '%s': ignored" %
                            (transmission.get("name"), "', '".join(strangers)))
    return warnings


def cameras_of(robot, namespace, warnings):
    """dict of camera -> CameraTopics. Cameras without a plugin have no topics and are taken out."""
    cameras = {}
    for gazebo in robot.findall("gazebo"):
        for sensor in list(gazebo.findall("sensor")):
            if "camera" not in sensor.get("type", ""):
                continue
            plugin = sensor.find("plugin")
            if plugin is None or CAMERA not in plugin.get("filename", ""):
                gazebo.remove(sensor)
                warnings.append("camera '%s' has no plugin that publishes it: ignored" % sensor.get("name"))
                continue
            name = text_of(plugin, "cameraName", sensor.get("name", "")).lstrip("/")
            place = joined(text_of(plugin, "robotNamespace", namespace), name)
            cameras[name] = CameraTopics(image=joined(place, text_of(plugin, "imageTopicName", "image_raw")),
                                         info=joined(place, text_of(plugin, "cameraInfoTopicName", "camera_info")),
                                         trigger=joined(place, text_of(plugin, "triggerTopicName", "image_trigger")))
    return cameras
