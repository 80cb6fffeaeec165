"""Plugins of cameras that see depth, read with their keys and defaults: that of Intel's RealSense, which looks for
four sensors of its model by their names, and those of a Kinect, which stand in a sensor of type depth.

Their messages follow gazebo_ros_realsense.cpp of pal-robotics/realsense_gazebo_plugin, and from
gazebo_ros_openni_kinect.cpp and gazebo_ros_depth_camera.cpp of ros-simulation/gazebo_ros_pkgs.
"""
import dataclasses
import itertools
import math
import typing
import xml.etree.ElementTree as ElementTree

import numpy

from ..faults import told
from .devices import flag, joined, named, namespace_of, number, text

REALSENSE = "librealsense_gazebo_plugin.so"
KINECT = "libgazebo_ros_openni_kinect.so", "libgazebo_ros_depth_camera.so"
CAMERA = "libgazebo_ros_camera.so"
DEPTH = "depth"
#: Sensors of a RealSense by the end of their name: the keys of their topic and of their optical frame.
EYES = {"color": ("colorTopicName", "colorOpticalframeName"),
        "ired1": ("infrared1TopicName", "infrared1OpticalframeName"),
        "ired2": ("infrared2TopicName", "infrared2OpticalframeName"),
        DEPTH: ("depthTopicName", "depthOpticalframeName")}
#: Keys of a Kinect's plugin that are not those of a camera's.
KINECT_KEYS = ("depthImageTopicName", "depthImageCameraInfoTopicName", "pointCloudTopicName", "pointCloudCutoff",
               "pointCloudCutoffMax", "reflectanceImageTopicName", "reflectanceTopicName", "normalsTopicName",
               "clipping", "useDepth16UC1Format")


@dataclasses.dataclass(frozen=True)
class Depth:
    """Topics of a camera's depth. Topics are full names.

    Attributes:
        image, info, points: topics; points is "" for none.
        millimetres: values are uint16 [mm], 0 where nothing is in range; else float32 [m], NaN there.
        range_m: nearest and farthest depth of the image.  points_m: the same of the points.
        colors: name of the camera whose image gives the points their colours.
    """
    image: str
    info: str
    points: str
    millimetres: bool
    range_m: tuple
    points_m: tuple
    colors: str

    def values(self, depth_m: numpy.ndarray) -> numpy.ndarray:
        """The pixels to send of a depth image, (h, w) float32 [m] with NaN where there is nothing."""
        near, far = self.range_m
        inside = (depth_m >= near) & (depth_m <= far)  # NaN is not
        if self.millimetres:
            inside &= depth_m <= 0.001 * numpy.iinfo(numpy.uint16).max
            return numpy.where(inside, depth_m.astype(numpy.float64) / 0.001, 0.0).astype(numpy.uint16)
        return depth_m if inside.all() else numpy.where(inside, depth_m, numpy.float32(numpy.nan))

    def cloud(self, depth_m: numpy.ndarray, K: typing.Sequence[float], colors: numpy.ndarray) -> numpy.ndarray:
        """Points (h, w, 4) float32 in the optical frame: x, y, z [m], NaN where nothing is in range, and the colour as
        the bits 0x00rrggbb.

        Args: depth_m: (h, w).  K: (9,) of the camera_info.  colors: (h, w) or (h, w, 3) uint8; others: black.
        """
        height, width = depth_m.shape
        near, far = self.points_m
        z = numpy.where((depth_m > near) & (depth_m < far), depth_m, numpy.float32(numpy.nan))
        # As the plugins do it: about the middle of the image, whatever the camera_info says.
        u, v = numpy.arange(width) - 0.5 * (width - 1), numpy.arange(height) - 0.5 * (height - 1)
        points = numpy.zeros((height, width, 4), dtype=numpy.float32)
        points[..., 0], points[..., 1], points[..., 2] = z * u / K[0], z * v[:, None] / K[0], z
        if colors.shape[:2] == depth_m.shape and colors.dtype == numpy.uint8:
            rgb = numpy.repeat(colors[..., None], 3, axis=2) if colors.ndim == 2 else colors
            bits = rgb.astype(numpy.uint32)
            points[..., 3] = (bits[..., 0] << 16 | bits[..., 1] << 8 | bits[..., 2]).view(numpy.float32)
        return points


@dataclasses.dataclass(frozen=True)
class CameraTopics:
    """Topics of one camera, full names. image and info are "" of a camera that only sees depth."""
    image: str
    info: str
    trigger: str
    depth: typing.Optional[Depth] = None  #: of a camera that sees it


def told_number(plugin: ElementTree.Element, key: str, otherwise: float, warnings: typing.List[str]) -> float:
    """The number of a key; the default, with a warning, where it is none."""
    try:
        return number(plugin, key, otherwise)
    except ValueError as error:
        warnings.append(told("key", "plugin '%s'" % plugin.get("name", ""), error, "%g" % otherwise))
        return otherwise


def sibling(topic: str, name: str) -> str:
    """Another topic beside one, as image_transport places camera_info beside an image."""
    return topic.rpartition("/")[0] + "/" + name


def is_realsense(plugin: ElementTree.Element) -> bool:
    return plugin.get("filename", "").rpartition("/")[2] == REALSENSE


