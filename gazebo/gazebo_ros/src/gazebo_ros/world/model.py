"""One model of the world: a robot, or any other thing that a URDF describes."""
import xml.etree.ElementTree as ElementTree

import numpy

from aras_visual_servo_sim import ArasError, Simulation

from .description import mass_of, read_description
from .devices import DiffDrive
from .errors import BadValueError, SpawnError, UnknownEntityError
from .lights import SUN
from .poses import IDENTITY, quaternion_of, rotated, rpy_of
from ..urdf.self_contacts import overlapping, self_pairs
from ..sdf.model import JOINT_FRAME
from .settings import WorldSettings
from .solids import solid_of
from .things import described


#: What cameras see of Gazebo's ground plane: 100 m wide, of its material Gazebo/Grey, which casts no shadow.
GROUND_PLANE = {"name": "ground_plane", "box_m": [100.0, 100.0, 0.01], "position_m": [0.0, 0.0, -0.005],
                "color_rgb": [178.5] * 3,
                "material": {"ambient_share": 0.3 / 0.7, "specular_rgb": [2.55] * 3, "shininess": 1.5,
                             "casts_shadows": False}}


#: Coulomb's coefficient of a link that states none, as in Gazebo; of two that touch, the smaller one counts.
GROUND_FRICTION = 1.0
#: Ends what the simulator says of any model that has shapes to collide with: here they do.
OF_COLLISIONS = "<collision> shapes count only for what sim/contacts names"


def wheel_motor(joint):
    """Name of the controller that turns a wheel; no controller of ros_control can have it."""
    return "wheel motor of " + joint


