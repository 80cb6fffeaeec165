"""A simulated robot whose parameters are numbers, and which replays the commands of a recording."""

from dataclasses import dataclass, replace
from typing import Any, Dict, List, Optional, Tuple
from xml.etree import ElementTree

import numpy as np

from aras_visual_servo import ParameterError, Scenario, simulation_of
from .advice import LEAST_SPAN
from .recording import FEWEST_SAMPLES, Commands, Recording

#: The arm rests this long under its own weight before the first command. [s]
SETTLE_S = 1.0
#: The place where it rested is the mean of so long before the first command. [s]
REST_S = 0.5
#: A joint that rests nearer than this to its first command was told that before, too. [m or rad]
NEAR = 0.1
#: Joint states earlier than this after the first change of a command are not fitted: what moved before is not known,
#: nor on which side of their friction the joints rest. [s]
LEAD_S = 0.5
#: A command has changed if it differs from the first one by more than this part of the range of its values.
CHANGED = 0.01
#: Part of the recording, its end, that is not fitted.
HELD_OUT = 0.25
#: Length of the first part of the recording, with which a fit begins. [s]
FIRST_S = 8.0
#: Gains from which the fit of a joint without a PID starts: p by the effort limit [1/rad or 1/m], d by p [s].
P_PER_EFFORT, D_PER_P = 10.0, 0.05
#: A gain stays above this part of the model's, and the mass of the payload above this part of its range.
LEAST_GAIN, LEAST_MASS = 0.01, 1e-3
GRAVITY, DELAY = "gravity_scale", "command_delay_s"
PAYLOAD = ("payload.mass", "payload.first_x", "payload.first_y", "payload.first_z")
#: Distance of the payload from its link, for the ranges of its first moments. [m]
LEVER_M = 0.1
#: No payload is farther from its link, whatever a trial step makes of its first moments. [m]
FARTHEST_M = 10.0
#: End of the name of what is fitted too and is not the robot's: where a joint's set point was at first.
START = ".start"
#: Ends of the names of what static friction adds to Coulomb friction, and of the speed over which it fades.
STRIBECK, FADES = ".stribeck", ".stribeck_velocity"
#: That speed is at least this part of the one it starts from.
LEAST_FADES = 0.05
EARTH = (0.0, 0.0, -9.81)
PID = ("p", "i", "d")
#: Units of p, i and d after that of the effort, by what the loop controls; {0} is that of the joint's position.
PID_UNITS = {"position": ("/{0}", "/({0} s)", " s/{0}"), "velocity": (" s/{0}", "/{0}", " s²/{0}")}


@dataclass(frozen=True)
class Parameter:
    """A parameter of the simulated robot.

    Attributes:
        name.  unit.  start: value of the model.  range: how far from it the truth may reasonably be.
        least: bound of the value.
    """

    name: str
    unit: str
    start: float
    range: float
    least: float = 0.0


def period_of(scenario: Scenario) -> float:
    """Returns the period of the scenario's simulation [s]."""
    return float(scenario.sim.get("period_s", 1e-3))


def with_default_loops(scenario: Scenario) -> Scenario:
    """Returns the scenario with a PID, from which a fit can start, at each joint whose controller has none.

    Without a PID a simulated joint follows its commands whatever its friction.
    """
    joints = ElementTree.fromstring(scenario.urdf_xml()).findall("joint")
    limits = {joint.get("name"): joint.find("limit") for joint in joints}
    loops = dict((scenario.robot.get("dynamics") or {}).get("loops", {}))
    for section in scenario.controllers().values():
        if isinstance(section, dict) and section.get("joint") in limits and not section.get("pid"):
            limit = limits[section["joint"]]
            effort, speed = (1.0 if limit is None else float(limit.get(key, 0.0)) or 1.0
                             for key in ("effort", "velocity"))
            if section["type"].endswith("JointPositionController"):
                loops[section["joint"]] = {"p": P_PER_EFFORT * effort, "d": D_PER_P * P_PER_EFFORT * effort}
            elif section["type"].endswith("JointVelocityController"):
                loops[section["joint"]] = {"p": P_PER_EFFORT * effort / speed}
    dynamics = {**(scenario.robot.get("dynamics") or {}), **({"loops": loops} if loops else {})}
    return replace(scenario, robot={**scenario.robot, "dynamics": dynamics}) if dynamics else scenario


