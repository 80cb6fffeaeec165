"""Camera sensors of a URDF in SDF's form: missing and invalid values get SDF's defaults."""
import math
import typing
import xml.etree.ElementTree as ElementTree

from ..faults import told
from .mend import LARGEST, Warnings, numbers_in

#: Defaults of <camera> (sdformat.org/spec, element camera): path, value, lowest and highest number.
DEFAULTS = (("horizontal_fov", "1.047", 1e-3, 3.14159), ("image/width", "320", 1.0, 16384.0),
            ("image/height", "240", 1.0, 16384.0), ("clip/near", "0.1", 1e-6, LARGEST), ("clip/far", "100", 1e-6, 1e5))
WIDEST = 6.28318  #: horizontal_fov of a fisheye [rad]
FORMATS = ("R8G8B8", "RGB_INT8", "B8G8R8", "BGR_INT8", "L8", "L_INT8", "R16G16B16", "RGB_INT16", "L16", "L_INT16",
           "BAYER_RGGB8", "BAYER_BGGR8", "BAYER_GBRG8", "BAYER_GRBG8")
#: Numbers that may be left out: of a sensor, of its <camera>, of its plugin.
OF_SENSOR = ("update_rate",)
OF_NOISE = ("noise/mean", "noise/stddev")
OF_CAMERA = ("distortion/k1", "distortion/k2", "distortion/k3", "distortion/p1", "distortion/p2", "lens/cutoff_angle")
OF_PLUGIN = ("updateRate", "Cx", "Cy", "CxPrime", "focalLength", "hackBaseline", "distortionK1", "distortionK2",
             "distortionK3", "distortionT1", "distortionT2")
FLAGS = ("autoDistortion", "borderCrop")
YES_OR_NO = ("true", "True", "1", "false", "False", "0")
LARGEST_RATE_HZ = 1e6
THROTTLED = "libgazebo_ros_camera.so"  #: the plugin whose <updateRate> leaves images out
LARGEST_NOISE = 1.0   #: of intensities 0 .. 1
LARGEST_VALUE = 1e6   #: of a plugin's value


def is_camera(sensor: ElementTree.Element) -> bool:
    """Returns whether a <sensor> draws images: its type is camera, depth, or one of the kinds of them."""
    return "camera" in sensor.get("type", "") or sensor.get("type") == "depth"


def mend_sensors(robot: ElementTree.Element, warnings: Warnings) -> None:
    """Sets missing and invalid values of cameras to SDF's defaults.

    Args: robot: root element, changed.  warnings: gets a line for each fault.
    """
    for gazebo in robot.findall("gazebo"):
        for sensor in filter(is_camera, gazebo.findall("sensor")):
            if not sensor.get("name", "").strip():
                name = "%s_%s" % (gazebo.get("reference", ""), sensor.get("type"))
                warnings.append(told("name", "<sensor> of link '%s'" % gazebo.get("reference"), "no name", name))
                sensor.set("name", name)
            _mend_camera(sensor, "sensor '%s'" % sensor.get("name"), warnings)


def _mend_camera(sensor: ElementTree.Element, what: str, warnings: Warnings) -> None:
    _drop_poses(sensor, what, warnings)
    _drop_wrong(sensor, OF_SENSOR, LARGEST_RATE_HZ, "camera value", what, warnings)
    if sensor.find("camera") is None:
        ElementTree.SubElement(sensor, "camera")
        warnings.append(told("camera", what, "no <camera>"))
        quiet: typing.Optional[Warnings] = None
    else:
        quiet = warnings
    for camera in sensor.findall("camera"):
        _drop_poses(camera, what, warnings)
        _drop_wrong(camera, OF_NOISE, LARGEST_NOISE, "camera value", what, warnings)
        _drop_wrong(camera, OF_CAMERA, LARGEST_VALUE, "camera value", what, warnings)
        _complete(camera, sensor.get("type") == "wideanglecamera", what, quiet)
    for plugin in sensor.findall("plugin"):
        _drop_wrong(plugin, OF_PLUGIN, LARGEST_VALUE, "key", what + ": plugin", warnings)
        for key in FLAGS:
            for element in plugin.findall(key):
                if (element.text or "").strip() not in YES_OR_NO:
                    plugin.remove(element)
                    warnings.append(told("key", "%s: plugin: <%s>" % (what, key), "'%s'" % _text(element)))
        if plugin.get("filename", "").endswith(THROTTLED):
            _throttle(sensor, plugin)


