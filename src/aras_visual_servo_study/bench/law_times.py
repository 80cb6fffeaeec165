#!/usr/bin/env python3
"""How long each law's control step takes: python3 law_times.py [--steps N], with the workspace sourced; one table.

An L goes by in front of the six-axis arm, whose joints do what they are told. Medians over the steps of one servo: of
the law alone (features in, twist out; `qp` and `mpc` give joint velocities), of the whole `Servo.step` (features and
joints in, joint velocities out), and the law in units of numpy's own SVD of a 6 x 6 matrix, to compare machines by.
"""
import argparse
import os
import pathlib
import re
import statistics
import sys
import time

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # one core, as stated

import numpy as np

from aras_visual_servo import (ORDER, Features, Kinematics, Observation, PlanarTarget, Servo, expand, known_laws,
                               load_scenario, load_yaml, plane_from_pose, resolve_uri, spatial)

sys.path.append(str(pathlib.Path(__file__).resolve().parents[3] / "script" / "pictures"))
import marked

DT_S, Z_STAR_M = 1.0 / 30.0, 0.6
GOAL = {"gantry": 0.05, "J1": 0.0, "J2": -0.5, "J3": 0.9, "J4": 0.0, "J5": -0.4, "J6": 0.0}
START = {"gantry": 0.03, "J1": 0.02, "J2": -0.46, "J3": 0.87, "J4": 0.05, "J5": -0.36, "J6": 0.1}
TARGET = "package://aras_description/targets/l_shape.yaml"
FOUR, SIX = ("xn", "yn", "an", "alpha"), ("xn", "yn", "an", "sx", "sy", "alpha")
POINTS = ("x1", "y1", "x2", "y2", "x4", "y4")
POSE, HYBRID = ("tx", "ty", "tz", "rx", "ry", "rz"), ("xr", "yr", "zr", "rx", "ry", "rz")
HERE, MEAN, SEEN = {"interaction": "current"}, {"interaction": "mean"}, {"pose_from": "points"}
KNOWN = {"target_model": TARGET}
#: Of the camera of 320 x 240 px and the points: what `qp` and `mpc` keep in view.
VIEW = {"half_width": 0.849, "half_height": 0.636, "margin": 0.05}
#: Law, features, other keys of the section `servo`.
ROWS = (
    ("paper", FOUR, {}), ("decoupled", FOUR, {}), ("ibvs", SIX, {}), ("ibvs", SIX, HERE), ("ibvs", SIX, MEAN),
    ("ibvs", ("xn", "yn", "an", "px", "py", "alpha"), HERE), ("ibvs", POINTS, {}), ("ibvs", POINTS, HERE),
    ("ibvs", POINTS, {**HERE, "point_depth": "goal"}), ("ibvs", POINTS, MEAN), ("ibvs", expand(["points4"]), HERE),
    ("ibvs", ("xm1", "ym1", "l1", "alpha1", "xm2", "ym2"), HERE), ("ibvs", ("xg", "yg", "n20", "n11", "n02"), HERE),
    ("pbvs", POSE, KNOWN), ("pbvs", POSE, SEEN), ("hybrid", HYBRID, KNOWN), ("hybrid", HYBRID, SEEN),
    ("sliding", POINTS, HERE), ("broyden", POINTS, {}),
    ("qp", POINTS, {**HERE, "qp": VIEW}), ("mpc", POINTS, {**HERE, "mpc": VIEW}))

#: What the table calls settings whose value is a file.
KNOWN_AS = {"target_model": "moments of the known target"}
#: Lines around the table in docs/features_and_laws.md, its head, and what is said of the SVD before it.
BEGIN, END = "<!-- table: law_times -->", "<!-- end table -->"
HEAD = "| law | features | law [us] | law / SVD [-] | servo step [us] |\n|---|---|---|---|---|\n"
SVD = r"which is [0-9.]+ us here"


class Views:
    """Exact features of the target, from anywhere."""

    def __init__(self, X_WT):
        outline = load_yaml(resolve_uri(TARGET))["outlines_m"][0]
        self._target, self._corners, self._X_WT = PlanarTarget([outline]), np.array(outline)[::-1], X_WT
        self._names = [f"{i}{j}" for i in range(ORDER + 1) for j in range(ORDER + 1 - i)]
        self._star = None

    def look(self, X_WC):
        """`Features`, and (A, B, C) of the plane."""
        X_CT = np.linalg.inv(X_WC) @ self._X_WT
        m = self._target.moments(X_CT)
        corners = self._corners @ X_CT[:3, :2].T + X_CT[:3, 3]
        a, xg, yg = float(m[0, 0]), float(m[1, 0] / m[0, 0]), float(m[0, 1] / m[0, 0])
        mu = _shift(xg) @ m @ _shift(yg).T
        alpha = 0.5 * float(np.arctan2(2.0 * mu[1, 1], mu[2, 0] - mu[0, 2]))
        self._star = self._star or a
        an = Z_STAR_M * (self._star / a) ** 0.5
        return Features(target_visible=True, has_reference=True, valid=True, components=1, area=a, xg=xg, yg=yg,
                        alpha=alpha, xn=an * xg, yn=an * yg, an=an, z_star_m=Z_STAR_M, area_star=self._star,
                        moment_names=self._names, m=[float(m[int(i), int(j)]) for i, j in self._names],
                        mu=[float(mu[int(i), int(j)]) for i, j in self._names],
                        point_x=(corners[:, 0] / corners[:, 2]).tolist(),
                        point_y=(corners[:, 1] / corners[:, 2]).tolist()), plane_from_pose(X_CT[:3, 2], X_CT[:3, 3])


