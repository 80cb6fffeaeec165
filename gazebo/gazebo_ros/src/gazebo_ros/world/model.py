"""One model of the world: a robot, or any other thing that a URDF describes."""
import dataclasses
import typing
import xml.etree.ElementTree as ElementTree

import numpy

from aras_visual_servo_sim import ArasError, ModelError, Robot, Simulation, UnknownNameError
from aras_visual_servo_sim import World as CoreWorld

from ..faults import told
from .description import MOVING, read_description
from .devices import Device
from .poses import IDENTITY, rotated, rpy_of
from ..urdf.parts import Ask, without_refused
from ..urdf.properties import LinkProperties, named, properties_of
from ..sdf.model import JOINT_FRAME
from .settings import GROUND_FRICTION, WorldSettings, world_of

Config = typing.Dict[str, typing.Any]  #: a section of the simulator's configuration
Pairs = typing.List[typing.List[str]]  #: of links
#: Suffix of the simulator's warning about collision shapes. It is wrong here: in this world they act.
OF_COLLISIONS = "<collision> shapes count only for what sim/contacts names"


def wheel_motor(joint: str) -> str:
    """Name of the controller that turns a wheel; no controller of ros_control can have it."""
    return "wheel motor of " + joint


class Model:
    """A model and its robot in the simulator's world.

    Attributes:
        name, description: as spawned.
        namespace: of its topics.
        simulation: aras_visual_servo_sim.Robot.
        links: names, in the order of the URDF.
        loaded: parameters and kind of the controllers that are loaded, by name.
    """

    def __init__(self, core: CoreWorld, name: str, xml: str, namespace: str, pose: numpy.ndarray,
                 gravity_m_s2: typing.Sequence[float], X_MR: numpy.ndarray = IDENTITY,
                 warnings: typing.Sequence[str] = ()) -> None:
        """
        Args:
            core: aras_visual_servo_sim.World, which gets the model.
            pose: X_WM, (4, 4).  X_MR: root link in the model's frame, (4, 4).
            warnings: lines about parts that were ignored before.
        Raises: ModelError: everything that is wrong with the URDF.
        """
        self.name, self.namespace, self._X_MR = name, namespace, X_MR
        self.spawned = (name, xml, namespace, pose, X_MR, tuple(warnings))  #: how to spawn it again
        self._said, self.loaded = [], {}
        self._describe(xml, gravity_m_s2)
        self._partial = False  #: the simulator refused parts of it, which are left out
        self.simulation = self._spawned(core, pose @ X_MR)
        said = (*warnings, *self.description.warnings, *self._said, *self.simulation.warnings)
        self.warnings = [each for each in dict.fromkeys(said) if not each.endswith(OF_COLLISIONS)]
        self._start_drives()
        self._lift()

    def _start_drives(self) -> None:
        """Starts the motors of the wheels; a drive whose wheels do not turn is left out."""
        for device in self.description.devices:
            if not device.motors():
                continue
            try:
                self._start_wheels(device)
            except ArasError as error:
                self.warnings.append(told("plugin", "drive of joints %s" % ", ".join(device.motors()), error))
                self.description = dataclasses.replace(self.description, devices=tuple(
                    each for each in self.description.devices if each is not device))

    def _describe(self, xml: str, gravity_m_s2: typing.Sequence[float]) -> None:
        self.description = read_description(xml, self.namespace, self.name)
        self._take_tree(ElementTree.fromstring(self.description.urdf))
        self._gravity = numpy.array((0.0, 0.0, 0.0) if self.description.weightless else gravity_m_s2)
        self._lifts, self._thrusts, self._outside = {}, {}, ({}, {})

    def thrust(self, link: str, wrench: numpy.ndarray) -> None:
        """Lets a plugin push a link from now on, besides all else, until it says otherwise. Args: wrench: (6,) [f; tau]
        in world axes at its centre of mass [N; N m]. Raises: ArasError."""
        self._thrusts[link] = numpy.asarray(wrench, float)
        self.push(*self._outside)

    def _take_tree(self, robot: ElementTree.Element) -> None:
        """Sets the element for the simulator."""
        self._tree = robot
        self.links = [link.get("name") for link in self._tree.findall("link")
                      if link.get("name") != "world" and not link.get("name").endswith(JOINT_FRAME)]

    @property
    def bodies(self) -> typing.List[str]:
        """The names of the links that Gazebo has, in its order."""
        return [link for link in self.description.bodies if link in self.links]

    def _leave_out_parts(self, ask: Ask, config: Config) -> None:
        """Removes parts that the simulator rejects. Args: ask: checks them, with this configuration."""
        robot, warnings = without_refused(self._tree, ask)
        self._partial = True
        self._said += warnings
        self._take_tree(robot)
        moving = {joint.get("name") for joint in robot.findall("joint") if joint.get("type") in MOVING}
        self.description = dataclasses.replace(
            self.description, urdf=ElementTree.tostring(robot, encoding="unicode"),
            collides=robot.find("link/collision") is not None,
            joint_types={name: kind for name, kind in self.description.joint_types.items() if name in moving})
        if not self.description.collides and config.get("base") == "driven":
            config.pop("contacts", None)

    def _lift(self) -> None:
        """Applies the forces that cancel the weight of links without gravity, from now on."""
        self._lifts = {link: (*(-self.properties_of(link).mass_kg * self._gravity), 0.0, 0.0, 0.0)
                       for link in self.links if link in self.description.lifted}
        if self._lifts:
            self.push({}, {})

    def push(self, links: typing.Dict[str, typing.Any], joints: typing.Dict[str, float]) -> None:
        """Lets these forces from outside act from now on, dict of link -> (6,) and of joint -> effort."""
        self._outside = links, joints
        total = {link: numpy.asarray(wrench, float) for link, wrench in links.items()}
        for own in (self._lifts, self._thrusts):
            for link, wrench in own.items():
                total[link] = numpy.asarray(wrench) + total.get(link, 0.0)
        self.simulation.push(total, joints)

    def renew(self, core: CoreWorld, xml: str, gravity_m_s2: typing.Sequence[float]) -> None:
        """Gives the model another document of the same links and joints, and gravity; its state stays.

        Raises: ArasError: a fault of the document, or it cannot be in this state.
        """
        before = dict(vars(self))
        try:
            self._describe(xml, gravity_m_s2)
            mended = [each for each in self.description.warnings if each not in before["description"].warnings]
            if mended:  # spawning repairs faults, changing a property rejects them
                raise ModelError("; ".join(mended))
            if self._partial:
                self._leave_out_parts(asker(self._config(IDENTITY, 1e-9 * core.period_ns)), {})
            core.renew(self.name, self.description.urdf, self._gravity)
        except ArasError:
            vars(self).update(before)
            raise
        self.spawned = (self.name, xml, *self.spawned[2:])
        self._lift()

    def _config(self, pose: numpy.ndarray, period_s: float) -> Config:
        """The simulator's configuration of the model. Args: pose: X_WR, (4, 4)."""
        base = "floating"
        if self.description.fixed:
            base = "fixed" if self.description.jointed else "driven"  # one without joints can be placed anew
        config = {"base": base, "idle_joints": "hold",
                  "compatibility": "gazebo", "period_s": period_s, "command_timeout_s": 0.0,
                  "gravity_m_s2": self._gravity.tolist(),
                  "base_pose": {"position_m": [float(each) for each in pose[:3, 3]],
                                "rpy_rad": [float(each) for each in rpy_of(pose)]}}
        if base != "driven" or self.description.collides:  # without shapes too: others may be held to it
            config["contacts"] = {"friction": GROUND_FRICTION, "frictions": self.description.frictions,
                                  "neighbours": True}
        return config

    def _spawned(self, core: CoreWorld, pose: numpy.ndarray) -> Robot:
        config = self._config(pose, 1e-9 * core.period_ns)
        try:
            return self._spawn(core, config)
        except ArasError as error:
            self._leave_out_parts(asker(config), config)
            if not self._said:
                raise self._refused(error) from error
        try:
            return self._spawn(core, config)
        except ArasError as error:
            raise self._refused(error) from error

    def _refused(self, error: ArasError) -> ModelError:
        return ModelError("SpawnModel: model '%s' cannot be simulated: %s" % (self.name, error))

    def _spawn(self, core: CoreWorld, config: Config) -> Robot:
        pairs = self_pairs(self._tree, self.description.self_collides)
        if pairs and "contacts" in config:
            config["contacts"]["pairs"] = self._apart(config, pairs)
        return core.spawn(self.name, self.description.urdf, config)

    def _apart(self, config: Config, pairs: Pairs) -> Pairs:
        """The pairs of links that touch each other, without those that are in each other where the model begins."""
        tried = {**config, "contacts": {**config["contacts"], "pairs": pairs}}
        without = overlapping(Simulation(self.description.urdf, tried, {}), pairs)
        self._said += ["links %s and %s are in each other where the model begins: they do not touch each other" %
                       tuple(pair) for pair in without]
        return [pair for pair in pairs if pair not in without]

    def load_controller(self, name: str, parameters: Config, kind: str = "") -> typing.List[str]:
        """Loads a controller, listed as type `kind`. Returns lines about ignored keys. Raises: ArasError."""
        warnings = self.simulation.load_controller(name, parameters)
        self.loaded[name] = [parameters, kind or parameters["type"]]
        return warnings

    def unload_controller(self, name: str) -> None:
        """Raises: ArasError."""
        self.simulation.unload_controller(name)
        self.loaded.pop(name, None)

    def begin_anew(self, core: CoreWorld, gravity_m_s2: typing.Sequence[float]) -> None:
        """Goes on in another world of the simulator: the joints rest where they are and the base goes on; the
        controllers that were loaded and running are so again."""
        before, loaded = self.simulation, self.loaded
        running = [each["name"] for each in before.loaded_controllers() if each["state"] == "running"]
        twist = numpy.zeros(6) if self.description.fixed else self.twist()
        self.__init__(core, *self.spawned[:4], gravity_m_s2, *self.spawned[4:])
        if not self.description.fixed or not self.description.jointed:
            self.simulation.set_base(before.base_pose, twist)
        if self.description.jointed:
            self.simulation.set_joint_positions(dict(zip(before.joint_names, before.joint_positions)))
        there = {each["name"] for each in self.simulation.loaded_controllers()}
        for controller, (parameters, kind) in loaded.items():
            self.load_controller(controller, parameters, kind)
        self.simulation.switch_controllers([each for each in running if each in loaded and each not in there])

    def _start_wheels(self, drive: Device) -> None:
        """Lets motors turn the wheels of a drive from now on, with no speed at first."""
        names = []
        for joint in drive.motors():
            names.append(wheel_motor(joint))
            self.simulation.load_controller(names[-1], {"type": "velocity_controllers/JointVelocityController",
                                                        "joint": joint})
        self.simulation.switch_controllers(names, [], True)

    def turn_wheels(self, drive: Device, speeds_rad_s: typing.Iterable[float]) -> None:
        """Speeds of the wheels from now on, in the order of the drive's motors."""
        for joint, speed in zip(drive.motors(), speeds_rad_s):
            self.simulation.set_controller_command(wheel_motor(joint), float(speed))

    # --- state

    @property
    def gravity_m_s2(self) -> numpy.ndarray:
        """(3,), as it acts on the model."""
        return self._gravity

    @property
    def root(self) -> str:
        """Name of the link whose pose is the model's."""
        return next(iter(self.bodies), "world")

    def pose(self) -> numpy.ndarray:
        """X_WM, (4, 4)."""
        return self.simulation.base_pose @ numpy.linalg.inv(self._X_MR)

    def link_pose(self, link: str) -> numpy.ndarray:
        """X_WL, (4, 4). Raises: UnknownNameError."""
        if link not in self.links:
            raise UnknownNameError("link '%s' of model '%s' does not exist" % (link, self.name))
        return self.simulation.link_pose(link)

    def link_twist(self, link: str) -> numpy.ndarray:
        """(6,), [v; w] in world axes."""
        pose = self.link_pose(link)
        return rotated(pose, self.simulation.link_twist(link))

    def twist(self) -> numpy.ndarray:
        return self.link_twist(self.root) if self.links else numpy.zeros(6)

    def place(self, pose: numpy.ndarray, twist: numpy.ndarray) -> None:
        """Puts the model somewhere else, with a twist [v; w] in world axes.

        Raises: ArasError: numbers that are not finite, or the model has joints and is fixed in the world.
        """
        self.simulation.set_base(pose @ self._X_MR, twist)

    def set_joints(self, positions: typing.Dict[str, float]) -> None:
        """Places joints, dict of name -> [m or rad], at rest. Raises: ArasError."""
        self.simulation.set_joint_positions(positions)

    # --- the description

    def properties_of(self, link: str) -> LinkProperties:
        """LinkProperties of a link."""
        gravity = not self.description.weightless and link not in self.description.lifted
        return properties_of(named(self._tree, "link", link), gravity)

    def centre_of_mass(self, link: str) -> numpy.ndarray:
        """(3,), in the world."""
        return (self.link_pose(link) @ (*self.properties_of(link).com_m, 1.0))[:3]

    def radius_of(self, link: str) -> typing.Optional[float]:
        """Of the cylinder or sphere that the link collides with; None: it is no such thing."""
        for shape in ("cylinder", "sphere"):
            found = self._tree.find("link[@name='%s']/collision/geometry/%s" % (link, shape))
            if found is not None:
                return float(found.get("radius"))
        return None

    def damping_of(self, joint: str) -> float:
        """[N s/m or N m s/rad]."""
        dynamics = self._tree.find("joint[@name='%s']/dynamics" % joint)
        return 0.0 if dynamics is None else float(dynamics.get("damping", 0.0))


