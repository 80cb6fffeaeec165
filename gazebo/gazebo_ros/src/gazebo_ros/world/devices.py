"""Plugins of a URDF other than cameras and ros_control, with Gazebo's keys and defaults: one class per kind."""
import dataclasses
import math
import typing
import xml.etree.ElementTree as ElementTree

import numpy

from aras_visual_servo_sim import ModelError

from ..faults import told
from ..sdf.document import pose_of

TRUE = ("true", "1")  #: how a tag says yes, in lower case

#: Reads a plugin of a model: plugin, sensor, link, namespace; and one of a world.
Reader = typing.Callable[[ElementTree.Element, typing.Optional[ElementTree.Element], str, str], "Device"]
WorldReader = typing.Callable[[ElementTree.Element], "Device"]
_READERS: typing.Dict[str, Reader] = {}
_OF_WORLD: typing.Dict[str, WorldReader] = {}


def reads(*files: str) -> typing.Callable[[Reader], Reader]:
    """Decorator: this function reads plugins of these file names: f(plugin, sensor, link, namespace)."""
    def note(reader: Reader) -> Reader:
        _READERS.update((file, reader) for file in files)
        return reader
    return note


def reads_of_world(*files: str) -> typing.Callable[[WorldReader], WorldReader]:
    """Decorator: this function reads plugins of a world of these file names: f(plugin) -> Device."""
    def note(reader: WorldReader) -> WorldReader:
        _OF_WORLD.update((file, reader) for file in files)
        return reader
    return note


def file_of(plugin: ElementTree.Element) -> str:
    """Name of a plugin's file, without folders."""
    return plugin.get("filename", "").rpartition("/")[2]


def is_read(file: str) -> bool:
    """Whether a plugin of this file name is a device of a model or a world."""
    return file in _READERS or file in _OF_WORLD


def read_world_device(plugin: ElementTree.Element) -> typing.Optional["Device"]:
    """Returns the Device of a plugin of a world, or None: it is not simulated. Raises: ValueError."""
    reader = _OF_WORLD.get(file_of(plugin))
    return None if reader is None else reader(plugin)


def read_device(robot: ElementTree.Element, plugin: ElementTree.Element, sensor: typing.Optional[ElementTree.Element],
                link: str, namespace: str, warnings: typing.List[str]) -> typing.Optional["Device"]:
    """
    Args:
        robot: element of the URDF.  plugin: its element.  sensor: element that it stands in, None for none.
        link: that the element refers to.  namespace: full name, of the device's topics.
        warnings: gets a line when a device is not made.
    Returns: A device, or None: no plugin of this kind, or one that names joints or links that are not there.
    """
    reader = _READERS.get(file_of(plugin))
    if reader is None:
        return None
    what, device = "plugin '%s' (%s)" % (plugin.get("name", ""), plugin.get("filename")), None
    while device is None:
        try:
            device = reader(plugin, sensor, link, namespace)
        except NoNumberError as error:
            error.drop()
            warnings.append(told("key", what, error))
        except (ValueError, ModelError) as error:
            warnings.append(told("plugin", what, error))
            return None
    for tag, names in (("joint", device.joints()), ("link", device.links())):
        known = {each.get("name") for each in robot.findall(tag)}
        strangers = [name for name in names if name not in known]
        if strangers:
            warnings.append("plugin %s: there is no %s '%s'" % (plugin.get("filename"), tag, "', '".join(strangers)))
            return None
    return device


class Device:
    """Base class of simulated plugins."""

    rate_hz: float     #: how often it acts or is published; 0: as often as possible
    torque_n_m: float  #: of its motors, where it has any

    def joints(self) -> typing.Tuple[str, ...]:
        """Names of the joints that must be there."""
        return ()

    def links(self) -> typing.Tuple[str, ...]:
        return ()

    def motors(self) -> typing.Tuple[str, ...]:
        """Names of the joints that it turns with motors of its torque_n_m."""
        return ()


@dataclasses.dataclass(frozen=True)
class DiffDrive(Device):
    """Two wheels, driven by a twist. Lengths in m, torque in N m."""
    namespace: str
    left: str
    right: str
    separation_m: float
    diameter_m: float
    torque_n_m: float
    acceleration_m_s2: float  #: 0: none is too high
    rate_hz: float
    command_topic: str
    odometry_topic: str
    odometry_frame: str
    base_frame: str
    from_wheels: bool         #: odometry adds up the wheels' turns, else it is the true pose
    publishes_odometry: bool
    publishes_tf: bool
    publishes_wheel_tf: bool
    publishes_joint_states: bool

    def joints(self) -> typing.Tuple[str, ...]:
        return self.left, self.right

    def motors(self) -> typing.Tuple[str, ...]:
        return self.joints()