class Model:
    """A model and its simulation, whose time begins when it is spawned.

    Attributes:
        name, description: as spawned.
        namespace: of its topics.
        simulation: aras_visual_servo_sim.Simulation.
        begun_ns: time of the world at the simulation's tick 0, int [ns].
        links: names, in the order of the URDF.
        settings: WorldSettings that it was made with.
        loaded: parameters and kind of the controllers that are loaded, by name.
    """

    def __init__(self, name, xml, namespace, pose, settings, begun_ns, X_MR=IDENTITY, warnings=()):
        """
        Args:
            pose: X_WM, (4, 4).  X_MR: root link in the model's frame, (4, 4).
            settings: WorldSettings.
            warnings: lines of what was ignored before.
        Raises:
            SpawnError: everything that is wrong with the URDF.
        """
        self.name, self.namespace, self.begun_ns, self._X_MR = name, namespace, begun_ns, X_MR
        self.spawned = (name, xml, namespace, pose, X_MR, tuple(warnings))  #: how to spawn it again
        self.description = read_description(xml, namespace, name)
        self._said = []             #: warnings of its own
        self.simulation = self._made(settings, pose @ X_MR)
        robot = self._tree = ElementTree.fromstring(self.description.urdf)
        self.links = [link.get("name") for link in robot.findall("link")
                      if link.get("name") != "world" and not link.get("name").endswith(JOINT_FRAME)]
        self.guests = {}            #: models of which this one has links -> {link: whether it is touched}
        free = not (self.description.fixed or self.description.jointed or self.description.cameras or
                    self.description.devices or self.description.weightless)
        self.thing = described(robot, name) if free else None  #: what it is as a solid of its host
        self.alone = False          #: it has none, and is to have none
        self.host = None            #: name of the model that simulates this one
        self._places = {}           #: of links: bytes of a pose, and what place_of makes of it
        self.settings, self._lifts, self.loaded = settings, {}, {}
        self.placed = lambda thrown: None  #: called when the model was put somewhere else, at rest or not
        said = (*warnings, *self.description.warnings, *self._said, *self.simulation.warnings)
        self.warnings = [each for each in dict.fromkeys(said) if not each.endswith(OF_COLLISIONS)]
        for device in self.description.devices:
            if isinstance(device, DiffDrive):
                self._start_wheels(device)
        self._lift()

    def _lift(self):
        """Lets what holds the links up that gravity does not act on act from now on."""
        self._lifts = {link: (*(-self.mass_of(link).mass_kg * self._gravity), 0.0, 0.0, 0.0)
                       for link in self.links if link in self.description.lifted}
        if self._lifts:
            self.push({}, {})

    def push(self, links, joints):
        """Lets these forces from outside act from now on, dict of link -> (6,) and of joint -> effort."""
        lifts = {link: numpy.asarray(lift) + links.get(link, 0.0) for link, lift in self._lifts.items()}
        self.simulation.push({**links, **lifts}, joints)

    def remade(self, xml, settings):
        """A model like this one of another document of the same links and joints, in the same state.

        Raises:
            SpawnError: what is wrong with the document.  BadValueError: it cannot be in this state.
        """
        name, _, namespace, pose, X_MR, warnings = self.spawned
        made = Model(name, xml, namespace, pose, settings, self.begun_ns, X_MR, warnings)
        if not settings.ground and GROUND_PLANE["name"] in self.simulation.model_names:
            self.simulation.delete_model(GROUND_PLANE["name"])
        try:
            made.simulation.restore_state(self.simulation.save_state())
        except ArasError as error:
            raise BadValueError("model '%s' cannot be changed as it is now: %s" % (name, error)) from error
        seen = made.simulation.camera_names and settings.ground
        if seen and GROUND_PLANE["name"] not in made.simulation.model_names:  # it came back
            made.simulation.spawn_model(GROUND_PLANE)
        made._lift()
        return made

    def become(self, made):
        """Takes over what a model that was made of this one is; all who know this one know it from now on."""
        for key in ("spawned", "description", "simulation", "links", "thing", "_tree", "_gravity", "settings",
                    "_lifts"):
            setattr(self, key, getattr(made, key))
        self._places.clear()

    def _made(self, settings, pose):
        base = "floating"
        if self.description.fixed:
            base = "fixed" if self.description.jointed else "driven"  # one without joints can be placed anew
        gravity = (0.0, 0.0, 0.0) if self.description.weightless else settings.gravity_m_s2
        self._gravity = numpy.array(gravity)
        config = {"base": base, "idle_joints": "hold",
                  "compatibility": "gazebo", "period_s": settings.period_s, "command_timeout_s": 0.0,
                  "gravity_m_s2": list(gravity),
                  "base_pose": {"position_m": [float(each) for each in pose[:3, 3]],
                                "rpy_rad": [float(each) for each in rpy_of(pose)]}}
        floor_m = 0.0 if settings.ground else settings.floor_m
        if self.description.collides and self.moves:
            config["contacts"] = {"friction": GROUND_FRICTION, "frictions": self.description.frictions,
                                  "neighbours": True}
            if floor_m is not None:
                config["contacts"]["ground_plane"] = {"z_m": floor_m, "friction": GROUND_FRICTION}
        if self.description.cameras:
            config["scene"] = scene_of(settings)
        try:
            return self._made_with_self_contacts(config) or Simulation(self.description.urdf, config, {})
        except ArasError as error:
            raise SpawnError("SpawnModel: model '%s' cannot be simulated: %s" % (self.name, error)) from error

    def _made_with_self_contacts(self, config):
        """The simulation if some links touch each other, else None."""
        pairs = self_pairs(ElementTree.fromstring(self.description.urdf), self.description.self_collides)
        if not pairs or "contacts" not in config:
            return None
        tried = {**config, "contacts": {**config["contacts"], "pairs": pairs}}
        tried.pop("scene", None)
        without = overlapping(Simulation(self.description.urdf, tried, {}), pairs)
        self._said += ["links %s and %s are in each other where the model begins: they do not touch each other" %
                       tuple(pair) for pair in without]
        config["contacts"]["pairs"] = [pair for pair in pairs if pair not in without]
        return Simulation(self.description.urdf, config, {})

    def load_controller(self, name, parameters, kind=""):
        """Loads a controller, which is called one of this kind. Returns lines of what is ignored. Raises: ArasError."""
        warnings = self.simulation.load_controller(name, parameters)
        self.loaded[name] = [parameters, kind or parameters["type"]]
        return warnings

    def unload_controller(self, name):
        """Raises: ArasError."""
        self.simulation.unload_controller(name)
        self.loaded.pop(name, None)

    def begin_anew(self, settings, now_ns):
        """A new simulation with other settings, in which the joints rest where they are and the base goes on; the
        controllers that were loaded and running are so again."""
        before, running = self.simulation, [each["name"] for each in self.simulation.loaded_controllers()
                                            if each["state"] == "running"]
        name, xml, namespace, pose, X_MR, warnings = self.spawned
        made = Model(name, xml, namespace, pose, settings, now_ns, X_MR, warnings)
        if not self.description.fixed or not self.description.jointed:
            free = not self.description.fixed
            made.simulation.set_base(before.base_pose, rotated(self.link_pose(self.root), before.link_twist(self.root))
                                     if free and self.links else numpy.zeros(6))
        if self.description.jointed:
            made.simulation.set_joint_positions(dict(zip(before.joint_names, before.joint_positions)))
        there = {each["name"] for each in made.simulation.loaded_controllers()}
        for controller, (parameters, _) in self.loaded.items():
            made.simulation.load_controller(controller, parameters)
        made.simulation.switch_controllers([each for each in running if each in self.loaded and each not in there], [],
                                           True)
        self.begun_ns = now_ns
        self.become(made)

    def _start_wheels(self, drive):
        """Lets motors turn the wheels of a drive from now on, with no speed at first."""
        names = []
        for joint in drive.joints():
            names.append(wheel_motor(joint))
            self.simulation.load_controller(names[-1], {"type": "velocity_controllers/JointVelocityController",
                                                        "joint": joint})
        self.simulation.switch_controllers(names, [], True)

    def turn_wheels(self, drive, speeds_rad_s):
        """Speeds of the left and the right wheel from now on."""
        for joint, speed in zip(drive.joints(), speeds_rad_s):
            self.simulation.set_controller_command(wheel_motor(joint), float(speed))

    # --- state

    @property
    def gravity_m_s2(self):
        """(3,), as it acts on the model."""
        return self._gravity

    def gravity_acts_on(self, link):
        """Whether it would fall, were there any gravity."""
        return not self.description.weightless and link not in self.description.lifted

    @property
    def root(self):
        """Name of the link whose pose is the model's."""
        return self.links[0] if self.links else "world"

    def pose(self):
        """X_WM, (4, 4)."""
        return self.simulation.base_pose @ numpy.linalg.inv(self._X_MR)

    def link_pose(self, link):
        """X_WL, (4, 4). Raises: UnknownEntityError."""
        if link not in self.links:
            raise UnknownEntityError("link '%s' of model '%s' does not exist" % (link, self.name))
        return self.simulation.link_pose(link)

    def link_twist(self, link):
        """(6,), [v; w] in world axes."""
        pose = self.link_pose(link)
        return rotated(pose, self.simulation.link_twist(link))

    def twist(self):
        return self.link_twist(self.root) if self.links else numpy.zeros(6)

    def place(self, pose, twist):
        """Puts the model somewhere else, with a twist [v; w] in world axes.

        Raises: BadValueError: numbers that are not finite, or the model has joints and is fixed in the world.
        """
        try:
            self.simulation.set_base(pose @ self._X_MR, twist)
        except ArasError as error:
            raise BadValueError("model '%s': %s" % (self.name, error)) from error
        self.placed(bool(numpy.any(twist)))

    def set_joints(self, positions):
        """Places joints, dict of name -> [m or rad], at rest. Raises: BadValueError, UnknownEntityError."""
        try:
            self.simulation.set_joint_positions(positions)
        except ArasError as error:
            raise BadValueError(str(error)) from error

    def touches(self, other):
        """Whether this model moves and comes to rest on another one, which is fixed."""
        return self.moves and self.description.collides and other.description.collides and not other.moves

    @property
    def moves(self):
        return not self.description.fixed or self.description.jointed

    def solid(self, link, seen, touched):
        """A link of this model as a solid of another one's simulation, None if there is nothing of it to be had.

        Args:
            seen, touched: what the other one has of it.
        """
        return solid_of(self._tree, link, "%s::%s" % (self.name, link), seen, touched)

    def place_of(self, link):
        """Position (3,) and quaternion (4,) of a link. Many cameras ask for it at the same time."""
        pose = self.simulation.link_pose(link)
        known = self._places.get(link)
        if known is None or known[0] != pose.tobytes():
            known = self._places[link] = pose.tobytes(), pose[:3, 3], quaternion_of(pose)
        return known[1:]

    # --- what stands in the description

    def element_of(self, link):
        """The <link> of a name. Raises: UnknownEntityError."""
        self.link_pose(link)
        return next(each for each in self._tree.findall("link") if each.get("name") == link)

    def mass_of(self, link):
        """Mass of a link. Raises: UnknownEntityError."""
        return mass_of(self.element_of(link))

    def centre_of_mass(self, link):
        """(3,), in the world."""
        return (self.link_pose(link) @ (*self.mass_of(link).com_m, 1.0))[:3]

    def radius_of(self, link):
        """Of the cylinder or sphere that the link collides with; None: it is no such thing."""
        for shape in ("cylinder", "sphere"):
            found = self._tree.find("link[@name='%s']/collision/geometry/%s" % (link, shape))
            if found is not None:
                return float(found.get("radius"))
        return None

    def damping_of(self, joint):
        """[N s/m or N m s/rad]."""
        dynamics = self._tree.find("joint[@name='%s']/dynamics" % joint)
        return 0.0 if dynamics is None else float(dynamics.get("damping", 0.0))

    # --- time

    def step(self, ticks):
        self.simulation.step(ticks)

    def time_s(self, world_ns):
        """The simulation's own time at a time of the world [s]."""
        return 1e-9 * (world_ns - self.begun_ns)

    def reset(self, world_ns, to_start):
        """Everything back to where it was spawned; `to_start`: its time too."""
        if to_start:
            self.begun_ns = 0
            self.simulation.reset()
        else:
            self.simulation.reset_world()
        if self._lifts:
            self.push({}, {})


def scene_of(settings):
    """Section sim/scene of a model with cameras: the ground, the sky and the light from everywhere."""
    scene, known = {"solids": [GROUND_PLANE]} if settings.ground else {}, WorldSettings()
    if settings.background_rgb != known.background_rgb:
        scene["background_rgb"] = list(settings.background_rgb)
    if settings.ambient_rgb != known.ambient_rgb:
        scene["lighting"] = {"ambient_rgb": list(settings.ambient_rgb), "lights": [SUN]}
    return scene
