"""Reads .world files: physics, lights, and the initial models."""
import dataclasses
import typing
import xml.etree.ElementTree as ElementTree

import numpy

from aras_visual_servo_sim import ModelError

from ..faults import told
from ..world.devices import Device
from ..world.plugins import read_world_device
from ..world.settings import WorldSettings
from .document import NoFolders, expanded, number, numbers, pose_of
from .model import SdfModel, model_of

#: Elements of a world without effect here.
QUIET = {"name", "include", "model", "light", "physics", "gravity", "scene", "gui", "state", "magnetic_field",
         "atmosphere", "wind", "spherical_coordinates", "audio", "frame"}
GROUND = "ground_plane"
#: Content of Gazebo's worlds/empty.world.
EMPTY_WORLD = """<sdf version="1.6"><world name="default">
  <include><uri>model://ground_plane</uri></include><include><uri>model://sun</uri></include></world></sdf>"""
PERIODS_S = 1e-6, 0.1   #: the shortest and the longest step of the simulator
MOST_GRAVITY = 1000.0   #: [m/s^2]
PLANE_TOLERANCE = 1e-6  #: of a plane's normal and height, above the rounding of six decimals


@dataclasses.dataclass(frozen=True)
class WorldFile:
    """
    Attributes:
        settings: WorldSettings.
        update_rate_hz: steps per second of wall time, 0 for as many as there can be.
        models: SdfModel with the X_WM of each, (4, 4), in the order of the file, without the ground plane.
        ground_at: number of models before the ground plane.
        lights: text of <light> by name.
        warnings: about ignored parts, a line each.
        devices: plugins of the world, of world/plugins.
    """
    settings: WorldSettings
    update_rate_hz: float
    models: tuple
    lights: dict
    warnings: tuple
    ground_at: int = 0
    devices: tuple = ()


def read_world(source: str, is_path: bool, folders: NoFolders) -> WorldFile:
    """Args: source: a path, or the document. Raises: ModelError: no SDF, or no world."""
    root, warnings = expanded(source, is_path, folders)
    world = root.find("world")
    if world is None:
        raise ModelError("%s: found no <world>, allowed is an SDF document with one" %
                         (source if is_path else "the document"))
    states = {kind: {each.get("name"): each for each in world.findall("state/" + kind)} for kind in ("model", "light")}
    models, ground_at, settings = [], 0, settings_of(world, warnings)
    for element in world.findall("model"):
        model = model_of(element, folders)
        state, pose = states["model"].get(model.name), model.pose
        if state is not None:
            try:
                pose = pose_of(state, "state of model '%s'" % model.name)
            except ModelError as error:
                warnings.append(told("origin", "model '%s': <state>" % model.name, error, "the model's own <pose>"))
        if is_ground(model, pose):
            settings, ground_at = dataclasses.replace(settings, ground=True), len(models)
        else:
            models.append((model, pose))
    lights = {}
    for element in world.findall("light"):
        state = states["light"].get(element.get("name"))
        if state is not None and state.find("pose") is not None:
            for old in element.findall("pose"):
                element.remove(old)
            element.append(state.find("pose"))
        lights[element.get("name")] = ElementTree.tostring(element, encoding="unicode")
    devices = []
    for child in world:
        if child.tag == "plugin":
            devices += world_device(child, warnings)
        elif child.tag not in QUIET:
            name = child.get("name")
            warnings.append("<%s%s> of the world is not simulated: ignored" %
                            (child.tag, " name='%s'" % name if name else ""))
    rate_hz = max(0.0, tried(number, warnings, world, "physics/real_time_update_rate", 1000.0))
    return WorldFile(settings, rate_hz, tuple(models), lights, tuple(warnings), ground_at, tuple(devices))


def world_device(plugin: ElementTree.Element, warnings: typing.List[str]) -> typing.List[Device]:
    """Returns the device of a plugin of the world in a list: [] and a warning if it is not simulated."""
    try:
        device = read_world_device(plugin)
    except ValueError as error:
        warnings.append(told("plugin", "plugin %s of the world" % plugin.get("filename"), error))
        return []
    if device is None:
        warnings.append("plugin %s of the world is not simulated: ignored" % plugin.get("filename"))
    return [] if device is None else [device]


def is_ground(model: SdfModel, X_WM: numpy.ndarray) -> bool:
    """Whether this is the ground plane that every world has that includes it."""
    return model.name == GROUND and len(model.planes) == 1 and height_of(X_WM @ model.planes[0]) == 0.0


def height_of(X_WP: numpy.ndarray) -> typing.Optional[float]:
    """Of a plane that is horizontal, its height [m], else None."""
    if X_WP[2, 2] < 1.0 - PLANE_TOLERANCE:
        return None
    return 0.0 if abs(X_WP[2, 3]) < PLANE_TOLERANCE else float(X_WP[2, 3])


def tried(read: typing.Callable[..., typing.Any], warnings: typing.List[str], world: ElementTree.Element, path: str,
          otherwise: typing.Any) -> typing.Any:
    """read(world, path, otherwise, path); where that cannot be read, the default with a warning."""
    try:
        return read(world, path, otherwise, "<%s>" % path)
    except ModelError as error:
        warnings.append(told("element", "world: <%s>" % path, error, "SDF's default"))
        return otherwise


def vector(world: ElementTree.Element, path: str, otherwise: typing.Sequence[float],
           what: str) -> typing.Sequence[float]:
    """Three numbers of a descendant. Raises: ModelError."""
    text = world.findtext(path)
    return tuple(numbers(text, 3, what)) if text else otherwise


def settings_of(world: ElementTree.Element, warnings: typing.List[str]) -> WorldSettings:
    """WorldSettings of <physics>, <gravity> and <scene>; a world without a ground plane has none."""
    known = WorldSettings()
    period_s = tried(number, warnings, world, "physics/max_step_size", known.period_s)
    if not PERIODS_S[0] <= period_s <= PERIODS_S[1]:
        warnings.append(told("element", "world: <max_step_size>", "%g s" % period_s, "%g s" % known.period_s))
        period_s = known.period_s
    gravity = tried(vector, warnings, world, "gravity", known.gravity_m_s2)
    if numpy.linalg.norm(gravity) > MOST_GRAVITY:
        warnings.append(told("element", "world: <gravity>", "%g %g %g m/s^2" % gravity, "SDF's default"))
        gravity = known.gravity_m_s2
    return WorldSettings(
        period_s=period_s, gravity_m_s2=gravity, ground=False,
        ambient_rgb=tried(color_of, warnings, world, "scene/ambient", known.ambient_rgb),
        background_rgb=tried(color_of, warnings, world, "scene/background", known.background_rgb),
        shadows=world.findtext("scene/shadows", "true").strip().lower() not in ("false", "0"))


def color_of(world: ElementTree.Element, path: str, otherwise: typing.Sequence[float],
             what: str) -> typing.Sequence[float]:
    """Red, green, blue, 0 .. 255. Raises: ModelError."""
    text = (world.findtext(path) or "").split()
    if len(text) not in (3, 4):
        return otherwise
    return tuple(float(part) for part in 255.0 * numpy.clip(numbers(" ".join(text[:3]), 3, what), 0.0, 1.0))
