"""Identifies simulated arms with secret parameters, and counts the truths within their 95 % intervals.

    python3 src/aras_visual_servo_controller/bench/identify_arms.py --arms iiwa7 so101 --count 100 --seconds 12
    python3 src/aras_visual_servo_controller/bench/identify_arms.py --arms my_arm/scenario.yaml --commands position

Commands are velocities or, with `--commands position`, the set points of the motion that `aras-servo identify --excite`
designs; the arm rests at its beginning for 3 s.
"""
import argparse
import json
import time
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np

from aras_visual_servo import load_scenario, simulation_of
from aras_visual_servo_controller import Commands, Recording, identify_twin
from aras_visual_servo_controller.identification.excite import design

#: Standard deviations of the joint states. [rad, rad/s]
NOISE, SPEED_NOISE = 1e-4, 1e-3
#: The arm rests this long before the first command. [s]
REST_S = 1.0
#: Gains of the models, by the effort limit of the joint.
P_PER_EFFORT, D_PER_P = 10.0, 0.05
#: Frequencies of the motion [Hz], and its amplitudes as parts of the way to the nearer limit, at most 1 rad.
HERTZ = np.array([0.11, 0.23, 0.41, 0.73])
PARTS = np.array([0.3, 0.2, 0.1, 0.06])


def model(arm):
    """(scenario, joint names, effort limits, link of the payload) of a named arm with a PID loop at each joint."""
    plain = load_scenario(arm)
    kinematics = plain.kinematics(calibrated=False)
    joints = {joint.get("name"): joint for joint in ElementTree.fromstring(plain.urdf_xml()).findall("joint")}
    names = list(kinematics.joint_names)
    effort = np.array([float(joints[name].find("limit").get("effort")) for name in names])
    gains = (P_PER_EFFORT * effort).tolist()
    scenario = plain.with_overrides({"robot.dynamics": {"loops": {name: {"p": p, "d": D_PER_P * p}
                                                                  for name, p in zip(names, gains)}}})
    return scenario, names, effort, plain.robot["tip_link"]


def draw(rng, names, effort):
    """True parameters by name."""
    truth = {}
    for name, limit in zip(names, effort):
        p = P_PER_EFFORT * limit * rng.uniform(0.6, 1.6)
        truth.update({f"{name}.p": p, f"{name}.d": p * D_PER_P * rng.uniform(0.6, 1.6),
                      f"{name}.damping": limit * rng.uniform(0.005, 0.1),
                      f"{name}.friction": limit * rng.uniform(0.002, 0.03)})
    truth.update({"gravity_scale": rng.uniform(0.95, 1.05), "command_delay_s": rng.integers(0, 60) / 1e3})
    truth["payload.mass"] = rng.uniform(0.2, 1.0) * 0.01 * effort.max()
    place = rng.uniform(-0.1, 0.1, 3)
    truth.update({f"payload.first_{axis}": truth["payload.mass"] * x for axis, x in zip("xyz", place)})
    return truth


def record(rng, arm, truth, seconds, kind):
    """(scenario of the model, `Recording` of an arm with these true parameters, link of the payload)."""
    scenario, names, _, last = model(arm)
    values = {key: {name: truth[f"{name}.{key}"] for name in names} for key in ("damping", "friction", "p", "d")}
    dynamics = {"damping": values["damping"], "friction": values["friction"],
                "loops": {name: {"p": values["p"][name], "d": values["d"][name]} for name in names},
                "payload": {"link": last, "mass_kg": truth["payload.mass"],
                            "position_m": [truth[f"payload.first_{axis}"] / truth["payload.mass"] for axis in "xyz"]}}
    sim = simulation_of(replace(scenario, robot={**scenario.robot, "dynamics": dynamics}, sim={
        "initial_positions": scenario.sim["initial_positions"],
        "gravity_m_s2": [0.0, 0.0, -9.81 * truth["gravity_scale"]],
        "command_delay_s": truth["command_delay_s"]}))
    order = [list(sim.joint_names).index(name) for name in names]
    kinematics = scenario.kinematics(calibrated=False)
    goal = waves(rng, kinematics, sim.joint_positions[order]) if kind == "velocity" else \
        designed(scenario, seconds, int(rng.integers(2**31)))
    rows, stamps, values = [], [], []

    def step():
        sim.step(10)
        rows.append((sim.time_s, sim.joint_positions[order], sim.joint_velocities[order]))
    for _ in range(int(REST_S * 100)):
        step()
    for k in range(int(seconds * 100)):
        stamps.append(sim.time_s)
        values.append(goal(k / 100))
        sim.set_command(**{kind: dict(zip(names, values[-1]))})
        step()
    times, q, v = (np.array(column) for column in zip(*rows))
    return scenario, Recording(tuple(names), times, q + rng.normal(0.0, NOISE, q.shape),
                               v + rng.normal(0.0, SPEED_NOISE, v.shape),
                               commands=Commands(kind, np.array(stamps), np.array(values))), last


