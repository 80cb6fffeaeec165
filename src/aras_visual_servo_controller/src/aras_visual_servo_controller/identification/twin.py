"""Fits the simulator's own parameters of a robot, so that its simulated joints repeat a recording.

The output error of the whole simulation is minimised (Ljung, System Identification, 2nd edition, 1999, section 7.4):
noise of the joint states does not bias the parameters, as it does where differences of positions are regressors. The
loops keep the errors bounded, so that one simulation goes from the first command to the last.
"""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import Any, Dict, List, Optional, Sequence, Tuple
from xml.etree import ElementTree

import numpy as np

from aras_visual_servo import ParameterError, Scenario, simulation_of
from .advice import LEAST_SPAN, motion_for
from .estimates import HALF_95, Estimate, Identified, Unknown, covariance, not_told, separable
from .loops import add_state_delay
from .recording import FEWEST_SAMPLES, Recording

#: The arm rests this long under its own weight before the first command. [s]
SETTLE_S = 1.0
#: Joint states earlier than this after the first command are not fitted: what moved before is not known. [s]
LEAD_S = 0.5
#: Part of the recording, its end, that is not fitted.
HELD_OUT = 0.25
#: Longest delay of a command that is searched, and the steps of the search. [s]
LONGEST_DELAY_S, DELAY_STEP_S = 0.4, 0.004
#: Steps of the delay that are tried in every round. [s]
DELAY_STEPS_S = (-0.01, -0.005, -0.003, -0.002, -0.001, 0.001, 0.002, 0.003, 0.005, 0.01)
#: Differences of parameters for derivatives, as parts of their ranges.
STEP = 1e-3
#: The fit is held near the model by a prior of this many ranges; it matters only where the recording tells nothing.
PRIOR_RANGES = 10.0
#: Gains from which the fit of a joint without a PID starts: p by the effort limit [1/rad or 1/m], d by p [s].
P_PER_EFFORT, D_PER_P = 10.0, 0.05
#: A gain stays above this part of the model's.
LEAST_GAIN = 0.01
#: Most iterations with a first part of the recording, which is this long, and with all of it.
FIRST_S, FIRST_ROUNDS, ROUNDS = 8.0, 20, 8
#: Longest step of a parameter in ranges, and trials of shorter ones.
MOST_STEP, TRIALS = 2.0, 8
#: The fit has converged when no parameter moves by more than this part of its standard deviation.
SETTLED = 0.1
#: Residuals may be correlated over this many samples.
LAGS = 3
#: Parameters that correlate more than this cannot be told apart.
MOST_CORRELATION = 0.97
GRAVITY, DELAY, PAYLOAD = "gravity_scale", "command_delay_s", ("payload.mass", "payload.x", "payload.y", "payload.z")
#: End of the name of what is fitted too and is not the robot's: where a joint's set point was at first.
START = ".start"
EARTH = (0.0, 0.0, -9.81)
PID = ("p", "i", "d")


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


@dataclass(frozen=True)
class Twin:
    """A robot as a recording has it.

    Attributes:
        identified: estimates, unknown ones, and the residual of the positions by joint in the fitted part [m or rad].
        names: k parameters that were fitted.  covariance: (k, k) of these, in their units.
        overlay: the part of a scenario that makes it this robot.
        times_s: (k,) stamps of the joint states that were compared, from the first command on.
        measured, simulated: (k, m) positions [m or rad].  fitted: number of samples that were fitted; the others are
        held out.  joint_names: m names.
    """

    identified: Identified
    names: Tuple[str, ...]
    covariance: np.ndarray
    overlay: Dict[str, Any]
    joint_names: Tuple[str, ...]
    times_s: np.ndarray
    measured: np.ndarray
    simulated: np.ndarray
    fitted: int

    @property
    def held_out(self) -> Dict[str, float]:
        """Root mean square error of the positions by joint in the part that was not fitted [m or rad]."""
        error = (self.simulated - self.measured)[self.fitted:]
        return dict(zip(self.joint_names, np.sqrt(np.mean(error**2, axis=0)).tolist()))