@dataclasses.dataclass(frozen=True)
class Imu(Device):
    """Orientation, angular velocity and specific force of a link."""
    link: str
    topic: str
    frame: str
    rate_hz: float
    noise: float        #: standard deviation of the measurement [rad/s, m/s^2]
    service: str = ""   #: which says that it is calibrated, "" for none

    def links(self) -> typing.Tuple[str, ...]:
        return (self.link,)


@dataclasses.dataclass(frozen=True)
class ForceTorque(Device):
    """Wrench that the child link of a joint exerts on its parent."""
    joint: str
    topic: str
    rate_hz: float
    noise: float

    def joints(self) -> typing.Tuple[str, ...]:
        return (self.joint,)


@dataclasses.dataclass(frozen=True)
class Scan:
    """Angles of the rays of a laser about one axis [rad]: `samples` rays, of which `count` numbers are made."""
    samples: int
    count: int
    lowest: float
    highest: float

    def angles(self) -> numpy.ndarray:
        """Of the rays, (samples,); a single one looks ahead."""
        return numpy.zeros(1) if self.samples == 1 else numpy.linspace(self.lowest, self.highest, self.samples)


@dataclasses.dataclass(frozen=True)
class Laser(Device):
    """Distances along rays from a link, which begin at range_min_m."""
    link: str
    topic: str
    frame: str
    rate_hz: float
    horizontal: Scan
    vertical: Scan
    range_min_m: float
    range_max_m: float
    noise_mean: float   #: [m]
    noise: float        #: standard deviation [m]
    X_LS: numpy.ndarray  #: (4, 4), the sensor in the link: rays at angle 0 go along x, angles grow towards y and z
    sees_visuals: bool  #: the rays meet <visual>s from outside, else <collision>s

    def links(self) -> typing.Tuple[str, ...]:
        return (self.link,)


def joined(*parts: str) -> str:
    """A full name of its parts, each with or without slashes: joined("/a/", "b") is "/a/b", of nothing "/"."""
    return "/" + "/".join(part.strip("/") for part in parts if part.strip("/"))


#: Plugins that are in a namespace of their model's name where <robotNamespace> is missing, or is there and empty.
#: The rest, as read in gazebo_plugins of gazebo_ros_pkgs, has none then: topics begin at the root.
MODEL_WHERE_MISSING = ("libgazebo_ros_diff_drive.so", "libgazebo_ros_tricycle_drive.so",
                       "libgazebo_ros_joint_state_publisher.so", "libgazebo_ros_imu_sensor.so")
MODEL_WHERE_EMPTY = (*MODEL_WHERE_MISSING[:3], "libgazebo_ros_camera.so", "libgazebo_ros_triggered_camera.so",
                     "libgazebo_ros_openni_kinect.so", "libgazebo_ros_depth_camera.so", "libgazebo_ros_multicamera.so",
                     "libgazebo_ros_laser.so", "libgazebo_ros_gpu_laser.so", "libgazebo_ros_prosilica.so")


def namespace_of(plugin: ElementTree.Element, namespace: str, model: str) -> str:
    """Full name of the namespace of a plugin's topics, "/" for none.

    Args: namespace: that spawn_urdf_model and spawn_sdf_model give plugins without <robotNamespace>, "" for none.
    """
    file, said = file_of(plugin), plugin.find("robotNamespace")
    if said is None:
        return joined(namespace or (model if file in MODEL_WHERE_MISSING else ""))
    return joined((said.text or "").strip() or (model if file in MODEL_WHERE_EMPTY else ""))


def text(element: typing.Optional[ElementTree.Element], key: str, otherwise: str = "") -> str:
    child = None if element is None else element.find(key)
    return child.text.strip() if child is not None and child.text and child.text.strip() else otherwise


class NoNumberError(ValueError):
    """A tag whose text is no finite number."""

    def __init__(self, element: typing.Optional[ElementTree.Element], key: str, found: str) -> None:
        super().__init__("<%s> '%s', allowed is a finite number" % (key, found))
        self._element, self._key = element, key

    def drop(self) -> None:
        """Takes the tag out, so that it gets its default."""
        for child in self._element.findall(self._key):
            self._element.remove(child)


