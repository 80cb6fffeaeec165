"""Does the twin of an arm tell which of two gains settles sooner on the arm itself?

The arm is a simulator with secret friction, loops, payload, gravity and delay, and with noise in joints and images. Its
twin is identified from a motion of the joints. Both then servo with the same random gains. Counted are the pairs of
gains of an arm whose settling times have the same order on both. A pair whose times on the arm differ by less than
TIE_S has no order. A run that does not settle is the slowest.
Beside the twin stand the arm itself with other noise, and the model before it was identified.

    python3 src/aras_visual_servo_study/bench/twin_order.py --arms 10 --gains 5
"""
import argparse
import itertools
import json
import time
from xml.etree import ElementTree

import numpy as np

import aras_visual_servo as avs
from aras_visual_servo_controller import Commands, Recording, identify_twin
from aras_visual_servo_study.compare.settling import settling_s

#: Arms in turn, each with its task.
ARMS = (("so101", "experiment_1"), ("ur5e", "six_dof_points"))
#: Standard deviations of joint states [rad, rad/s] and of images [grey levels].
NOISE, SPEED_NOISE, GREY = 1e-4, 1e-3, 1.0
#: Gains of the model's loops by the effort limit of the joint, and ranges of the secret values.
P_PER_EFFORT, D_PER_P = 10.0, 0.05
LOOP, DAMPING, FRICTION, GRAVITY, MOST_DELAY_S = (0.5, 1.6), (0.005, 0.1), (0.002, 0.03), (0.95, 1.05), 0.06
#: Common factor of all gains, and that of each gain beside it.
COMMON, EACH = (0.4, 6.0), (0.6, 1.6)
#: Half of the time between two images [s].
TIE_S = 1.0 / 60.0
#: Frequencies of the motion that identifies [Hz], and amplitudes [rad].
HERTZ, HEIGHT = np.array([0.17, 0.37, 0.83]), np.array([0.2, 0.12, 0.06])


def model(arm, task):
    """(scenario, joint names, effort limits) of a named arm with a loop at each joint."""
    plain = avs.load_scenario(task, {"robot": arm})
    names = list(plain.kinematics(calibrated=False).joint_names)
    joints = {joint.get("name"): joint for joint in ElementTree.fromstring(plain.urdf_xml()).findall("joint")}
    effort = np.array([float(joints[name].find("limit").get("effort")) for name in names])
    loops = {name: {"p": p, "d": D_PER_P * p} for name, p in zip(names, (P_PER_EFFORT * effort).tolist())}
    return plain.with_overrides({"robot.dynamics": {"loops": loops}}), names, effort


def secret(rng, scenario, names, effort):
    """Changes of a scenario that make its robot the secret one."""
    def by_name(range_of, factor):
        return dict(zip(names, (factor * rng.uniform(*range_of, len(names))).tolist()))
    p = by_name(LOOP, P_PER_EFFORT * effort)
    d = by_name(LOOP, D_PER_P * np.array(list(p.values())))
    dynamics = {"damping": by_name(DAMPING, effort), "friction": by_name(FRICTION, effort),
                "loops": {name: {"p": p[name], "d": d[name]} for name in names},
                "payload": {"link": scenario.robot["tip_link"], "mass_kg": 0.005 * effort.max() * rng.uniform(0.2, 2.0),
                            "position_m": rng.uniform(-0.1, 0.1, 3).tolist()}}
    return {"robot.dynamics": dynamics, "sim.gravity_m_s2": [0.0, 0.0, -9.81 * rng.uniform(*GRAVITY)],
            "sim.command_delay_s": float(rng.integers(0, round(1e3 * MOST_DELAY_S)) / 1e3)}


