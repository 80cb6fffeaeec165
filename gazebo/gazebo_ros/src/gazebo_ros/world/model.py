"""One model of the world: a robot, or any other thing that a URDF describes."""
import xml.etree.ElementTree as ElementTree

import numpy

from aras_visual_servo_sim import ArasError, Simulation

from .description import mass_of, read_description
from .devices import DiffDrive
from .errors import BadValueError, SpawnError, UnknownEntityError
from .poses import quaternion_of, rpy_of, rotated


#: What cameras see of Gazebo's ground plane: 100 m wide, of its material Gazebo/Grey, which casts no shadow.
GROUND_PLANE = {"name": "ground_plane", "box_m": [100.0, 100.0, 0.01], "position_m": [0.0, 0.0, -0.005],
                "color_rgb": [178.5] * 3,
                "material": {"ambient_share": 0.3 / 0.7, "specular_rgb": [2.55] * 3, "shininess": 1.5,
                             "casts_shadows": False}}


#: Coulomb's coefficient of a link that states none, as in Gazebo; of two that touch, the smaller one counts.
GROUND_FRICTION = 1.0


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
    """

    def __init__(self, name, xml, namespace, pose, settings, begun_ns):
        """
        Args:
            pose: X_WB, (4, 4), of the root link.
            settings: WorldSettings.
        Raises:
            SpawnError: everything that is wrong with the URDF.
        """
        self.name, self.namespace, self.begun_ns = name, namespace, begun_ns
        self.description = read_description(xml, namespace, name)
        self.simulation = self._made(settings, pose)
        robot = self._tree = ElementTree.fromstring(self.description.urdf)
        self.links = [link.get("name") for link in robot.findall("link") if link.get("name") != "world"]
        self.drawn_links = [link.get("name") for link in robot.findall("link") if link.find("visual") is not None]
        self.warnings = list(self.description.warnings) + list(self.simulation.warnings)
        for device in self.description.devices:
            if isinstance(device, DiffDrive):
                self._start_wheels(device)

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
        if settings.ground and self.description.collides and not self.description.fixed:
            config["contacts"] = {"ground_plane": {"friction": GROUND_FRICTION},
                                  "frictions": self.description.frictions}
        if settings.ground and self.description.cameras:
            config["scene"] = {"solids": [GROUND_PLANE]}
        try:
            return Simulation(self.description.urdf, config, {})
        except ArasError as error:
            raise SpawnError("SpawnModel: model '%s' cannot be simulated: %s" % (self.name, error)) from error

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

    @property
    def root(self):
        """Name of the link whose pose is the model's."""
        return self.links[0] if self.links else "world"

    def pose(self):
        """X_WB, (4, 4)."""
        return self.simulation.base_pose

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
            self.simulation.set_base(pose, twist)
        except ArasError as error:
            raise BadValueError("model '%s': %s" % (self.name, error)) from error

    def set_joints(self, positions):
        """Places joints, dict of name -> [m or rad], at rest. Raises: BadValueError, UnknownEntityError."""
        try:
            self.simulation.set_joint_positions(positions)
        except ArasError as error:
            raise BadValueError(str(error)) from error

    def one_link(self, name):
        """A URDF of one link alone, for the scene of another model."""
        alone = ElementTree.Element("robot", name=name)
        alone.extend(each for each in self._tree if each.tag == "material" or
                     each.tag == "link" and each.get("name") == name or
                     each.tag == "gazebo" and each.get("reference") == name and
                     any(each.find(tag) is not None for tag in ("material", "light")))
        return ElementTree.tostring(alone, encoding="unicode")

    @staticmethod
    def quaternion(pose):
        return quaternion_of(pose)

    # --- what stands in the description

    def mass_of(self, link):
        """Mass of a link. Raises: UnknownEntityError."""
        self.link_pose(link)
        return mass_of(next(each for each in self._tree.findall("link") if each.get("name") == link))

    def centre_of_mass(self, link):
        """(3,), in the world."""
        return (self.link_pose(link) @ (*self.mass_of(link).com_m, 1.0))[:3]

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