def _shift(offset):
    """S[i, k] = binomial(i, k) (-offset)^(i-k)."""
    S = np.zeros((ORDER + 1, ORDER + 1))
    S[0, 0] = 1.0
    for i in range(1, ORDER + 1):
        S[i] = -offset * S[i - 1]
        S[i, 1:] += S[i - 1, :-1]
    return S


def times(kinematics, law, features, more, steps):
    """Median seconds (law alone, whole servo step) over a servo from START."""
    q = kinematics.vector(GOAL)
    there = np.array([0.0, 0.0, Z_STAR_M, 0.25, -0.15, 0.3])
    views = Views(kinematics.pose(q) @ spatial.exponential(there) @ np.diag([1.0, -1.0, -1.0, 1.0]))
    section = {"law": law, "features": list(features), "mode": "continuous", "time_limit_s": 1e6,
               "gains_per_s": dict.fromkeys(features, 1.0), "thresholds": dict.fromkeys(features, 1e-300), **more}
    if law == "sliding":
        section["sliding"] = {"switching_per_s": 1.0, "boundary": dict.fromkeys(features, 0.01)}
    alone, whole = [], []
    view, plane = views.look(kinematics.pose(q))
    section["target_normal_C"] = (plane / np.linalg.norm(plane)).tolist()
    servo = Servo(kinematics, section)
    servo.teach(view, q, Z_STAR_M)
    servo.start(0)
    _time_the_law(servo, alone)
    q = kinematics.vector(START)
    for step in range(1, steps + 1):
        view, _ = views.look(kinematics.pose(q))
        begin = time.perf_counter()
        command, record = servo.step(Observation(int(step * DT_S * 1e9), view, q), DT_S)
        whole.append(time.perf_counter() - begin)
        if not command.velocity or not np.isfinite(record.e).all():
            raise SystemExit(f"{law} on {', '.join(features)}: {record.status.name}, {record.status_text}")
        q = q + DT_S * record.q_dot
    return statistics.median(alone), statistics.median(whole)


def _time_the_law(servo, durations):
    [law] = [stage.law for stage in servo._stages if hasattr(stage, "law")]
    law_step = law.step

    def step(look):
        begin = time.perf_counter()
        answer = law_step(look)
        durations.append(time.perf_counter() - begin)
        return answer

    law.step = step

    if not law.moves_joints:
        return
    motion = law.joint_velocity

    def joint_velocity(*arguments):
        begin = time.perf_counter()
        answer = motion(*arguments)
        durations[-1] += time.perf_counter() - begin
        return answer

    law.joint_velocity = joint_velocity


def svd_s(repeats=2000):
    """Median seconds of an SVD of a 6 x 6 matrix."""
    A, durations = np.random.default_rng(0).standard_normal((6, 6)), []
    for _ in range(repeats):
        begin = time.perf_counter()
        np.linalg.svd(A)
        durations.append(time.perf_counter() - begin)
    return statistics.median(durations)


def label(law, features, more):
    """The first two cells of a row of the table."""
    notes = [KNOWN_AS.get(key, value.rsplit("/", 1)[-1]) for key, value in more.items() if isinstance(value, str)]
    return f"| `{law}` | `{', '.join(features)}`{''.join(', ' + note for note in notes)} |"


def write(page, rows, unit_s):
    """The text of a page with the table between the lines BEGIN and END, and what an SVD takes, made anew."""
    before, _, after = marked.parts(page, BEGIN + "\n", END)
    before, count = re.subn(SVD, f"which is {1e6 * unit_s:.1f} us here", before)
    if count != 1:
        raise SystemExit(f"law_times: found {count} times '{SVD}' before the table, allowed once")
    return "".join([before, HEAD, *(row + "\n" for row in rows), after])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--steps", type=int, default=300, help="of each servo")
    parser.add_argument("--write", metavar="PAGE", type=pathlib.Path,
                        help="also put the table into docs/features_and_laws.md")
    arguments = parser.parse_args()
    steps, rows = arguments.steps, []
    kinematics = Kinematics(load_scenario("six_dof_rectangle").urdf_xml(), "world", "camera_optical_frame")
    unit = svd_s()
    print(f"numpy.linalg.svd of 6 x 6: {1e6 * unit:.1f} us")
    print(f"{'law':<10} {'features':<58} {'law [us]':>9} {'[SVD]':>6} {'servo step [us]':>16}")
    for law, features, more in ROWS:
        alone, whole = times(kinematics, law, features, more, steps)
        rows.append(f"{label(law, features, more)} {1e6 * alone:.0f} | {alone / unit:.1f} | {1e6 * whole:.0f} |")
        notes = [value.rsplit("/", 1)[-1] for value in more.values() if isinstance(value, str)]
        text = " ".join(features) + (f" ({', '.join(notes)})" if notes else "")
        print(f"{law:<10} {text:<58} {1e6 * alone:>9.0f} {alone / unit:>6.1f} {1e6 * whole:>16.0f}")
    untimed = sorted(set(known_laws()) - {law for law, _, _ in ROWS})
    if untimed:
        print(f"not timed: {', '.join(untimed)}")
    if arguments.write:
        arguments.write.write_text(write(arguments.write.read_text(), rows, unit))


if __name__ == "__main__":
    main()
