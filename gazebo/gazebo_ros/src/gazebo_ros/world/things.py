"""Things: models of one free link with one simple shape, which robots push and which lie on each other.

Each model is a simulation of its own, and what touches must be in one. A thing is therefore a solid with mass in the
simulation of its host: the robot that is nearest when it comes, else the first thing of the world. Its own simulation
stands still and is put where the solid is.
"""
import numpy

from ..sdf.document import numbers
from .poses import quaternion_of
from .rays import origin_of

SOLID = "thing"  #: ends the name of the solid in the host


def solid_name(model):
    return "%s::%s" % (model, SOLID)


def described(robot, model):
    """What a model is as a solid.

    Args:
        robot: root element of its URDF.  model: its name.
    Returns:
        entry of the simulator's sim.scene.solids[] and X_LS (4, 4), the shape in the link; None if it is no thing.
    """
    links = robot.findall("link")
    shapes = links[0].findall("collision") if len(links) == 1 else []
    mass = links[0].find("inertial/mass") if links else None
    if len(shapes) != 1 or mass is None or float(mass.get("value", 0.0)) <= 0.0:
        return None
    geometry = next(iter(shapes[0].find("geometry")), None)
    if geometry is None or geometry.tag not in ("box", "cylinder", "sphere"):
        return None
    entry = {"name": solid_name(model), "mass_kg": float(mass.get("value")), "touches": "all",
             "material": {"opacity": 0.0, "casts_shadows": False}}
    if geometry.tag == "box":
        entry["box_m"] = numbers(geometry.get("size"), 3, "box")
    elif geometry.tag == "cylinder":
        entry["cylinder_m"] = [float(geometry.get("radius")), float(geometry.get("length"))]
    else:
        entry["sphere_m"] = float(geometry.get("radius"))
    return entry, origin_of(shapes[0])


def enter(thing, host):
    """Makes a host simulate a thing, from where the thing is, at rest."""
    host.simulation.spawn_model(thing.thing[0])
    thing.host = host.name
    put(thing, host)


def put(thing, host):
    """Puts the solid in the host to where the thing is."""
    pose = thing.simulation.base_pose @ thing.thing[1]
    host.simulation.set_model_pose(solid_name(thing.name), pose[:3, 3], quaternion_of(pose))


def leave(thing, host):
    """Lets a thing be simulated by itself again; it goes on as it moves."""
    host.simulation.delete_model(solid_name(thing.name))
    thing.host = None


def follow(thing, host):
    """Puts a thing to where the solid in the host is."""
    X_WS = host.simulation.model_pose(solid_name(thing.name))
    V_WS = host.simulation.model_twist(solid_name(thing.name))
    X_WL = X_WS @ numpy.linalg.inv(thing.thing[1])
    linear = V_WS[:3] + numpy.cross(V_WS[3:], X_WL[:3, 3] - X_WS[:3, 3])
    thing.simulation.set_base(X_WL, numpy.concatenate((linear, V_WS[3:])))


def host_for(thing, models):
    """The model that is to simulate a thing, None for itself.

    Args:
        models: all of the world, in the order in which they came.
    """
    robots = [each for each in models if each.description.jointed and each.description.collides]
    if robots:
        here = thing.pose()[:3, 3]
        return min(robots, key=lambda robot: numpy.linalg.norm(robot.pose()[:3, 3] - here))
    first = next(each for each in models if each.thing is not None)
    return None if first is thing else first