def asker(config: Config) -> Ask:
    """Implements parts.Ask with the simulator in a separate world. Args: config: of the whole model."""
    contacts = {key: value for key, value in config.get("contacts", {}).items() if key == "friction"}

    def ask(robot: ElementTree.Element, whole: bool) -> str:
        links = {link.get("name") for link in robot.findall("link")}
        children = {joint.find("child").get("link") for joint in robot.findall("joint")}
        own = {**config, "base": config["base"] if whole else "fixed" if links - children == {"world"} else "floating"}
        own.pop("contacts", None)
        if robot.find("link/collision") is not None:
            own["contacts"] = {**contacts, "neighbours": True}
        try:
            world_of(WorldSettings(period_s=config["period_s"])).spawn(
                "part", ElementTree.tostring(robot, encoding="unicode"), own)
        except ArasError as error:
            return str(error)
        return ""
    return ask


def self_pairs(robot: ElementTree.Element, links: typing.Collection[str]) -> Pairs:
    """Args: robot: root element of a URDF.  links: names of those that collide with the model itself.
    Returns: list of [a, b], links with <collision>s that are not on one body nor on two with one joint between them.
    """
    body = {link.get("name"): link.get("name") for link in robot.findall("link")}

    def body_of(link: str) -> str:
        while body[link] != link:
            link = body[link]
        return link

    moving = []
    for joint in robot.findall("joint"):
        ends = joint.find("parent").get("link"), joint.find("child").get("link")
        if joint.get("type") == "fixed":
            body[body_of(ends[1])] = body_of(ends[0])
        else:
            moving.append(ends)
    joined = {frozenset(map(body_of, ends)) for ends in moving}
    hard = [link.get("name") for link in robot.findall("link")
            if link.get("name") in links and link.find("collision") is not None]
    return [[one, other] for k, one in enumerate(hard) for other in hard[k + 1:]
            if body_of(one) != body_of(other) and frozenset((body_of(one), body_of(other))) not in joined]


def overlapping(simulation: Simulation, pairs: Pairs) -> Pairs:
    """Those of the pairs that are in each other where the model is spawned: its shapes are rougher than its links.

    Args: simulation: in which they touch; is stepped once.
    """
    simulation.step(1)
    touching = {frozenset((each["a"], each["b"])) for each in simulation.contacts}
    return [pair for pair in pairs if frozenset(pair) in touching]
