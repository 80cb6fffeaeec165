"""Sensors of several cameras and cameras of other plugins, as single cameras of the plugin that the simulator reads.

libgazebo_ros_multicamera.so publishes the camera whose name has `left` in it under CAMERA_NAME/left, and the one
with `right` under CAMERA_NAME/right, which alone has hackBaseline in its P (gazebo_ros_multicamera.cpp). Both have one
frame.
"""
import copy
import typing
import xml.etree.ElementTree as ElementTree

from ..sdf.document import pose_of
from .depth_cameras import CAMERA
from .devices import file_of, text
from .poses import rpy_of

MULTICAMERA, PROSILICA = "libgazebo_ros_multicamera.so", "libgazebo_ros_prosilica.so"
SIDES = ("left", "right")


def split_multicameras(robot: ElementTree.Element, warnings: typing.List[str]) -> None:
    """Puts single cameras in the place of the sensors of several ones that have a plugin. Args: robot: element of the
    URDF.  warnings: gets a line for each sensor without the plugin, which is taken out. Raises: ModelError."""
    for gazebo in robot.findall("gazebo"):
        for sensor in [each for each in gazebo.findall("sensor") if each.get("type") == "multicamera"]:
            gazebo.remove(sensor)
            plugin = next((each for each in sensor.findall("plugin") if file_of(each) == MULTICAMERA), None)
            if plugin is None:
                files = ", ".join(file_of(each) for each in sensor.findall("plugin")) or "none"
                warnings.append("sensor '%s' of type multicamera needs the plugin %s, found %s: ignored" %
                                (sensor.get("name"), MULTICAMERA, files))
                continue
            gazebo.extend(single(sensor, camera, plugin) for camera in sensor.findall("camera"))


def single(sensor: ElementTree.Element, camera: ElementTree.Element,
           plugin: ElementTree.Element) -> ElementTree.Element:
    """Returns a <sensor> of type camera of one of the cameras of a sensor."""
    name = camera.get("name", "")
    side = next((each for each in SIDES if each in name), name)
    made = ElementTree.Element("sensor", name="%s_%s" % (sensor.get("name", "multicamera"), name), type="camera")
    for child in sensor:
        if child.tag not in ("camera", "plugin", "pose"):
            made.append(copy.deepcopy(child))
    pose = pose_of(sensor, "sensor") @ pose_of(camera, "camera")
    ElementTree.SubElement(made, "pose").text = " ".join(repr(float(each)) for each in (*pose[:3, 3], *rpy_of(pose)))
    lens = copy.deepcopy(camera)
    for old in lens.findall("pose"):
        lens.remove(old)
    made.append(lens)
    own = copy.deepcopy(plugin)
    own.set("filename", CAMERA)
    place = "%s/%s" % (text(plugin, "cameraName").strip("/"), side)
    baseline = text(plugin, "hackBaseline", "0") if side == "right" else "0"
    for key, value in (("cameraName", place), ("hackBaseline", baseline)):
        for old in own.findall(key):
            own.remove(old)
        ElementTree.SubElement(own, key).text = value
    made.append(own)
    return made


def take_prosilicas(robot: ElementTree.Element, warnings: typing.List[str]) -> None:
    """Lets cameras of the Prosilica's plugin be such of the common one: images come at the sensor's rate, and nobody
    answers polled_camera/GetPolledImage."""
    for plugin in robot.findall("gazebo/sensor/plugin"):
        if file_of(plugin) == PROSILICA:
            plugin.set("filename", CAMERA)
            for old in plugin.findall("pollServiceName"):
                plugin.remove(old)
            warnings.append("plugin %s: images are sent at the rate of the sensor, its service for single images is "
                            "not there" % PROSILICA)
