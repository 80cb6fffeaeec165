"""What rays of lasers meet: the shapes of all models, as <collision> or as <visual>."""
import numpy

from aras_visual_servo_sim import ArasError, RayCaster, mesh_triangles

from ..sdf.document import numbers
from .poses import IDENTITY, matrix_of_rpy

GROUND_BODY = 0  #: number of the ground plane's body
_meshes = {}     #: corners of the files read so far


class Rays:
    """Rays in a world. The shapes are collected anew when models have come or gone."""

    def __init__(self, world):
        """
        Args:
            world: World.
        """
        self._world = world
        self._casters = {}  #: "visual" or "collision" -> what was there, RayCaster, bodies, retro of each shape

    def cast(self, X_WS, directions, nearest_m, farthest_m, visuals):
        """
        Args:
            X_WS: (4, 4), of the sensor.  directions: (n, 3), unit vectors in its axes.
            visuals: whether the rays meet <visual>s, only from outside; else <collision>s, from inside too.
        Returns:
            distances (n,) [m], infinite where nothing is met, and laser_retro of what is met, (n,).
        """
        caster, bodies, retros = self._caster("visual" if visuals else "collision")
        for number, (model, link) in enumerate(bodies, GROUND_BODY + 1):
            caster.place(number, model.link_pose(link))
        distances, shapes = caster.cast(X_WS[:3, 3], directions @ X_WS[:3, :3].T, nearest_m, farthest_m, not visuals)
        return distances, retros[shapes]

    def _caster(self, kind):
        settings = self._world.settings
        there = (settings.ground, settings.floor_m, [model.simulation for model in self._world.models.values()])
        known = self._casters.get(kind)
        if known is None or known[0] != there:
            known = self._casters[kind] = (there, *self._made(kind))
        return known[1:]

    def _made(self, kind):
        caster, bodies, retros = RayCaster(), [], []
        floor_m = 0.0 if self._world.settings.ground else self._world.settings.floor_m
        if floor_m is not None:
            caster.add_plane(GROUND_BODY, matrix_of_rpy((0.0, 0.0, floor_m), (0.0, 0.0, 0.0)))
            retros.append(0.0)
        for model in self._world.models.values():
            for link in model.links:
                bodies.append((model, link))
                for shape in model.element_of(link).findall(kind):
                    if add_shape(caster, len(bodies) + GROUND_BODY, shape):
                        retros.append(model.description.retros.get(link, 0.0))
        return caster, bodies, numpy.array([*retros, 0.0])  # the last is that of nothing, number -1


def add_shape(caster, body, element):
    """Adds a <visual> or <collision> of a URDF. Returns whether there is something to be met."""
    geometry, X_BS = next(iter(element.find("geometry")), None), origin_of(element)
    try:
        if geometry.tag == "box":
            caster.add_box(body, numbers(geometry.get("size"), 3, "box"), X_BS)
        elif geometry.tag == "cylinder":
            caster.add_cylinder(body, float(geometry.get("radius")), float(geometry.get("length")), X_BS)
        elif geometry.tag == "sphere":
            caster.add_sphere(body, float(geometry.get("radius")), X_BS)
        elif geometry.tag == "mesh":
            caster.add_mesh(body, corners_of(geometry), X_BS)
        else:
            return False
    except ArasError:  # nothing to be met: no size, no triangles
        return False
    return True


def corners_of(mesh):
    """(n, 3, 3) of the triangles of a <mesh>. Raises: ArasError."""
    path = mesh.get("filename", "").replace("file://", "", 1)
    if path not in _meshes:
        _meshes[path] = mesh_triangles(path).astype(float)
    scale = numpy.array(numbers(mesh.get("scale", "1 1 1"), 3, "scale"))
    corners = _meshes[path] * scale
    return corners[:, ::-1] if scale.prod() < 0.0 else corners  # a mirror image is seen from its other side


def origin_of(element):
    """(4, 4) of the <origin> of an element of a URDF."""
    origin = element.find("origin")
    if origin is None:
        return IDENTITY
    return matrix_of_rpy(numbers(origin.get("xyz", "0 0 0"), 3, "xyz"), numbers(origin.get("rpy", "0 0 0"), 3, "rpy"))


def directions_of(horizontal, vertical):
    """(n, 3) unit vectors of two Scans: x ahead, y to the left, z up; those of one height follow each other."""
    heights, turns = numpy.meshgrid(vertical.angles(), horizontal.angles(), indexing="ij")
    return numpy.stack((numpy.cos(heights) * numpy.cos(turns), numpy.cos(heights) * numpy.sin(turns),
                        numpy.sin(heights)), axis=-1).reshape(-1, 3)


def resampled(values, horizontal, vertical):
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
