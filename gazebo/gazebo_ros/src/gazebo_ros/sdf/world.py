"""What a .world file says: physics, light, and the models that are there at first."""
import dataclasses
import xml.etree.ElementTree as ElementTree

import numpy

from aras_visual_servo_sim import ModelError

from ..world.plugins import read_world_device
from ..world.settings import WorldSettings
from .document import expanded, number, numbers, pose_of
from .model import model_of

#: What a world may have that changes nothing here.
QUIET = {"name", "include", "model", "light", "physics", "gravity", "scene", "gui", "state", "magnetic_field",
         "atmosphere", "wind", "spherical_coordinates", "audio", "frame"}
GROUND = "ground_plane"
#: What Gazebo's worlds/empty.world has.
EMPTY_WORLD = """<sdf version="1.6"><world name="default">
  <include><uri>model://ground_plane</uri></include><include><uri>model://sun</uri></include></world></sdf>"""
PLANE_TOLERANCE = 1e-6  #: of a plane's normal and height, beside what six decimals of a file round


@dataclasses.dataclass(frozen=True)
class WorldFile:
    """
    Attributes:
        settings: WorldSettings.
        update_rate_hz: steps per second of wall time, 0 for as many as there can be.
        models: SdfModel with the X_WM of each, (4, 4), in the order of the file.
        lights: text of <light> by name.
        warnings: what is ignored, a line each.
        devices: what plugins of the world do, of world/plugins.
    """
    settings: WorldSettings
    update_rate_hz: float
    models: tuple
    lights: dict
    warnings: tuple
    devices: tuple = ()


def read_world(source, is_path, folders):
    """Args: source: a path, or the document. Raises: ModelError: no SDF, or no world."""
    root, warnings = expanded(source, is_path, folders)
    world = root.find("world")
    if world is None:
        raise ModelError("found no <world>, allowed is an SDF document with one")
    states = {kind: {each.get("name"): each for each in world.findall("state/" + kind)} for kind in ("model", "light")}
    models, settings = [], settings_of(world)
    for element in world.findall("model"):
        try:
            model = model_of(element, folders)
        except ModelError as error:
            warnings.append("model '%s': %s" % (element.get("name"), error))
            continue
        state = states["model"].get(model.name)
        pose = model.pose if state is None else pose_of(state, "state of model '%s'" % model.name)
        if is_ground(model, pose):
            settings = dataclasses.replace(settings, ground=True)
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
        if child.tag == "plugin" and read_world_device(child) is not None:
            devices.append(read_world_device(child))
        elif child.tag == "plugin":
            warnings.append("plugin %s of the world is not simulated: ignored" % child.get("filename"))
        elif child.tag not in QUIET:
            name = child.get("name")
            warnings.append("<%s%s> of the world is not simulated: ignored" %
                            (child.tag, " name='%s'" % name if name else ""))
    rate_hz = number(world, "physics/real_time_update_rate", 1000.0, "physics")
    return WorldFile(settings, rate_hz, tuple(models), lights, tuple(warnings), tuple(devices))


def is_ground(model, X_WM):
    """Whether this is the ground plane that every world has that includes it."""
    return model.name == GROUND and len(model.planes) == 1 and height_of(X_WM @ model.planes[0]) == 0.0


def height_of(X_WP):
    """Of a plane that is horizontal, its height [m], else None."""
    if X_WP[2, 2] < 1.0 - PLANE_TOLERANCE:
        return None
    return 0.0 if abs(X_WP[2, 3]) < PLANE_TOLERANCE else float(X_WP[2, 3])


def settings_of(world):
    """WorldSettings of <physics>, <gravity> and <scene>; a world without a ground plane has none."""
    known = WorldSettings()
    gravity = world.findtext("gravity")
    return WorldSettings(
        period_s=number(world, "physics/max_step_size", known.period_s, "physics"),
        gravity_m_s2=tuple(numbers(gravity, 3, "<gravity>")) if gravity else known.gravity_m_s2, ground=False,
        ambient_rgb=color_of(world, "scene/ambient", known.ambient_rgb),
        background_rgb=color_of(world, "scene/background", known.background_rgb),
        shadows=world.findtext("scene/shadows", "true").strip().lower() not in ("false", "0"))


def color_of(world, path, otherwise):
    """Red, green, blue, 0 .. 255."""
    text = (world.findtext(path) or "").split()
    if len(text) not in (3, 4):
        return otherwise
    return tuple(float(part) for part in 255.0 * numpy.clip(numbers(" ".join(text[:3]), 3, "<%s>" % path), 0.0, 1.0))
