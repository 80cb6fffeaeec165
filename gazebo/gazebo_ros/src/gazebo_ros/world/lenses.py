"""Lenses of wide-angle cameras as the polynomial that the simulator draws: <lens> of SDF.

SDF gives r = c1 f fun(theta / c2 + c3) for a ray at an angle theta from the axis, in halves of the image's width; the
named types are special cases (sdformat, lens.sdf). The simulator's lens is r = f theta (1 + k1 theta^2 + ... + k4
theta^8); the k are fitted by least squares over the angles that are drawn."""
import math
import typing
import xml.etree.ElementTree as ElementTree

import numpy

from .devices import number, text

WIDEST_RAD = 2.18   #: the simulator draws nothing farther from the axis
CUTOFF_RAD = 1.5707  #: SDF's default
FIELD_RAD = 1.047   #: SDF's default of horizontal_fov
NAMED = {"gnomonical": (1.0, 1.0, 0.0, "tan"), "stereographic": (2.0, 2.0, 0.0, "tan"),
         "equidistant": (1.0, 1.0, 0.0, "id"), "equisolid_angle": (2.0, 2.0, 0.0, "sin"),
         "orthographic": (1.0, 1.0, 0.0, "sin")}
FUNCTIONS = {"tan": numpy.tan, "sin": numpy.sin, "id": lambda angle: angle}
SAMPLES = 400
#: Largest angle in the function at which it grows.
ENDS = {"tan": 0.47 * math.pi, "sin": 0.5 * math.pi, "id": math.inf}
MOST_FIELD_RAD = 6.28  #: that the simulator takes


def replace_lenses(robot: ElementTree.Element, warnings: typing.List[str]) -> None:
    """Lets wide-angle cameras have the simulator's lens. Args: robot: element of the URDF.  warnings: gets a line for
    each lens that is drawn to less than its cut-off, or that cannot be."""
    for sensor in robot.findall("gazebo/sensor"):
        camera = sensor.find("camera")
        if sensor.get("type") != "wideanglecamera" or camera is None:
            continue
        lens = camera.find("lens")
        if lens is None:  # SDF's default
            lens = ElementTree.SubElement(camera, "lens")
        kind = text(lens, "type", "stereographic")
        if kind == "equidistant":
            continue
        try:
            c1, c2, c3, f, name = function_of(lens, kind)
            scaled = text(lens, "scale_to_hfov", "true").lower() in ("true", "1")
            field = number(camera, "horizontal_fov", FIELD_RAD)
            cutoff = number(lens, "cutoff_angle", CUTOFF_RAD)
            polynomial, wide, reach = fitted(c1, c2, c3, f, name, field, scaled, cutoff)
        except ValueError as error:
            warnings.append("camera '%s': <lens>: %s: the equidistant lens is taken" % (sensor.get("name"), error))
            polynomial, wide, reach = (0.0,) * 4, None, None
        for child in list(lens):
            if child.tag != "env_texture_size":
                lens.remove(child)
        for tag, words in (("type", "equidistant"), ("polynomial", " ".join(map(repr, map(float, polynomial)))),
                           ("cutoff_angle", None if reach is None else repr(reach))):
            if words is not None:
                ElementTree.SubElement(lens, tag).text = words
        if wide is not None:
            for old in camera.findall("horizontal_fov"):
                camera.remove(old)
            ElementTree.SubElement(camera, "horizontal_fov").text = repr(wide)


def function_of(lens: ElementTree.Element, kind: str) -> typing.Tuple[float, float, float, float, str]:
    """Returns c1, c2, c3, f and the name of the function of a <lens>. Raises: ValueError: no such type or function."""
    if kind != "custom":
        if kind not in NAMED:
            raise ValueError("found type %s, allowed are custom, %s" % (kind, ", ".join(NAMED)))
        c1, c2, c3, name = NAMED[kind]
        return c1, c2, c3, 1.0, name
    own = lens.find("custom_function")
    values = [number(own, key, default) for key, default in (("c1", 1.0), ("c2", 1.0), ("c3", 0.0), ("f", 1.0))]
    name = text(own, "fun", "tan")
    if name not in FUNCTIONS:
        raise ValueError("found function %s, allowed are %s" % (name, ", ".join(FUNCTIONS)))
    if not (values[0] > 0.0 and values[1] > 0.0 and values[3] > 0.0 and math.isfinite(sum(values))):
        raise ValueError("found c1 %g, c2 %g, f %g, allowed are numbers > 0" % (values[0], values[1], values[3]))
    c1, c2, c3, f = values
    return c1, c2, c3, f, name


def fitted(c1: float, c2: float, c3: float, f: float, name: str, field_rad: float, scaled: bool,
           cutoff_rad: float) -> typing.Tuple[typing.Tuple[float, ...], float, float]:
    """Fits the simulator's lens.

    Returns: k1 k2 k3 k4; the horizontal field that gives the simulator's lens without them the same focal length [rad];
    the angle up to which it is drawn [rad].
    Raises: ValueError: such a lens has no image, or one wider than the simulator can draw.
    """
    function = FUNCTIONS[name]
    reach = min(WIDEST_RAD, cutoff_rad, c2 * (ENDS[name] - c3) if math.isfinite(ENDS[name]) else math.inf)
    if not reach > 0.0:
        raise ValueError("found a cut-off of %g rad, allowed is > 0" % reach)
    angles = reach * numpy.arange(1, SAMPLES + 1) / SAMPLES
    step = 1e-6
    slope = float(function(step / c2 + c3) - function(c3)) / step  # of the function at the axis, per rad
    if not slope > 0.0:
        raise ValueError("found c3 %g, allowed is one where the function grows" % c3)
    radii = (function(angles / c2 + c3) - function(c3)) / slope
    powers = numpy.stack([angles ** (2 * k + 3) for k in range(4)], axis=1)
    polynomial = numpy.linalg.lstsq(powers, radii - angles, rcond=None)[0]
    if scaled:
        half = min(0.5 * field_rad, reach)
        focal = 1.0 / (float(function(half / c2 + c3) - function(c3)) / slope)  # halves of the width
    else:
        focal = c1 * f * slope
    if not 2.0 / focal < MOST_FIELD_RAD:
        raise ValueError("found an image of %g focal lengths, allowed is < %g" % (2.0 / focal, MOST_FIELD_RAD))
    return tuple(polynomial), 2.0 / focal, float(reach)
