"""Faults of a part of a model or world, what is used in its place, and the line that says so: one table for the code
and for the page docs/from_gazebo_reference.md (script/key_tables writes it there).

Gazebo Classic takes such a part with a default, mends it, or leaves it out, and goes on; so does this overlay. The
simulator's own reading (sim.launch) stays strict: it gets the mended description.
"""
import dataclasses
import typing


@dataclasses.dataclass(frozen=True)
class Fault:
    """One kind of fault.

    Attributes:
        part: what has it.  found: what is wrong with it.  used: what stands in its place.
    """
    part: str
    found: str
    used: str


LEFT_OUT = "it is left out"
REFUSED = "SpawnModel: Failure - entity format is invalid: "  #: begins the answer about a document, as Gazebo's does

#: By key. Where sdformat, urdfdom or gazebo have the rule themselves, `used` is theirs.
FAULTS: typing.Dict[str, Fault] = {
    # --- inertia
    "mass": Fault("`<inertial>`", "a mass that is no number, or is missing", "SDF's default, 1 kg"),
    "no mass": Fault("`<inertial>`", "a mass below 0", "none, the link has no mass"),
    "inertia": Fault("`<inertia>`", "an entry that is no number, or is missing", "SDF's default: 1 kg m² for a moment, "
                     "0 for a product"),
    "moments": Fault("`<inertia>`", "moments below 0, or that break the triangle inequality", "the nearest moments "
                     "that a body can have"),
    "no inertia": Fault("`<inertia>`", "zero, of a link that a joint turns", "that of a ball of the link's mass, "
                        "10 mm in radius"),
    "massless": Fault("link that a joint moves", "no mass, with all that hangs from it", "it is left out with its "
                      "joint and all that hangs from it, as sdformat does"),
    "massless base": Fault("root link that is free", "no mass", "it is held in the world"),
    # --- joints
    "joint type": Fault("joint", "type `planar`, `floating` below the root, or an unknown one", "`fixed`"),
    "axis": Fault("joint", "an `<axis>` that is zero or no three numbers", "URDF's default, 1 0 0"),
    "no limit": Fault("joint", "no `<limit>`, of a joint that needs one, or a position limit that is no number",
                      "none: `revolute` turns without end, `prismatic` goes to 10 km"),
    "limits swapped": Fault("joint", "a lower limit above the upper one", "the two are exchanged, as sdformat does"),
    "effort": Fault("joint", "an effort limit below 0, or that is no number", "none (1e+6 N or N m)"),
    "velocity": Fault("joint", "a velocity limit of 0, below 0, or that is no number", "none (1000 m/s or rad/s), as "
                      "ODE has it"),
    "dynamics": Fault("joint", "damping or friction below 0, or that is no number", "0"),
    "safety": Fault("joint", "a `<safety_controller>` that contradicts itself", LEFT_OUT),
    "mimic": Fault("joint", "a `<mimic>` of a joint that is not there, that does not move, of itself, or whose "
                   "limits exclude its own", "it is left out: the joint moves by itself"),
    "joint": Fault("joint", "anything else that the simulator refuses", "it is held (`fixed`)"),
    # --- shapes and looks
    "origin": Fault("`<origin>`, `<pose>`", "anything but three numbers (six in a pose)",
                    "the first three, else zeros"),
    "shape": Fault("`<visual>`, `<collision>`", "no shape, an unknown one, a size that is not above 0, or a mesh "
                   "that cannot be read", LEFT_OUT),
    "texture": Fault("mesh, material", "a picture that cannot be read (`.webp`), or is not there", "the plain colour"),
    "look": Fault("tag of `<gazebo reference>`", "anything that the simulator refuses", LEFT_OUT),
    "friction": Fault("`<mu1>`, `<mu>`", "a coefficient above 1000", "1000, beyond which nothing slides either"),
    "coefficient": Fault("`<mu1>`, `<mu>`", "no number, or one below 0", "Gazebo's default, 1"),
    "intensity": Fault("`<laserRetro>`", "no number, or one below 0", "0"),
    "light": Fault("`<light>`", "anything that the simulator refuses", LEFT_OUT),
    # --- cameras
    "camera": Fault("camera sensor", "no `<camera>`, or an element of it is missing", "SDF's defaults: 320 x 240 "
                    "pixels, `horizontal_fov` 1.047 rad, `R8G8B8`, clip 0.1 to 100 m"),
    "camera value": Fault("camera sensor", "a value that is no number or out of range", "SDF's default"),
    "format": Fault("camera sensor", "a `<format>` that Gazebo does not know", "`R8G8B8`"),
    "twice": Fault("camera sensor", "a `cameraName` that another sensor has", "both publish, each under its own "
                   "topic names"),
    "key": Fault("plugin", "a number or flag that is none", "the plugin's default"),
    "sensor": Fault("sensor", "anything else that the simulator refuses", LEFT_OUT),
    "plugin": Fault("plugin", "values with which it cannot run", LEFT_OUT),
    "ros name": Fault("plugin", "a name of a topic or service with characters that ROS does not allow", "the name with "
                      "`_` in their place"),
    "topic": Fault("plugin", "a service that another plugin offers", "the first one's answers"),
    # --- documents of SDF
    "version": Fault("`<sdf>`", "a version that is none, or is missing", "1.6"),
    "name": Fault("element of SDF, sensor", "no name, a link called `world`, a model with `::` in its name",
                  "a name is made"),
    "element": Fault("element of SDF", "libsdformat refuses it", "SDF's default, or " + LEFT_OUT),
}


def told(key: str, where: str, found: object, used: str = "") -> str:
    """Returns the warning of a fault: where it is, what was found, and what is used instead.

    Args: key: of FAULTS.  where: the part by name.  found: what it says, or an error.  used: in place of the table's
    words.
    """
    return "%s: found %s: %s" % (where, str(found).replace(REFUSED, ""), used or FAULTS[key].used.replace("`", ""))


def table() -> typing.List[str]:
    """Returns the lines of the table for the page: one row a fault."""
    return ["| part | fault | used instead |", "|---|---|---|"] + [
        "| %s | %s | %s |" % (fault.part, fault.found, fault.used) for fault in FAULTS.values()]