class ReplayedRobot:
    """The robot of a scenario with parameters, beside a recording of it.

    Attributes:
        parameters: k `Parameter`.  names: m joints of the recording.  period_s: of the simulation.
        velocity_loops: joints whose controllers control velocity.
        start_s: stamp of the first command.
        used: rows of the recording that are compared.  fit: those of them that are fitted.  first: those at the
        beginning.
    Args: stribeck: speeds [m/s or rad/s] over which static friction fades, of the joints that have it beside Coulomb
    friction; those of the model have it, too.
    Raises: ParameterError: what `identify_twin` says.
    """

    def __init__(self, recording: Recording, scenario: Scenario, payload_link: Optional[str] = None,
                 stribeck: Optional[Dict[str, float]] = None) -> None:
        self.names, self._link = recording.joint_names, payload_link
        scenario = with_default_loops(scenario)
        self._recording, self._stribeck = recording, stribeck or {}
        # Cameras and the scene take time and move no joint.
        self._scenario = replace(scenario, sim={**{key: value for key, value in scenario.sim.items()
                                                   if key not in ("scene", "contacts", DELAY)}, "cameras": []})
        self.period_s = period_of(scenario)
        self._gravity = np.array(scenario.sim.get("gravity_m_s2", EARTH), dtype=float)
        self._loops = {section["joint"]: section["pid"] for section in scenario.controllers().values()
                       if isinstance(section, dict) and "pid" in section and "joint" in section}
        self._placed = [section["joint"] for section in scenario.controllers().values() if isinstance(section, dict)
                        and section.get("joint") in self.names and section["type"].endswith("JointPositionController")]
        self.velocity_loops = {section["joint"] for section in scenario.controllers().values()
                               if isinstance(section, dict) and "joint" in section
                               and section["type"].endswith("JointVelocityController")}
        urdf = ElementTree.fromstring(scenario.urdf_xml())
        faults = self._faults(recording, urdf)
        if faults:
            raise ParameterError(faults)
        self._order: Optional[List[int]] = None
        assert recording.commands is not None  # or it is a fault
        commands = recording.commands
        stamps = commands.times_s
        self.start_s = stamps[0]
        used = np.nonzero(recording.times_s >= _moves_at(commands) + LEAD_S)[0]
        self.used, self.fit = used, used[:int(round(len(used) * (1.0 - HELD_OUT)))]
        self.first = self.fit[:max(int(FIRST_S / recording.period_s), FEWEST_SAMPLES)]
        before = (recording.times_s <= stamps[0]) & (recording.times_s > stamps[0] - REST_S)
        self._rest = recording.position[before].mean(axis=0) if np.any(before) else recording.position[0]
        #: Where the joints were told to be before: velocities are integrated from a set point that no message tells.
        first = commands.values[0] if commands.kind == "position" else self._rest
        self._told_before = np.where(np.abs(first - self._rest) < NEAR, first, self._rest)
        self._limits = {joint.get("name"): [float(limit.get(key, 0.0)) for key in ("lower", "upper")]
                        for joint in urdf.findall("joint") for limit in joint.findall("limit")
                        if joint.get("type") in ("revolute", "prismatic")}
        self.parameters = self._parameters(urdf)

    def _faults(self, recording, urdf):
        faults = []
        moving = {joint.get("name") for joint in urdf.findall("joint") if joint.get("type") != "fixed"}
        strange = [name for name in self.names if name not in moving]
        if strange:
            faults.append(f"joint_names: found {', '.join(strange)}, allowed {', '.join(sorted(moving))}")
        links = [link.get("name") for link in urdf.findall("link")]
        if self._link is not None and self._link not in links:
            faults.append(f"payload_link: found {self._link}, allowed {', '.join(links)}")
        if not any(name in self._loops for name in self.names) and not strange:
            faults.append("controllers: found no joint with a PID, allowed one or more: a loop without one follows its "
                          "commands whatever the friction")
        if recording.commands is None:
            faults.append("commands: found none, allowed positions or velocities of all joints")
        else:
            late = int(np.count_nonzero(recording.times_s >= _moves_at(recording.commands) + LEAD_S))
            if late < FEWEST_SAMPLES:
                faults.append(f"times_s: found {late} joint states later than {LEAD_S} s after the first change of a "
                              f"command, allowed at least {FEWEST_SAMPLES}")
        if np.all(np.ptp(recording.position, axis=0) <= LEAST_SPAN):
            faults.append(f"position: found motions of at most {np.ptp(recording.position, axis=0).max():.2g}, allowed "
                          f"more than {LEAST_SPAN} m or rad of one joint")
        return faults

    def _parameters(self, urdf):
        found, joints = [], {joint.get("name"): joint for joint in urdf.findall("joint")}
        for name in (name for name in self.names if name in self._loops):
            force, place = ("N", "m") if joints[name].get("type") == "prismatic" else ("N m", "rad")
            dynamics, limit = ({} if node is None else node.attrib
                               for node in (joints[name].find(tag) for tag in ("dynamics", "limit")))
            effort, speed = float(limit.get("effort", 0.0)) or 10.0, float(limit.get("velocity", 0.0)) or 1.0
            damping, friction = (float(dynamics.get(key, 0.0)) for key in ("damping", "friction"))
            found += [Parameter(f"{name}.damping", f"{force} s/{place}", damping,
                                max(0.05 * effort / speed, 0.2 * float(self._loops[name].get("d", 0.0)), damping)),
                      Parameter(f"{name}.friction", force, friction,
                                max(0.05 * effort, friction))]
            static, fades = (float(dynamics.get(key, 0.0)) for key in ("static_friction", "stribeck_velocity"))
            if static or name in self._stribeck:
                fades = fades or self._stribeck[name]
                found += [Parameter(name + STRIBECK, force, max(static - friction, 0.0), found[-1].range),
                          Parameter(name + FADES, f"{place}/s", fades, fades, LEAST_FADES * fades)]
            gains = {key: float(self._loops[name][key]) for key in PID if self._loops[name].get(key)}
            units = dict(zip(PID, PID_UNITS["velocity" if name in self.velocity_loops else "position"]))
            found += [Parameter(f"{name}.{key}", force + units[key].format(place), gain, gain, LEAST_GAIN * gain)
                      for key, gain in gains.items()]
        found += [Parameter(GRAVITY, "1", 1.0, 0.3), Parameter(DELAY, "s", 0.0, 0.05, -0.05)]
        if self._recording.commands.kind == "velocity":
            found += [Parameter(name + START, "m or rad", rest, 0.02, -np.inf)
                      for name, rest in zip(self.names, self._rest.tolist())]
        if self._link is not None:
            masses = [float(mass.get("value", 0.0)) for mass in urdf.iter("mass")]
            range_kg = 0.1 * sum(masses)
            # Gravity is linear in the first moments. In the position it is not: the valley of the cost would be bent
            # where the mass is known badly, and the covariance would not describe it.
            # A small mass far away has a large inertia: fits that begin with one may end at the bound of the mass.
            found.append(Parameter(PAYLOAD[0], "kg", 0.5 * range_kg, range_kg, LEAST_MASS * range_kg))
            found += [Parameter(name, "kg m", 0.0, LEVER_M * range_kg, -np.inf) for name in PAYLOAD[1:]]
        return found

    def overlay(self, values: Dict[str, float]) -> Dict[str, Any]:
        """The part of a scenario that has these values by name; those left out stay as they are."""
        loops = {name: {**{key: float(pid[key]) for key in (*PID, "i_clamp") if pid.get(key)},
                        **{key: values[f"{name}.{key}"] for key in PID if f"{name}.{key}" in values}}
                 for name, pid in self._loops.items() if any(f"{name}.{key}" in values for key in PID)}
        dynamics: Dict[str, Any] = {key: {name: values[f"{name}.{key}"] for name in self.names
                                          if f"{name}.{key}" in values} for key in ("damping", "friction")}
        dynamics["static_friction"] = {name: values[f"{name}.friction"] + values[name + STRIBECK] for name in self.names
                                       if name + STRIBECK in values}
        dynamics["stribeck_velocity"] = {name: values[name + FADES] for name in dynamics["static_friction"]}
        dynamics["loops"] = loops
        if PAYLOAD[0] in values:
            mass = values[PAYLOAD[0]]
            dynamics["payload"] = {"link": self._link, "mass_kg": mass,
                                   "position_m": [float(np.clip(values.get(name, 0.0) / mass, -FARTHEST_M, FARTHEST_M))
                                                  for name in PAYLOAD[1:]]}
        section = {"robot": {"dynamics": {key: value for key, value in dynamics.items() if value}}, "sim": {}}
        if GRAVITY in values:
            section["sim"]["gravity_m_s2"] = (values[GRAVITY] * self._gravity).tolist()
        return section

    def _values(self, x: np.ndarray) -> Dict[str, float]:
        """Values by name; a trial step may put a set point beyond the joint's limits, where no joint begins."""
        values = {each.name: float(value) for each, value in zip(self.parameters, x)}
        values.update({name + START: float(np.clip(values[name + START], *limits))
                       for name, limits in self._limits.items() if name + START in values})
        return values

    def as_scenario(self, x: np.ndarray) -> Scenario:
        """The scenario without cameras, with these values of the parameters."""
        values = self._values(x)
        section = self.overlay(values)
        return replace(self._scenario, robot={**self._scenario.robot, "dynamics": {
            **(self._scenario.robot.get("dynamics") or {}), **section["robot"]["dynamics"]}},
            sim={**self._scenario.sim, **section["sim"],
                 "initial_positions": {**self._scenario.sim.get("initial_positions", {}),
                                       **{name: rest if name in self._placed else values.get(name + START, rest)
                                          for name, rest in zip(self.names, self._rest.tolist())}}})

    def replay(self, x: np.ndarray, rows: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
        """Positions and velocities, (k, m) each, at the stamps of these rows, with these values of the parameters."""
        values = self._values(x)
        sim = simulation_of(self.as_scenario(x))
        if self._order is None:
            there = list(sim.joint_names)
            self._order = [there.index(name) for name in self.names]
        period = sim.period_ns * 1e-9
        if self._placed:
            told_before = dict(zip(self.names, self._told_before.tolist()))
            sim.set_command(position={name: values.get(name + START, told_before[name]) for name in self._placed})
        sim.step(int(round(SETTLE_S / period)))
        commands = self._recording.commands
        told = np.floor((commands.times_s - self.start_s) / period + 0.5).astype(int)  # .5 always up: one a tick
        wanted = (self._recording.times_s[rows] - self.start_s - values[DELAY]) / period
        asked = np.maximum(np.floor(wanted).astype(int), 0)
        ticks = np.union1d(asked, asked + 1)
        q, v = np.empty((2, len(ticks), len(self.names)))
        # A command acts from the step after its stamp. At one tick the state is read first.
        events = sorted([(tick, 0, k) for k, tick in enumerate(ticks.tolist())] +
                        [(tick, 1, i) for i, tick in enumerate(told.tolist()) if tick <= ticks[-1]])
        at = 0
        for tick, is_command, i in events:
            sim.step(tick - at)
            at = tick
            if is_command:
                sim.set_command(**{commands.kind: dict(zip(self.names, commands.values[i].tolist()))})
            else:
                q[i], v[i] = sim.joint_positions[self._order], sim.joint_velocities[self._order]
        # Between two ticks both are straight. Otherwise velocities would jump with the delay, and so would the cost.
        before = np.searchsorted(ticks, asked)
        part = np.maximum(wanted - asked, 0.0)[:, None]
        at_stamps = [each[before] + part * (each[before + 1] - each[before]) for each in (q, v)]
        return at_stamps[0], at_stamps[1]

    def residual(self, x: np.ndarray, rows: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """(channels, n) of weighted differences: of all positions, then of velocities if there are weights for them."""
        q, v = self.replay(x, rows)
        channels = [self._recording.position[rows] - q]
        if len(weights) > len(self.names):
            assert self._recording.velocity is not None
            channels.append(self._recording.velocity[rows] - v)
        return np.hstack(channels).T * weights[:, None]


def _moves_at(commands: Commands) -> float:
    """Stamp of the first command that differs from the first one; of the first one if all are equal."""
    changes = np.abs(commands.values - commands.values[0]) > CHANGED * np.ptp(commands.values, axis=0)
    return float(commands.times_s[np.argmax(np.any(changes, axis=1))])