def recording(rng, scenario, names, seconds):
    """`Recording` of a motion of the secret arm: it rests for a second and moves all joints by sums of sines."""
    sim = avs.simulation_of(scenario)
    order = [list(sim.joint_names).index(name) for name in names]
    hertz = HERTZ[:, None] * rng.uniform(0.8, 1.2, (len(HERTZ), len(names)))
    phase = rng.uniform(0.0, 2.0 * np.pi, hertz.shape)
    rows, stamps, speeds = [], [], []
    for k in range(100 * (1 + seconds)):
        if k >= 100:
            t = 0.01 * (k - 100)
            wave = HEIGHT[:, None] * 2.0 * np.pi * hertz * np.cos(2.0 * np.pi * hertz * t + phase)
            stamps.append(sim.time_s)
            speeds.append(min(t, 1.0) * wave.sum(axis=0))
            sim.set_command(velocity=dict(zip(names, speeds[-1])))
        sim.step(10)
        rows.append((sim.time_s, sim.joint_positions[order], sim.joint_velocities[order]))
    times, q, v = (np.array(column) for column in zip(*rows))
    return Recording(tuple(names), times, q + rng.normal(0.0, NOISE, q.shape),
                     v + rng.normal(0.0, SPEED_NOISE, v.shape),
                     commands=Commands("velocity", np.array(stamps), np.array(speeds)))


def gains(rng, scenario):
    """Changes of a scenario that give it random gains."""
    common = np.exp(rng.uniform(*np.log(COMMON)))
    changes = {"servo.gains_per_s": {name: float(gain * common * np.exp(rng.uniform(*np.log(EACH))))
                                     for name, gain in scenario.servo["gains_per_s"].items()}}
    if "tilt_gain_per_s" in scenario.servo:
        changes["servo.tilt_gain_per_s"] = float(scenario.servo["tilt_gain_per_s"] * common)
    return changes


def settled(scenario, changes, seed):
    """Settling time of a run with noisy images [s]; infinite if it does not settle."""
    camera = {**scenario.sim["cameras"][0], "noise_stddev": GREY}
    record = avs.run(scenario.with_overrides({**changes, "sim.seed": seed, "sim.cameras": [camera]}))
    found = settling_s(record) if len(record.servo_rows) else np.nan
    return found if np.isfinite(found) else np.inf


def trial(seed, count, seconds):
    """Times of `count` gains on one secret arm, on its twin, on the arm again, and on the model not identified."""
    rng = np.random.default_rng(seed)
    arm, task = ARMS[seed % len(ARMS)]
    scenario, names, effort = model(arm, task)
    hidden = secret(rng, scenario, names, effort)
    start = time.perf_counter()
    twin = identify_twin(recording(rng, scenario.with_overrides(hidden), names, seconds), scenario,
                         scenario.robot["tip_link"])
    spent = time.perf_counter() - start
    found = {f"{section}.{key}": value for section, values in twin.overlay.items() for key, value in values.items()}
    times = {"arm": [], "twin": [], "again": [], "model": []}
    for k in range(count):
        chosen = gains(rng, scenario)
        for who, changes, its in (("arm", hidden, 1), ("twin", found, 2), ("again", hidden, 3), ("model", {}, 4)):
            times[who].append(settled(scenario, {**changes, **chosen}, its + 10 * k))
    return {"arm": arm, "seed": seed, "identify_s": round(spent, 1),
            **{who: [round(value, 4) for value in values] for who, values in times.items()}}


def order(row, who):
    """(pairs in the right order, pairs that have one) of an arm."""
    right = pairs = 0
    for i, j in itertools.combinations(range(len(row["arm"])), 2):
        a, b = row["arm"][i], row["arm"][j]
        if a == b or abs(a - b) < TIE_S:
            continue
        pairs += 1
        right += (a < b) == (row[who][i] < row[who][j])
    return right, pairs


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--arms", type=int, default=10)
    parser.add_argument("--gains", type=int, default=5, help="for each arm")
    parser.add_argument("--seconds", type=int, default=6, help="length of the motion that identifies")
    parser.add_argument("--seed", type=int, default=0, help="of the first arm")
    options = parser.parse_args()
    rows = []
    for seed in range(options.seed, options.seed + options.arms):
        rows.append(trial(seed, options.gains, options.seconds))
        print(json.dumps(rows[-1]), flush=True)
    for who in ("twin", "again", "model"):
        right, pairs = (sum(column) for column in zip(*(order(row, who) for row in rows)))
        print(f"{who}: {right} of {pairs} pairs in the right order ({100 * right / pairs:.1f} %)")


if __name__ == "__main__":
    main()
