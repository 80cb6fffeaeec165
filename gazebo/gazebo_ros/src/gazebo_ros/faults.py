"""Faulty parts of a model or world, and their replacements.

One table for the code and for docs/from_gazebo_reference.md, where script/key_tables writes it. Gazebo Classic replaces
such a part, repairs it or leaves it out, and continues. The overlay does the same. The simulator's own reader
(sim.launch) stays strict: it receives the repaired description.
"""
import dataclasses
import typing


@dataclasses.dataclass(frozen=True)
class Fault:
    """One kind of fault.

    Attributes:
        part: element or kind of part that has it.  found: the fault.  used: the replacement.
    """
    part: str
    found: str
    used: str


LEFT_OUT = "left out"
REFUSED = "SpawnModel: Failure - entity format is invalid: "  #: begins the answer about a document, as Gazebo's does

#: By key. Where sdformat, urdfdom or gazebo define a replacement, `used` is theirs.
FAULTS: typing.Dict[str, Fault] = {
    # --- inertia
    "mass": Fault("`<inertial>`", "mass missing or not a number", "SDF's default, 1 kg"),
    "no mass": Fault("`<inertial>`", "mass below 0", "no mass"),
    "inertia": Fault("`<inertia>`", "entry missing or not a number", "SDF's default: moments 1 kg m², products 0"),
    "moments": Fault("`<inertia>`", "moments negative or against the triangle inequality", "nearest valid moments"),
    "no inertia": Fault("`<inertia>`", "zero on a link that a joint turns", "ball of the link's mass, radius 10 mm"),
    "massless": Fault("link of a moving joint", "no mass on it and its children", "left out with joint and children, "
                      "as by sdformat"),
    "massless base": Fault("free root link", "no mass", "fixed to the world"),
    # --- joints
    "joint type": Fault("joint", "type `planar`, `floating` below the root, or unknown", "`fixed`"),
    "axis": Fault("joint", "`<axis>` zero or not three numbers", "URDF's default, 1 0 0"),
    "no limit": Fault("joint", "required `<limit>` missing, or position limit not a number",
                      "none: `revolute` unlimited, `prismatic` up to 10 km"),
    "limits swapped": Fault("joint", "lower limit above upper limit", "limits exchanged, as by sdformat"),
    "effort": Fault("joint", "effort limit negative or not a number", "none (1e+6 N or N m)"),
    "velocity": Fault("joint", "velocity limit not above 0 or not a number", "none (1000 m/s or rad/s), as in ODE"),
    "dynamics": Fault("joint", "damping or friction negative or not a number", "0"),
    "safety": Fault("joint", "contradictory `<safety_controller>`", LEFT_OUT),
    "mimic": Fault("joint", "`<mimic>` of itself, of a missing or fixed joint, or outside its limits",
                   "left out: the joint moves by itself"),
    "joint": Fault("joint", "anything else that the simulator rejects", "`fixed`"),
    # --- shapes and materials
    "origin": Fault("`<origin>`, `<pose>`", "not three numbers (six in a pose)", "the first three, else zeros"),
    "shape": Fault("`<visual>`, `<collision>`", "shape missing or unknown, size not above 0, unreadable mesh",
                   LEFT_OUT),
    "texture": Fault("mesh, material", "picture missing or unreadable (`.webp`)", "the plain colour"),
    "look": Fault("tag of `<gazebo reference>`", "anything that the simulator rejects", LEFT_OUT),
    "friction": Fault("`<mu1>`, `<mu>`", "above 1000", "1000"),
    "coefficient": Fault("`<mu1>`, `<mu>`", "negative or not a number", "Gazebo's default, 1"),
    "intensity": Fault("`<laserRetro>`", "negative or not a number", "0"),
    "light": Fault("`<light>`", "anything that the simulator rejects", LEFT_OUT),
    # --- cameras
    "camera": Fault("camera sensor", "`<camera>` or an element of it missing", "SDF's defaults: 320 x 240 pixels, "
                    "`horizontal_fov` 1.047 rad, `R8G8B8`, clip 0.1 to 100 m"),
    "camera value": Fault("camera sensor", "value not a number or out of range", "SDF's default"),
    "format": Fault("camera sensor", "`<format>` unknown to Gazebo", "`R8G8B8`"),
    "twice": Fault("camera sensor", "`cameraName` of another sensor", "both publish, each under its own topics"),
    "key": Fault("plugin", "invalid number or flag", "the plugin's default"),
    "sensor": Fault("sensor", "anything else that the simulator rejects", LEFT_OUT),
    "plugin": Fault("plugin", "values with which it cannot run", LEFT_OUT),
    "ros name": Fault("plugin", "characters in a topic or service name that ROS does not allow", "`_` in their place"),
    "topic": Fault("plugin", "service that another plugin offers", "the first plugin answers"),
    # --- documents of SDF
    "version": Fault("`<sdf>`", "version missing or invalid", "1.6"),
    "name": Fault("element of SDF, sensor", "no name, link `world`, `::` in a model's name", "a generated name"),
    "element": Fault("element of SDF", "rejected by libsdformat", "SDF's default, or left out"),
}


def told(key: str, where: str, found: object, used: str = "") -> str:
    """Returns the warning about a fault: the part, the value found, and the replacement.

    Args: key: of FAULTS.  where: the part by name.  found: its value, or an error.  used: the replacement, if it
    differs from the table's.
    """
    return "%s: found %s: %s" % (where, str(found).replace(REFUSED, ""), used or FAULTS[key].used.replace("`", ""))


def table() -> typing.List[str]:
    """Returns the lines of the table for the page, one row per fault."""
    return ["| fault | replacement |", "|---|---|"] + [
        "| %s: %s | %s |" % (fault.part, fault.found, fault.used) for fault in FAULTS.values()]