def waves(rng, kinematics, start):
    """Time -> velocities (m,) of sines about the start, within the limits."""
    room = np.clip(np.minimum(kinematics.upper - start, start - kinematics.lower), 0.1, 1.0)
    circular = 2.0 * np.pi * HERTZ[:, None] * rng.uniform(0.8, 1.2, (len(HERTZ), len(start)))
    height = PARTS[:, None] * rng.uniform(0.6, 1.2, circular.shape) * room
    phase = rng.uniform(0.0, 2.0 * np.pi, circular.shape)
    return lambda t: min(t / 2.0, 1.0) * np.sum(height * circular * np.cos(circular * t + phase), axis=0)


def designed(scenario, seconds, seed):
    """Time -> positions (m,) of the designed motion."""
    motion = design(scenario, seconds, seed)
    return lambda t: np.array([np.interp(t, motion.times_s, column) for column in motion.position.T])


def trial(seed, arm, seconds, kind):
    """Figures of one arm: truths inside and outside of their intervals, unknown ones, held-out error by noise, time."""
    rng = np.random.default_rng(seed)
    _, names, effort, _ = model(arm)
    truth = draw(rng, names, effort)
    scenario, recording, last = record(rng, arm, truth, seconds, kind)
    start = time.perf_counter()
    twin = identify_twin(recording, scenario, last)
    spent = time.perf_counter() - start
    # Intervals of a fit that did not converge are infinite, and hold every truth.
    found = {name: each for name, each in twin.identified.estimates.items() if twin.converged and name in truth}
    off = {name: (each.value - truth[name]) / each.stddev for name, each in found.items()}
    inside = {name: each.interval[0] <= truth[name] <= each.interval[1] for name, each in found.items()}
    return {"arm": arm, "seed": seed, "inside": int(sum(inside.values())), "known": len(inside),
            "outside": {name: round(off[name], 2) for name, well in inside.items() if not well},
            "unknown": [each.name for each in twin.identified.unknown if each.name in truth],
            "converged": twin.converged, "held_out_by_noise": max(twin.held_out.values()) / NOISE, "seconds": spent}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--arms", nargs="+", default=["iiwa7"], help="named arms, in turn")
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--seconds", type=float, default=12.0, help="length of the motion")
    parser.add_argument("--commands", choices=("velocity", "position"), default="velocity")
    parser.add_argument("--seed", type=int, default=0, help="of the first arm")
    options = parser.parse_args()
    rows = []
    for k in range(options.count):
        rows.append(trial(options.seed + k, options.arms[k % len(options.arms)], options.seconds,
                          options.commands))
        print(json.dumps(rows[-1]), flush=True)
    inside, known = (sum(row[key] for row in rows) for key in ("inside", "known"))
    print(f"{len(rows)} arms: {inside} of {known} truths inside their 95 % interval "
          f"({100 * inside / max(known, 1):.1f} %), "
          f"{sum(len(row['unknown']) for row in rows)} not told; held-out error at most "
          f"{max(row['held_out_by_noise'] for row in rows):.2f} x noise; "
          f"{sum(not row['converged'] for row in rows)} did not converge; "
          f"{np.median([row['seconds'] for row in rows]):.0f} s each (median)")


if __name__ == "__main__":
    main()
