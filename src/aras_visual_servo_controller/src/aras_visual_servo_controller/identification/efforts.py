"""Friction, gravity scale and payload from recorded efforts: least squares on the inverse dynamics."""

from typing import Dict, List, Optional, Sequence

import numpy as np

from aras_visual_servo import ParameterError
from .advice import LEAST_SPAN, motion_for
from .dynamics import Inertia, TreeDynamics
from .estimates import Estimate, Identified, Unknown, covariance, not_told, separable
from .recording import Recording

#: Both sides of the equation are averaged over a Hann window of this length. It is longer than noise and shorter than
#: the motion. [s]
WINDOW_S = 0.12
#: Below this part of its mean speed a joint may stick, and Coulomb friction has no known sign.
STICKING = 0.1
#: Residuals are correlated over this many windows at most: windows overlap by half, and models err over a while.
LAGS = 6
#: Below this the inertia of the payload is left out. [kg]
LEAST_MASS_KG = 1e-3
#: Rounds of the fit; a payload of a third of the last link settles to 1e-6 in six.
ROUNDS = 8
PAYLOAD = ("payload.mass", "payload.first_x", "payload.first_y", "payload.first_z")
DELAY = "effort_delay_s"
UNITS = ("kg", "kg m", "kg m", "kg m")


def identify_efforts(recording: Recording, urdf_xml: str, payload_link: Optional[str] = None,
                     gravity_m_s2: Sequence[float] = (0.0, 0.0, -9.81)) -> Identified:
    """Fits viscous and Coulomb friction of each joint, the gravity scale and the payload (Swevers, Verdin and
    De Schutter, IEEE Control Systems 27(5), 2007, for the linear model and its filters).

    The names are `JOINT.damping` [N s/m or N m s/rad] and `JOINT.friction` [N or N m], as in a URDF's <dynamics>,
    `gravity_scale`, `effort_delay_s`: how much older the efforts are than the positions of the same stamp, and with a
    payload_link `payload.mass` [kg] and `payload.first_x`, y, z [kg m]: mass times centre of mass in the frame of that
    link. The payload is a point mass beyond the inertia that the URDF has.

    Args: gravity_m_s2: gravity in the frame of the root link.
    Raises: ParameterError: no efforts; joints that are not those of the URDF; an unknown link; no joint moved.
            ModelError: of the URDF.
    """
    tree = TreeDynamics(urdf_xml)
    faults = []
    if recording.effort is None:
        faults.append("effort: found none, allowed the efforts of all joints")
    if set(recording.joint_names) != set(tree.joint_names):
        faults.append(f"joint_names: found {sorted(recording.joint_names)}, allowed {list(tree.joint_names)}")
    if payload_link is not None and payload_link not in tree.inertias:
        faults.append(f"payload_link: found {payload_link}, allowed {', '.join(sorted(tree.inertias))}")
    moved = np.ptp(recording.position, axis=0) > LEAST_SPAN
    if not np.any(moved):
        faults.append(f"position: found motions of at most {np.ptp(recording.position, axis=0).max():.2g}, allowed "
                      f"more than {LEAST_SPAN} m or rad of one joint")
    if faults:
        raise ParameterError(faults)
    return _Fit(recording, tree, payload_link, gravity_m_s2).result()