def identify_twin(recording: Recording, scenario: Scenario, payload_link: Optional[str] = None,
                  threads: int = 2) -> Twin:
    """Returns the robot of a scenario as a recording has it.

    The names are `JOINT.damping`, `JOINT.friction` and gains `JOINT.p`, `.i`, `.d` of each joint with a PID loop,
    `gravity_scale`, `command_delay_s`, and with a payload_link `payload.mass` [kg] and `payload.x`, y, z [m] of a point
    mass in the frame of that link.

    Args: scenario: with the model of the robot and its controllers.  threads: that simulate at the same time.
    Raises: ParameterError: no commands, too short, other joints than the robot's, no PID loop, no motion.
    """
    model = _Model(recording, scenario, payload_link)
    found, weights = model.fitted(threads)
    return model.twin(found, weights, threads)


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


class _Model:
    def __init__(self, recording, scenario, payload_link):
        self._names, self._link = recording.joint_names, payload_link
        scenario = with_default_loops(scenario)
        self._recording = recording
        # Cameras and the scene take time and move no joint.
        self._scenario = replace(scenario, sim={**{key: value for key, value in scenario.sim.items()
                                                   if key not in ("scene", "contacts", DELAY)}, "cameras": []})
        self._period_s = float(scenario.sim.get("period_s", 1e-3))
        self._gravity = np.array(scenario.sim.get("gravity_m_s2", EARTH), dtype=float)
        self._loops = {section["joint"]: section["pid"] for section in scenario.controllers().values()
                       if isinstance(section, dict) and "pid" in section and "joint" in section}
        # Velocities are integrated from a set point that no message tells.
        self._placed = [section["joint"] for section in scenario.controllers().values() if isinstance(section, dict)
                        and section.get("joint") in self._names and section["type"].endswith("JointPositionController")
                        ] if recording.commands is not None and recording.commands.kind == "velocity" else []
        urdf = ElementTree.fromstring(scenario.urdf_xml())
        faults = self._faults(recording, urdf)
        if faults:
            raise ParameterError(faults)
        self._order: Optional[List[int]] = None
        stamps = recording.commands.times_s
        self._start = stamps[0]
        used = np.nonzero(recording.times_s >= stamps[0] + LEAD_S)[0]
        self._used, self._fit = used, used[:int(round(len(used) * (1.0 - HELD_OUT)))]
        self._first = self._fit[:max(int(FIRST_S / recording.period_s), FEWEST_SAMPLES)]
        before = recording.times_s <= stamps[0]
        self._rest = recording.position[before].mean(axis=0) if np.any(before) else recording.position[0]
        self.parameters = self._parameters(urdf)
        self._delay = [each.name for each in self.parameters].index(DELAY)
        self._ranges = np.array([each.range for each in self.parameters])
        self._least = np.array([each.least for each in self.parameters])

    def _faults(self, recording, urdf):
        faults = []
        moving = {joint.get("name") for joint in urdf.findall("joint") if joint.get("type") != "fixed"}
        strange = [name for name in self._names if name not in moving]
        if strange:
            faults.append(f"joint_names: found {', '.join(strange)}, allowed {', '.join(sorted(moving))}")
        links = [link.get("name") for link in urdf.findall("link")]
        if self._link is not None and self._link not in links:
            faults.append(f"payload_link: found {self._link}, allowed {', '.join(links)}")
        if not any(name in self._loops for name in self._names) and not strange:
            faults.append("controllers: found no joint with a PID, allowed one or more: a loop without one follows its "
                          "commands whatever the friction")
        if recording.commands is None:
            faults.append("commands: found none, allowed positions or velocities of all joints")
        else:
            late = int(np.count_nonzero(recording.times_s >= recording.commands.times_s[0] + LEAD_S))
            if late < FEWEST_SAMPLES:
                faults.append(f"times_s: found {late} joint states later than {LEAD_S} s after the first command, "
                              f"allowed at least {FEWEST_SAMPLES}")
        if np.all(np.ptp(recording.position, axis=0) <= LEAST_SPAN):
            faults.append(f"position: found motions of at most {np.ptp(recording.position, axis=0).max():.2g}, allowed "
                          f"more than {LEAST_SPAN} m or rad of one joint")
        return faults

    def _parameters(self, urdf):
        found, joints = [], {joint.get("name"): joint for joint in urdf.findall("joint")}
        for name in (name for name in self._names if name in self._loops):
            prismatic = joints[name].get("type") == "prismatic"
            dynamics, limit = ({} if node is None else node.attrib
                               for node in (joints[name].find(tag) for tag in ("dynamics", "limit")))
            effort, speed = float(limit.get("effort", 0.0)) or 10.0, float(limit.get("velocity", 0.0)) or 1.0
            damping, friction = (float(dynamics.get(key, 0.0)) for key in ("damping", "friction"))
            found += [Parameter(f"{name}.damping", "N s/m" if prismatic else "N m s/rad", damping,
                                max(0.05 * effort / speed, 0.2 * float(self._loops[name].get("d", 0.0)), damping)),
                      Parameter(f"{name}.friction", "N" if prismatic else "N m", friction,
                                max(0.05 * effort, friction))]
            gains = {key: float(self._loops[name][key]) for key in PID if self._loops[name].get(key)}
            found += [Parameter(f"{name}.{key}", "1", gain, gain, LEAST_GAIN * gain) for key, gain in gains.items()]
        found += [Parameter(GRAVITY, "1", 1.0, 0.3), Parameter(DELAY, "s", 0.0, 0.05, -0.05)]
        if self._recording.commands.kind == "velocity":
            found += [Parameter(name + START, "m or rad", rest, 0.02, -np.inf)
                      for name, rest in zip(self._names, self._rest.tolist())]
        if self._link is not None:
            masses = [float(mass.get("value", 0.0)) for mass in urdf.iter("mass")]
            found.append(Parameter(PAYLOAD[0], "kg", 0.01 * sum(masses), 0.1 * sum(masses), 1e-6))
            found += [Parameter(name, "m", 0.0, 0.2, -np.inf) for name in PAYLOAD[1:]]
        return found

    def overlay(self, values: Dict[str, float]) -> Dict[str, Any]:
        """The part of a scenario that has these values by name; those left out stay as they are."""
        loops = {name: {**{key: float(pid[key]) for key in (*PID, "i_clamp") if pid.get(key)},
                        **{key: values[f"{name}.{key}"] for key in PID if f"{name}.{key}" in values}}
                 for name, pid in self._loops.items() if any(f"{name}.{key}" in values for key in PID)}
        dynamics: Dict[str, Any] = {key: {name: values[f"{name}.{key}"] for name in self._names
                                          if f"{name}.{key}" in values} for key in ("damping", "friction")}
        dynamics["loops"] = loops
        if PAYLOAD[0] in values:
            dynamics["payload"] = {"link": self._link, "mass_kg": values[PAYLOAD[0]],
                                   "position_m": [values.get(name, 0.0) for name in PAYLOAD[1:]]}
        section = {"robot": {"dynamics": {key: value for key, value in dynamics.items() if value}}, "sim": {}}
        if GRAVITY in values:
            section["sim"]["gravity_m_s2"] = (values[GRAVITY] * self._gravity).tolist()
        return section

    def replay(self, x: np.ndarray, rows: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
        """Positions and velocities, (k, m) each, at the stamps of these rows, with these values of the parameters."""
        values = {each.name: float(value) for each, value in zip(self.parameters, x)}
        section = self.overlay(values)
        scenario = replace(self._scenario, robot={**self._scenario.robot, "dynamics": {
            **(self._scenario.robot.get("dynamics") or {}), **section["robot"]["dynamics"]}},
            sim={**self._scenario.sim, **section["sim"],
                 "initial_positions": {**self._scenario.sim.get("initial_positions", {}),
                                       **{name: values.get(name + START, rest)
                                          for name, rest in zip(self._names, self._rest.tolist())}}})
        sim = simulation_of(scenario)
        if self._order is None:
            there = list(sim.joint_names)
            self._order = [there.index(name) for name in self._names]
        period = sim.period_ns * 1e-9
        if self._placed:
            sim.set_command(position={name: values[name + START] for name in self._placed})
        sim.step(int(round(SETTLE_S / period)))
        commands = self._recording.commands
        told = np.round((commands.times_s - self._start) / period).astype(int)
        wanted = (self._recording.times_s[rows] - self._start - values[DELAY]) / period
        asked = np.maximum(np.round(wanted).astype(int), 0)
        q, v = np.empty((2, len(rows), len(self._names)))
        # A command acts from the step after its stamp. At one tick the state is read first.
        events = sorted([(tick, 0, k) for k, tick in enumerate(asked.tolist())] +
                        [(tick, 1, i) for i, tick in enumerate(told.tolist()) if tick <= asked[-1]])
        at = 0
        for tick, is_command, i in events:
            sim.step(tick - at)
            at = tick
            if is_command:
                sim.set_command(**{commands.kind: dict(zip(self._names, commands.values[i].tolist()))})
            else:
                q[i], v[i] = sim.joint_positions[self._order], sim.joint_velocities[self._order]
        return q + v * ((wanted - asked) * period)[:, None], v

    def residual(self, x, rows, weights):
        """(channels, k) of weighted differences: positions of all joints, then velocities if there are any."""
        q, v = self.replay(x, rows)
        error = self._recording.position[rows] - q
        channels = [error]
        if len(weights) > len(self._names):
            channels.append(self._recording.velocity[rows] - v)
        return np.hstack(channels).T * weights[:, None]

    def jacobian(self, x, rows, weights, now, pool):
        """(channels, k, parameters) of derivatives of the residual by parameters in units of their ranges."""
        def column(i):
            moved = x.copy()
            moved[i] += STEP * self._ranges[i]
            return (self.residual(moved, rows, weights) - now) / STEP
        return np.stack(list(pool.map(column, range(len(x)))), axis=-1)

    def fitted(self, threads):
        """(x, weights) of the fitted part.

        First of positions alone: far from the solution velocities ripple between two set points, and have many minima.
        """
        joints = len(self._names)
        x = np.array([each.start for each in self.parameters])
        x[self._delay] = self._first_delay(x)
        weights = np.ones(joints if self._recording.velocity is None else 2 * joints)
        with ThreadPoolExecutor(threads) as pool:
            x, _ = self._descend(x, self._first, weights[:joints], FIRST_ROUNDS, 1e-2, pool)
            return self._descend(x, self._fit, weights, ROUNDS, 1e-6, pool)

    def _first_delay(self, x):
        """Delay with which the model's positions fit best."""
        rows = self._first
        times, (q, _) = self._recording.times_s[rows], self.replay(x, rows)
        measured = self._recording.position[rows]

        def error(delay):
            late = np.column_stack([np.interp(times - delay, times, column) for column in q.T])
            apart = (late - measured)[times > times[0] + LONGEST_DELAY_S]
            return float(np.sum((apart - apart.mean(axis=0))**2 / np.var(measured, axis=0).clip(1e-12)))
        return min(np.arange(0.0, LONGEST_DELAY_S, DELAY_STEP_S).tolist(), key=error)

    def _descend(self, x, rows, weights, rounds, damping, pool):
        """Levenberg and Marquardt's method; weights of the channels follow the residuals, and their number chooses
        positions alone or velocities too."""
        start, unit = np.array([each.start for each in self.parameters]), np.ones_like(weights)
        plain = self.residual(x, rows, unit)
        for _ in range(rounds):
            x, plain = self._delayed(x, plain, rows, pool)
            weights = _weights(plain)
            now = plain * weights[:, None]
            J = self.jacobian(x, rows, weights, now, pool).reshape(-1, len(x))
            prior = (x - start) / self._ranges / PRIOR_RANGES
            H = J.T @ J + np.eye(len(x)) / PRIOR_RANGES**2
            g = J.T @ now.ravel() + prior / PRIOR_RANGES
            cost = float(np.sum(now**2) + prior @ prior)
            for _ in range(TRIALS):
                step = np.clip(-np.linalg.solve(H + damping * np.diag(np.diag(H)), g), -MOST_STEP, MOST_STEP)
                trial = np.maximum(x + step * self._ranges, self._least)
                new = self.residual(trial, rows, unit)
                prior = (trial - start) / self._ranges / PRIOR_RANGES
                if float(np.sum((new * weights[:, None])**2) + prior @ prior) < cost:
                    break
                damping *= 5.0
            else:
                return x, weights
            x, plain, damping = trial, new, max(damping / 10.0, 1e-9)
            inverse = np.linalg.inv(H)
            if np.all(np.abs(inverse @ g) < SETTLED * np.sqrt(np.diag(inverse))):
                break
        return x, _weights(plain)

    def _delayed(self, x, plain, rows, pool):
        """(x, residual) of the best delay nearby: set points that jump make its derivative hold for a period only."""
        weights = _weights(plain)
        trials = [x + step * (np.arange(len(x)) == self._delay) for step in DELAY_STEPS_S]
        found = list(pool.map(lambda trial: self.residual(trial, rows, np.ones(len(weights))), trials))
        costs = [float(np.sum((each * weights[:, None])**2)) for each in (plain, *found)]
        best = int(np.argmin(costs))
        return (x, plain) if best == 0 else (trials[best - 1], found[best - 1])

    def twin(self, x, weights, threads):
        """`Twin` of the fitted values."""
        rows = self._fit
        now = self.residual(x, rows, weights)
        with ThreadPoolExecutor(threads) as pool:
            J = self.jacobian(x, rows, weights, now, pool)
        flat = J.reshape(-1, len(x))
        inverse, null = separable(flat)
        groups = np.repeat(np.arange(len(now)), now.shape[1])
        cov = covariance(inverse, now.ravel(), groups, LAGS)
        # The simulator delays commands by whole periods.
        cov[self._delay, self._delay] += (self._period_s / self._ranges[self._delay])**2 / 12.0
        stddev = np.sqrt(np.diag(cov))
        names = [each.name for each in self.parameters]
        unknown = not_told(null, names)
        # The full covariance tells of directions that the recording tells badly, and which parameters share them.
        H = flat.T @ flat + 1e-12 * np.eye(len(x)) * np.trace(flat.T @ flat) / len(x)
        full = np.linalg.inv(H)
        spread = np.sqrt(np.diag(full))
        correlation = full / np.outer(spread, spread)
        for i, each in enumerate(self.parameters):
            if HALF_95 * max(stddev[i], spread[i] if each.name in unknown else 0.0) * each.range > max(
                    each.range, abs(x[i] - each.least) if np.isfinite(each.least) else 0.0):
                unknown.setdefault(each.name, tuple(names[j] for j in range(len(names)) if j != i
                                                    and abs(correlation[i, j]) > MOST_CORRELATION))
        estimates = {each.name: Estimate(float(x[i]), float(stddev[i] * each.range), each.unit)
                     for i, each in enumerate(self.parameters) if each.name not in unknown}
        mine = [name for name in names if not name.endswith(START)]
        estimates = {name: each for name, each in estimates.items() if name in mine}
        rest = [Unknown(name, tuple(others), motion_for(name, self._link)) for name, others in unknown.items()
                if name in mine]
        add_state_delay(self._recording, estimates, rest)
        q, _ = self.replay(x, self._used)
        measured = self._recording.position[self._used]
        residual = np.sqrt(np.mean((q - measured)[:len(rows)]**2, axis=0))
        # Unknown ones stay as fitted: only together with the others do they repeat the motion.
        values = {name: float(value) for name, value in zip(names, x)}
        section = self.overlay(values)
        section["sim"][DELAY] = round(max(values[DELAY], 0.0), 6)
        return Twin(Identified(estimates, rest, dict(zip(self._names, residual.tolist()))),
                    tuple(names), cov * np.outer(self._ranges, self._ranges), section, self._names,
                    self._recording.times_s[self._used] - self._start, measured, q, len(rows))


def _weights(plain: Sequence[np.ndarray]) -> np.ndarray:
    """1 / root mean square of each channel, (channels,)."""
    rms = np.sqrt(np.mean(np.asarray(plain)**2, axis=1))
    return 1.0 / np.maximum(rms, 1e-9 * max(float(rms.max()), 1e-9))
