"""Flying robots, as bodies that are pushed: the motor model and the odometry of RotorS, and the velocity interface of
Hector's quadrotor. Formulas and keys of the motor are those of gazebo_motor_model.cpp of rotors_gazebo_plugins."""
import dataclasses
import math
import typing
import xml.etree.ElementTree as ElementTree

import numpy

from ..devices import Device, joined, named, number, reads, text

if typing.TYPE_CHECKING:
    from ..model import Model


@dataclasses.dataclass(frozen=True)
class RotorMotor(Device):
    """A rotor: thrust, drag and moments of its speed, which follows the command with a delay."""
    joint: str
    link: str
    number: int               #: its place in the commands
    turn: float               #: 1: counter-clockwise, -1: clockwise, seen from above
    up_s: float               #: time constant of the speed while it grows
    down_s: float             #: and while it falls
    fastest_rad_s: float
    thrust_n_s2: float        #: motorConstant: thrust by the square of the speed
    moment_m: float           #: momentConstant: torque by thrust
    drag_n_s2_m: float        #: rotorDragCoefficient
    rolling: float            #: rollingMomentCoefficient
    slowdown: float           #: the joint turns more slowly by this
    topics: tuple             #: of commands
    speed_topic: str          #: of the motor's speed
    rate_hz: float = 250.0    #: of new forces
    torque_n_m: float = 1.0   #: of the motor that turns the joint

    def joints(self) -> typing.Tuple[str, ...]:
        return (self.joint,)

    def links(self) -> typing.Tuple[str, ...]:
        return (self.link,)

    def motors(self) -> typing.Tuple[str, ...]:
        return (self.joint,)

    def speed(self, before_rad_s: float, wanted_rad_s: float, dt_s: float) -> float:
        """Returns the rotor's speed after a time, a filter of first order towards the command [rad/s]."""
        wanted = min(max(wanted_rad_s, 0.0), self.fastest_rad_s)
        delay = self.up_s if wanted > before_rad_s else self.down_s
        return wanted + (before_rad_s - wanted) * math.exp(-dt_s / delay) if delay > 0.0 else wanted

    def wrench(self, model: "Model", speed_rad_s: float) -> numpy.ndarray:
        """Returns (6,), [f; tau] of a speed in world axes at the rotor's centre of mass [N; N m]."""
        axes, velocity = model.link_pose(self.link)[:3, :3], model.link_twist(self.link)[:3]
        thrust = self.thrust_n_s2 * speed_rad_s ** 2
        across = velocity - (velocity @ axes[:, 2]) * axes[:, 2]
        force = thrust * axes[:, 2] - speed_rad_s * self.drag_n_s2_m * across
        torque = -self.turn * thrust * self.moment_m * axes[:, 2] - speed_rad_s * self.rolling * across
        return numpy.concatenate((force, torque))


@reads("librotors_gazebo_motor_model.so")
def rotor_motor(plugin: ElementTree.Element, _sensor: typing.Optional[ElementTree.Element], _link: str,
                namespace: str) -> RotorMotor:
    """Reads the tag."""
    command = text(plugin, "commandSubTopic", "gazebo/command/motor_speed")
    return RotorMotor(
        text(plugin, "jointName"), text(plugin, "linkName"), int(number(plugin, "motorNumber", 0)),
        -1.0 if text(plugin, "turningDirection", "cw") == "cw" else 1.0, number(plugin, "timeConstantUp", 0.0125),
        number(plugin, "timeConstantDown", 0.025), number(plugin, "maxRotVelocity", 838.0),
        number(plugin, "motorConstant", 8.54858e-06), number(plugin, "momentConstant", 0.016),
        number(plugin, "rotorDragCoefficient", 1.0e-4), number(plugin, "rollingMomentCoefficient", 1.0e-6),
        number(plugin, "rotorVelocitySlowdownSim", 10.0) or 1.0,
        tuple(dict.fromkeys((named(namespace, command), joined(namespace, "command/motor_speed")))),
        named(namespace, text(plugin, "motorSpeedPubTopic", text(plugin, "motorVelocityPubTopic", "motor_speed"))))


@dataclasses.dataclass(frozen=True)
class RotorsOdometry(Device):
    """The pose of a link in the world, and its twist in its own axes."""
    link: str
    topic: str
    frame: str
    child_frame: str
    rate_hz: float

    def links(self) -> typing.Tuple[str, ...]:
        return (self.link,)


@reads("librotors_gazebo_odometry_plugin.so")
def rotors_odometry(plugin: ElementTree.Element, _sensor: typing.Optional[ElementTree.Element], _link: str,
                    namespace: str) -> RotorsOdometry:
    """Reads the tag; noise, delay and the transforms are left out."""
    link = text(plugin, "linkName")
    return RotorsOdometry(link, named(namespace, text(plugin, "odometryTopic", "odometry")),
                          text(plugin, "parentFrameId", "world"), text(plugin, "childFrameId", link),
                          min(200.0, 1000.0 / max(1.0, number(plugin, "measurementDivisor", 1.0))))


@dataclasses.dataclass(frozen=True)
class VelocityFlight(Device):
    """A body that hovers level and takes the velocity it is told, in its own heading."""
    topic: str
    rate_hz: float = 100.0
    delay_s: float = 0.1      #: time constant with which the velocity follows

    def fly(self, model: "Model", linear_m_s: numpy.ndarray, turn_rad_s: float, dt_s: float) -> None:
        """Moves the body on: it holds its weight, stays level, and its velocity nears what is wanted. Raises:
        ArasError: the model is fixed and has joints."""
        for link in model.links:
            mass_kg = model.properties_of(link).mass_kg
            if mass_kg > 0.0:
                model.thrust(link, (*(-mass_kg * model.gravity_m_s2), 0.0, 0.0, 0.0))
        pose, twist = model.pose(), model.twist()
        yaw = math.atan2(pose[1, 0], pose[0, 0])
        heading = numpy.array(((math.cos(yaw), -math.sin(yaw), 0.0), (math.sin(yaw), math.cos(yaw), 0.0), (0, 0, 1.0)))
        share = 1.0 - math.exp(-dt_s / self.delay_s)
        level = pose.copy()
        level[:3, :3] = heading
        wanted = numpy.concatenate((heading @ linear_m_s, (0.0, 0.0, turn_rad_s)))
        model.place(level, twist + share * (wanted - twist))


@reads("libhector_gazebo_quadrotor_simple_controller.so", "libhector_quadrotor_simple_controller.so")
def velocity_flight(plugin: ElementTree.Element, _sensor: typing.Optional[ElementTree.Element], _link: str,
                    namespace: str) -> VelocityFlight:
    """Reads the tag; gains and limits of the attitude are left out."""
    return VelocityFlight(named(namespace, text(plugin, "topicName", "cmd_vel")))