def number(element: typing.Optional[ElementTree.Element], key: str, otherwise: float) -> float:
    """The number of a tag. Raises: NoNumberError."""
    found = text(element, key, str(otherwise))
    try:
        value = float(found.split()[0])
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise NoNumberError(element, key, found)
    return value


def flag(element: typing.Optional[ElementTree.Element], key: str, otherwise: bool = False) -> bool:
    return text(element, key, str(otherwise)).lower() in TRUE


def named(namespace: str, topic: str) -> str:
    """Full name of a topic as ros::NodeHandle(namespace) resolves it: one that begins with / stays."""
    return joined(*(topic if topic.startswith("/") else namespace + "/" + topic).split("/"))


@reads("libgazebo_ros_diff_drive.so")
def diff_drive(plugin: ElementTree.Element, _sensor: typing.Optional[ElementTree.Element], _link: str,
               namespace: str) -> DiffDrive:
    return DiffDrive(
        namespace=namespace, left=text(plugin, "leftJoint", "left_joint"),
        right=text(plugin, "rightJoint", "right_joint"), separation_m=number(plugin, "wheelSeparation", 0.34),
        diameter_m=number(plugin, "wheelDiameter", 0.15), torque_n_m=number(plugin, "wheelTorque", 5.0),
        acceleration_m_s2=number(plugin, "wheelAcceleration", 0.0), rate_hz=number(plugin, "updateRate", 100.0),
        command_topic=text(plugin, "commandTopic", "cmd_vel"), odometry_topic=text(plugin, "odometryTopic", "odom"),
        odometry_frame=text(plugin, "odometryFrame", "odom"),
        base_frame=text(plugin, "robotBaseFrame", "base_footprint"),
        from_wheels=text(plugin, "odometrySource", "world") in ("encoder", "0"),
        publishes_odometry=flag(plugin, "publishTf", True), publishes_tf=flag(plugin, "publishOdomTF", True),
        publishes_wheel_tf=flag(plugin, "publishWheelTF", False),
        publishes_joint_states=flag(plugin, "publishWheelJointState", False))


@reads("libgazebo_ros_imu.so", "libhector_gazebo_ros_imu.so")
def imu(plugin: ElementTree.Element, _sensor: typing.Optional[ElementTree.Element], _link: str, namespace: str) -> Imu:
    link = text(plugin, "bodyName")
    return Imu(link=link, topic=named(namespace, text(plugin, "topicName", "/default_imu")),
               frame=text(plugin, "frameName", text(plugin, "frameId", link)),
               rate_hz=number(plugin, "updateRate", 0.0), noise=number(plugin, "gaussianNoise", 0.0),
               service=named(namespace, text(plugin, "serviceName", "/default_imu")))


@reads("libgazebo_ros_imu_sensor.so")
def imu_sensor(plugin: ElementTree.Element, sensor: typing.Optional[ElementTree.Element], link: str,
               namespace: str) -> Imu:
    return Imu(link=link, topic=named(namespace, text(plugin, "topicName", "imu_data")),
               frame=text(plugin, "frameName", link),
               rate_hz=number(plugin, "updateRateHZ", number(sensor, "update_rate", 1.0)),
               noise=number(plugin, "gaussianNoise", 0.0))


@reads("libgazebo_ros_ft_sensor.so")
def force_torque(plugin: ElementTree.Element, _sensor: typing.Optional[ElementTree.Element], _link: str,
                 namespace: str) -> ForceTorque:
    return ForceTorque(joint=text(plugin, "jointName"), topic=named(namespace, text(plugin, "topicName", "ft_sensor")),
                       rate_hz=number(plugin, "updateRate", 0.0), noise=number(plugin, "gaussianNoise", 0.0))


MOST_RAYS = 200000  #: of one laser


def scan_of(element: ElementTree.Element, key: str, required: bool) -> Scan:
    """Scan of <horizontal> or <vertical>. Raises: ValueError."""
    part = element.find("scan/" + key)
    if part is None and not required:
        return Scan(1, 1, 0.0, 0.0)
    samples = number(part, "samples", 640 if required else 1)
    resolution = number(part, "resolution", 1.0)
    lowest, highest = number(part, "min_angle", 0.0), number(part, "max_angle", 0.0)
    if not (1 <= samples <= MOST_RAYS and 0 < resolution * samples <= MOST_RAYS):
        raise ValueError("<%s>: found %g samples with a resolution of %g, allowed are 1 to %d" %
                         (key, samples, resolution, MOST_RAYS))
    if not (math.isfinite(lowest) and math.isfinite(highest) and lowest <= highest):
        raise ValueError("<%s>: found angles from %g to %g rad, allowed is min_angle <= max_angle, finite" %
                         (key, lowest, highest))
    return Scan(int(samples), max(1, int(samples * resolution)), lowest, highest)