def read_realsense(robot: ElementTree.Element, plugin: ElementTree.Element, done: typing.List[ElementTree.Element],
                   warnings: typing.List[str]) -> typing.Dict[str, CameraTopics]:
    """The cameras of a RealSense. Their sensors become such as the simulator reads.

    Args:
        robot: element of the URDF.  plugin: the element.  done: gets the sensors.
        warnings: gets a line for each sensor that is not there.
    Returns: dict of the name of the camera -> CameraTopics.
    """
    place, prefix = plugin.get("name", ""), text(plugin, "prefix")
    sensors = {sensor.get("name"): sensor for sensor in robot.findall("gazebo/sensor")}
    cameras = {}
    for end, (topic_key, frame_key) in EYES.items():
        sensor, name = sensors.get(prefix + end), prefix + end
        if sensor is None:
            warnings.append("plugin %s: there is no sensor '%s'" % (REALSENSE, name))
            continue
        image = named(place, text(plugin, topic_key, end + "/image_raw"))
        info, trigger = sibling(image, "camera_info"), sibling(image, "image_trigger")
        become_camera(sensor, text(plugin, frame_key))
        done.append(sensor)
        if end != DEPTH:
            cameras[name] = CameraTopics(image, info, trigger)
            continue
        points = named(place, text(plugin, "pointCloudTopicName", "points")) if flag(plugin, "pointCloud") else ""
        nearest, farthest, cloud_nearest, cloud_farthest = (
            told_number(plugin, *each, warnings) for each in (("rangeMinDepth", 0.0), ("rangeMaxDepth", 65.535),
                                                              ("pointCloudCutoff", 0.0), ("pointCloudCutoffMax", 5.0)))
        cameras[name] = CameraTopics("", "", trigger, Depth(
            image, info, points, True, (nearest, farthest), (cloud_nearest, cloud_farthest),
            colors=prefix + "color" if prefix + "color" in cameras else name))
    return cameras


def become_camera(sensor: ElementTree.Element, frame: str) -> None:
    """A sensor of a RealSense as the simulator reads cameras; its camera_info is that of the plugin: the middle of the
    image is half its width and height."""
    sensor.set("type", "camera")
    camera = sensor.find("camera")
    image = None if camera is None else camera.find("image")
    plugin = ElementTree.SubElement(sensor, "plugin", {"name": sensor.get("name"), "filename": CAMERA})
    keys = {"cameraName": sensor.get("name"), "frameName": frame}
    if image is not None:
        keys.update(Cx=str(0.5 * float(text(image, "width", "0"))), Cy=str(0.5 * float(text(image, "height", "0"))))
    for key, value in keys.items():
        ElementTree.SubElement(plugin, key).text = value


def place_of(plugin: ElementTree.Element, namespace: str, model: str) -> str:
    """Where the topics of a camera's plugin are, unless they begin with /: NodeHandle(robotNamespace + "/" +
    cameraName) of GazeboRosCameraUtils::LoadThread."""
    return joined(namespace_of(plugin, namespace, model), text(plugin, "cameraName"))


def own_name(sensor: ElementTree.Element, plugin: ElementTree.Element, known: typing.Dict[str, CameraTopics],
             warnings: typing.List[str]) -> str:
    """The name of a camera, which no other of the robot has: its plugin is given it.

    Args: known: names that are taken.  warnings: gets a line where cameraName is one of them.
    """
    wanted = text(plugin, "cameraName").strip("/") or sensor.get("name", "")
    names = itertools.chain((wanted,), ("%s_%d" % (wanted, k) for k in itertools.count(2)))
    name = next(each for each in names if each not in known)
    if name != wanted:
        warnings.append(told("twice", "sensor '%s'" % sensor.get("name"), "the cameraName '%s' of another" % wanted))
    said = plugin.find("cameraName")
    (ElementTree.SubElement(plugin, "cameraName") if said is None else said).text = name
    return name


def read_kinects(robot: ElementTree.Element, namespace: str, model: str, done: typing.List[ElementTree.Element],
                 warnings: typing.List[str]) -> typing.Dict[str, CameraTopics]:
    """The cameras of the plugins of Kinects, whose sensors become such as the simulator reads.

    Returns: dict as `read_realsense`.
    """
    cameras = {}
    for sensor in robot.findall("gazebo/sensor"):
        for plugin in sensor.findall("plugin"):
            if plugin.get("filename", "").rpartition("/")[2] not in KINECT:
                continue
            place = place_of(plugin, namespace, model)
            name = own_name(sensor, plugin, cameras, warnings)
            nearest, farthest = (told_number(plugin, key, otherwise, warnings) for key, otherwise in
                                 (("pointCloudCutoff", 0.4), ("pointCloudCutoffMax", 5.0)))
            if plugin.get("filename", "").endswith(KINECT[1]):  # has no farthest depth
                farthest = math.inf
            short = flag(plugin, "useDepth16UC1Format")
            depth = Depth(image=named(place, text(plugin, "depthImageTopicName", "depth/image_raw")),
                          info=named(place, text(plugin, "depthImageCameraInfoTopicName", "depth/camera_info")),
                          points=named(place, text(plugin, "pointCloudTopicName", "points")), millimetres=short,
                          range_m=(nearest, farthest), points_m=(nearest, farthest), colors=name)
            info = named(place, text(plugin, "cameraInfoTopicName", "camera_info"))
            cameras[name] = CameraTopics(named(place, text(plugin, "imageTopicName", "image_raw")), info,
                                         sibling(info, "image_trigger"), depth)
            sensor.set("type", "camera")
            done.append(sensor)
            plugin.set("filename", CAMERA)
            for key in KINECT_KEYS:
                for element in plugin.findall(key):
                    plugin.remove(element)
    return cameras