class _Fit:
    """Equations of a recording, one row for each window and joint."""

    def __init__(self, recording, tree, payload_link, gravity):
        self.names, self.payload_link = tree.joint_names, payload_link
        order = [recording.joint_names.index(name) for name in self.names]
        period = recording.period_s
        times = np.arange(recording.times_s[0], recording.times_s[-1], period)
        q, effort = (_evenly(times, recording.times_s, values[:, order])
                     for values in (recording.position, recording.effort))
        v = _slope(q, period) if recording.velocity is None else \
            _evenly(times, recording.times_s, recording.velocity[:, order])
        moved = np.ptp(q, axis=0) > LEAST_SPAN
        v[:, ~moved] = 0.0
        motion = (q, v, _slope(v, period))
        self._tree, self._motion, self._gravity = tree, motion, gravity
        half = max(int(round(0.5 * WINDOW_S / period)), 1)
        window = np.hanning(2 * half + 3)[1:-1]
        window /= window.sum()
        starts = np.arange(0, len(q) - 2 * half, half)

        self._starts, self._window, self.step_s = starts, window, half * period
        speed = np.abs(v)
        slowest = np.min([speed[starts + i] for i in range(len(window))], axis=0)
        self.used = moved & (slowest > STICKING * speed.mean(axis=0))
        self.effort, self.v, self.sign = map(self._averaged, (effort, v, np.sign(v)))
        still = (q, 0.0 * q, 0.0 * q)
        self.rest = self._averaged(tree.efforts([tree.inertias, *self._payload(np.zeros(4))], still, gravity))
        self.moving = self._averaged(tree.efforts([tree.inertias], motion, (0.0, 0.0, 0.0)))

    def _averaged(self, values):
        """(..., n, m) -> (..., windows, m)"""
        return sum(w * values[..., self._starts + i, :] for i, w in enumerate(self._window))

    def _payload(self, value):
        """Derivatives of the inertia of a point mass by mass and first moments (4,), as sets of links; [] without one.

        Its second moment, (h.h 1 - h h^T) / m, is homogeneous of degree 1: the derivatives times `value` give it.
        """
        if self.payload_link is None:
            return []
        mass, first = value[0], value[1:]
        seconds = np.zeros((4, 3, 3))
        if mass > LEAST_MASS_KG:
            seconds[0] = (np.outer(first, first) - first @ first * np.eye(3)) / mass**2
            for k, axis in enumerate(np.eye(3)):
                seconds[k + 1] = (2.0 * first[k] * np.eye(3) - np.outer(axis, first) - np.outer(first, axis)) / mass
        firsts = np.vstack([np.zeros(3), np.eye(3)])
        return [{self.payload_link: Inertia(float(i == 0), firsts[i], seconds[i])} for i in range(4)]

    def result(self):
        """Fits repeatedly: the payload's weight depends on the gravity scale, its inertia on the payload itself."""
        m = len(self.names)
        names = [f"{name}.{key}" for name in self.names for key in ("damping", "friction")] + ["gravity_scale", DELAY]
        names += PAYLOAD if self.payload_link is not None else []
        row, joint = np.nonzero(self.used)
        order = np.lexsort((row, joint))
        row, joint = row[order], joint[order]
        right = (self.effort - self.moving[0])[row, joint]
        weight, scale, damping, payload = np.ones(m), 1.0, np.zeros(m), np.zeros(4)
        for _ in range(ROUNDS):
            sets = self._payload(payload)
            moving = self._averaged(self._tree.efforts(sets, self._motion, (0.0, 0.0, 0.0))) if sets else []
            model = self.moving[0] + scale * self.rest[0] + damping * self.v
            model += sum(p * (a + scale * b) for p, a, b in zip(payload, moving, self.rest[1:]))
            left = np.zeros((len(row), len(names)))
            left[np.arange(len(row)), 2 * joint] = self.v[row, joint]
            left[np.arange(len(row)), 2 * joint + 1] = self.sign[row, joint]
            left[:, 2 * m] = self.rest[0][row, joint]
            left[:, 2 * m + 1] = -np.gradient(model, self.step_s, axis=0)[row, joint]
            for i, inertial in enumerate(moving, 1):
                left[:, 2 * m + 1 + i] = (inertial + scale * self.rest[i])[row, joint]
            weights = weight[joint]
            inverse, null = separable(left * weights[:, None])
            value = inverse @ (right * weights)
            residual = right - left @ value
            unknown = not_told(null, names)
            damping = value[:2 * m:2]
            if "gravity_scale" not in unknown:
                scale = value[2 * m]
            if self.payload_link is not None and not unknown.keys() & set(PAYLOAD):
                payload = value[2 * m + 2:]
            noise = np.array([np.sqrt(np.mean(residual[joint == j]**2)) if np.any(joint == j) else 1.0
                              for j in range(m)])
            weight = 1.0 / np.maximum(noise, 1e-9 * max(float(noise.max()), 1e-9))
        # Columns of the payload's weight change with the gravity scale; the covariance must know it.
        for i in range(1, len(self.rest)):
            left[:, 2 * m] += value[2 * m + 1 + i] * self.rest[i][row, joint]
        inverse, _ = separable(left * weights[:, None])
        stddev = np.sqrt(np.diag(covariance(inverse, residual * weights, joint, LAGS)))
        units = ["N s/m or N m s/rad", "N or N m"] * m + ["1", "s", *UNITS]
        estimates = {name: Estimate(float(value[i]), float(stddev[i]), units[i]) for i, name in enumerate(names)
                     if name not in unknown}
        return Identified(estimates, self._unknown(unknown),
                          {name: float(noise[j]) for j, name in enumerate(self.names) if np.any(joint == j)})

    def _unknown(self, names: Dict[str, Sequence[str]]) -> List[Unknown]:
        return [Unknown(name, tuple(others), motion_for(name, self.payload_link)) for name, others in names.items()]


def _evenly(times: np.ndarray, stamps: np.ndarray, values: np.ndarray) -> np.ndarray:
    return np.column_stack([np.interp(times, stamps, column) for column in values.T])


def _slope(values: np.ndarray, period_s: float) -> np.ndarray:
    """Derivative by central differences of fourth order, of second order at the ends."""
    slope = np.gradient(values, period_s, axis=0)
    slope[2:-2] = (8.0 * (values[3:-1] - values[1:-3]) - (values[4:] - values[:-4])) / (12.0 * period_s)
    return slope