@reads("libgazebo_ros_laser.so", "libgazebo_ros_gpu_laser.so")
def laser(plugin: ElementTree.Element, sensor: typing.Optional[ElementTree.Element], link: str,
          namespace: str) -> Laser:
    rays = None if sensor is None else sensor.find("ray") if sensor.find("ray") is not None else sensor.find("lidar")
    if rays is None:
        raise ValueError("found no <ray> around it, allowed is <sensor type=\"ray\"> with one")
    nearest, farthest = number(rays.find("range"), "min", 0.0), number(rays.find("range"), "max", 0.0)
    horizontal, vertical = scan_of(rays, "horizontal", True), scan_of(rays, "vertical", False)
    if not 0.0 <= nearest < farthest:
        raise ValueError("<range>: found %g to %g m, allowed is 0 <= min < max" % (nearest, farthest))
    if max(horizontal.samples, horizontal.count) * max(vertical.samples, vertical.count) > MOST_RAYS:
        raise ValueError("<scan>: found %d times %d rays, allowed are %d" %
                         (horizontal.samples, vertical.samples, MOST_RAYS))
    noise = rays.find("noise")
    return Laser(
        link=link, topic=named(namespace, text(plugin, "topicName", "/world")),
        frame=text(plugin, "frameName", "/world").lstrip("/"), rate_hz=number(sensor, "update_rate", 0.0),
        horizontal=horizontal, vertical=vertical, range_min_m=nearest, range_max_m=farthest,
        noise_mean=number(noise, "mean", 0.0), noise=number(noise, "stddev", 0.0), X_LS=pose_of(sensor, "sensor"),
        sees_visuals=sensor.get("type") in ("gpu_ray", "gpu_lidar"))


def motorize(robot: ElementTree.Element, drive: Device) -> None:
    """Gives the wheels velocity motors of the drive's torque: a transmission and a limit in the URDF."""
    for name in drive.motors():
        for transmission in robot.findall("transmission"):
            if name in [end.get("name") for end in transmission.findall("joint")]:
                robot.remove(transmission)
        transmission = ElementTree.SubElement(robot, "transmission", name="%s_motor" % name)
        ElementTree.SubElement(transmission, "type").text = "transmission_interface/SimpleTransmission"
        end = ElementTree.SubElement(transmission, "joint", name=name)
        ElementTree.SubElement(end, "hardwareInterface").text = "hardware_interface/VelocityJointInterface"
        ElementTree.SubElement(transmission, "actuator", name="%s_motor" % name)
        joint = next(each for each in robot.findall("joint") if each.get("name") == name)
        limit = joint.find("limit")
        if limit is None:
            limit = ElementTree.SubElement(joint, "limit")
        limit.set("effort", str(drive.torque_n_m))
        limit.set("velocity", str(FASTEST_RAD_S))


FASTEST_RAD_S = 1000.0  #: of a wheel: no limit


def directions_of(horizontal: Scan, vertical: Scan) -> numpy.ndarray:
    """(n, 3) unit vectors of two Scans: x ahead, y to the left, z up; those of one height follow each other."""
    heights, turns = numpy.meshgrid(vertical.angles(), horizontal.angles(), indexing="ij")
    return numpy.stack((numpy.cos(heights) * numpy.cos(turns), numpy.cos(heights) * numpy.sin(turns),
                        numpy.sin(heights)), axis=-1).reshape(-1, 3)


def resampled(values: numpy.ndarray, horizontal: Scan, vertical: Scan) -> numpy.ndarray:
    """What is measured along the rays of two Scans, (n,), as as many numbers as these say, linearly between them."""
    rows = values.reshape(vertical.samples, horizontal.samples)
    if (vertical.count, horizontal.count) == rows.shape:
        return values
    for axis, count in ((0, vertical.count), (1, horizontal.count)):
        at = numpy.linspace(0.0, rows.shape[axis] - 1.0, count)
        below = numpy.minimum(at.astype(int), max(0, rows.shape[axis] - 2))
        above = numpy.minimum(below + 1, rows.shape[axis] - 1)
        share = (at - below).reshape((-1, 1) if axis == 0 else (1, -1))
        rows = (1.0 - share) * rows.take(below, axis) + share * rows.take(above, axis)
    return rows.reshape(-1)