def _throttle(sensor: ElementTree.Element, plugin: ElementTree.Element) -> None:
    """Lowers <update_rate> to the images that the plugin publishes.

    The plugin leaves out images that come sooner after its last one than 1 / <updateRate>
    (GazeboRosCamera::OnNewFrame); 0 leaves out none. A sensor without <update_rate> draws as often as it can.
    """
    most_hz, drawn_hz = float(plugin.findtext("updateRate") or 0.0), float(sensor.findtext("update_rate") or 0.0)
    if 0.0 < drawn_hz <= most_hz or most_hz <= 0.0:
        return
    rate_hz = drawn_hz / math.ceil(drawn_hz / most_hz - 1e-9) if drawn_hz > 0.0 else most_hz
    _made(sensor, "update_rate").text = repr(rate_hz)


def _complete(camera: ElementTree.Element, wide: bool, what: str, warnings: typing.Optional[Warnings]) -> None:
    """Args: wide: has a fisheye lens.  warnings: None for none."""
    missing = []
    for path, value, lowest, highest in DEFAULTS:
        element = camera.find(path)
        if element is None:
            missing.append((path.rpartition("/")[2], value))
            _made(camera, path).text = value
            continue
        highest = WIDEST if wide and path == "horizontal_fov" else highest
        found = numbers_in(element.text, 1)
        whole = path not in ("image/width", "image/height") or found is not None and found[0] == int(found[0])
        if found is None or not lowest <= found[0] <= highest or not whole:
            if warnings is not None:
                warnings.append(told("camera value", "%s: <%s>" % (what, element.tag), "'%s'" % _text(element), value))
            element.text = value
    if missing and warnings is not None:
        warnings.append(told("camera", what, "no " + ", ".join("<%s>" % tag for tag, _ in missing),
                             "SDF's default, " + ", ".join(value for _, value in missing)))
    near, far = (float(camera.findtext("clip/" + key) or 0.0) for key in ("near", "far"))
    if near >= far:
        if warnings is not None:
            warnings.append(told("camera value", what + ": <clip>", "near %g m >= far %g m" % (near, far),
                                 "SDF's defaults, 0.1 and 100 m"))
        _made(camera, "clip/near").text, _made(camera, "clip/far").text = "0.1", "100"
    for element in camera.findall("image/format"):
        if _text(element) and _text(element) not in FORMATS:
            if warnings is not None:
                warnings.append(told("format", what + ": <format>", "'%s'" % _text(element)))
            element.text = "R8G8B8"


def _text(element: ElementTree.Element) -> str:
    return (element.text or "").strip()


def _made(element: ElementTree.Element, path: str) -> ElementTree.Element:
    """Returns the descendant of a path of tags, made where it is not there."""
    for tag in path.split("/"):
        found = element.find(tag)
        element = ElementTree.SubElement(element, tag) if found is None else found
    return element


def _drop_poses(element: ElementTree.Element, what: str, warnings: Warnings) -> None:
    for pose in element.findall("pose"):
        if numbers_in(pose.text, 6, LARGEST) is None:
            element.remove(pose)
            if _text(pose):
                warnings.append(told("origin", what + ": <pose>", "'%s'" % _text(pose)))


def _drop_wrong(element: ElementTree.Element, paths: typing.Iterable[str], most: float, fault: str, what: str,
                warnings: Warnings) -> None:
    """Takes out descendants that are no numbers."""
    for path in paths:
        above, _, tag = path.rpartition("/")
        for parent in element.findall(above) if above else [element]:
            for child in parent.findall(tag):
                if numbers_in(child.text, 1, most) is None or tag == "stddev" and float(child.text or 0.0) < 0.0:
                    parent.remove(child)
                    warnings.append(told(fault, "%s: <%s>" % (what, tag), "'%s'" % _text(child)))
