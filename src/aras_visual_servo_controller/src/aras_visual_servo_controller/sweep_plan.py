"""Which runs a sweep consists of: starts sampled in joint or camera space, perturbations, all from one seed.

The starts depend on method, space, ranges, number and seed only, not on what is perturbed nor on the law: two sweeps of
the same seed have the same starts, run for run, and can be compared in pairs.
"""

from dataclasses import dataclass, field
from math import isfinite

import numpy as np

from .errors import ParameterError
from .sweep_perturb import read_perturbations

METHODS = ("latin_hypercube", "grid", "random")
SPACES = ("camera", "joint")
CAMERA_AXES = ("x_m", "y_m", "z_m", "rx_rad", "ry_rad", "rz_rad")
#: Where the camera starts if the scenario does not say: displaced from the goal, along its own axes (z along the view).
#: Backwards only: at the goals of the paper the arm is all but stretched.
DEFAULT_CAMERA = {"x_m": (-0.15, 0.15), "y_m": (-0.2, 0.2), "z_m": (-0.2, -0.03), "rz_rad": (-0.7, 0.7)}
#: Half-width of the joint ranges about the goal if the scenario does not say [m, rad].
DEFAULT_JOINT_HALF_WIDTH = 0.2
DEFAULT_STARTS = 100

#: A camera pose counts as reached when it is this near: a tenth of what the strict metric tells apart.
REACHED_M, REACHED_RAD = 1e-4, 5e-4
IK_STEPS, IK_DAMPING, IK_MAX_STEP = 60, 1e-2, 0.3
#: Other postures tried, and how far they are from the goal [m, rad].
IK_GUESSES, IK_SPREAD = 6, 0.8


@dataclass(frozen=True)
class Start:
    """One run of a sweep.

    Attributes:
        id: from 1, in the order of sampling.
        joints: where the arm starts, by name [m, rad]; None if there is no such place.
        offset: camera space only: displacement X_CgC from the goal by axis (rotation vector) [m, rad]; else {}.
        parameters: perturbation name -> value.
        refusal: why this start cannot be run, "" if it can be tried.
    """

    id: int
    joints: dict
    offset: dict = field(default_factory=dict)
    parameters: dict = field(default_factory=dict)
    refusal: str = ""


@dataclass(frozen=True)
class SweepSettings:
    """Section `sweep` of a scenario with its defaults, checked."""

    starts: int
    method: str
    space: str
    seed: int
    drive_to_start: bool
    ranges: dict  # axis or joint name -> (low, high)
    perturbations: tuple

    @classmethod
    def from_scenario(cls, scenario, kinematics, **changes):
        """Read the section; keyword arguments that are not None replace its keys.

        Raises:
            ParameterError: every fault, a line each.
        """
        section = dict(scenario.sweep)
        section.update({key: value for key, value in changes.items() if value is not None})
        faults = []
        starts, seed = section.get("starts", DEFAULT_STARTS), section.get("seed", 0)
        for key, value, least in (("starts", starts, 1), ("seed", seed, 0)):
            if not isinstance(value, int) or isinstance(value, bool) or value < least:
                faults.append(f"sweep.{key}: found {value}, allowed is a whole number >= {least}")
        method, space = section.get("method", METHODS[0]), section.get("space", SPACES[0])
        for key, value, known in (("method", method, METHODS), ("space", space, SPACES)):
            if value not in known:
                faults.append(f"sweep.{key}: found {value}, allowed {', '.join(known)}")
        ranges = {}
        if space == "camera":
            ranges = _ranges("camera", section.get("camera") or DEFAULT_CAMERA, CAMERA_AXES, faults)
        elif space == "joint":
            goal = scenario.experiment["goal"]["joints"]
            around = {name: (goal[name] - DEFAULT_JOINT_HALF_WIDTH, goal[name] + DEFAULT_JOINT_HALF_WIDTH)
                      for name in kinematics.joint_names if name in goal}
            ranges = _ranges("joints", section.get("joints") or around, kinematics.joint_names, faults)
        perturbations = []
        try:
            perturbations = read_perturbations(section.get("perturb", {}), scenario)
        except ParameterError as error:
            faults += error.faults
        if faults:
            raise ParameterError(faults)
        return cls(starts, method, space, seed, bool(section.get("drive_to_start", False)), ranges,
                   tuple(perturbations))


def sample(method, count, dimensions, seed):
    """Points in the unit cube.

    Args:
        method: one of METHODS. A grid has at most `count` points, the cell centres of the largest grid that fits.
        count: >= 1.  dimensions: >= 0.  seed: whole number, or a sequence of them.
    Returns:
        (n, dimensions), n <= count, each in [0, 1).
    """
    rng = np.random.default_rng(seed)
    if dimensions == 0:
        return np.zeros((count, 0))
    if method == "random":
        return rng.random((count, dimensions))
    if method == "latin_hypercube":
        from scipy.stats import qmc  # slow to import
        return qmc.LatinHypercube(d=dimensions, seed=rng).random(count)
    shape = _grid_shape(count, dimensions)
    axes = [(np.arange(n) + 0.5) / n for n in shape]
    return np.stack([axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")], axis=1)


def make_starts(settings, scenario, kinematics):
    """The runs of a sweep: list of `Start`, a function of its arguments alone."""
    varied = {name: ends for name, ends in settings.ranges.items() if ends[0] < ends[1]}
    places = sample(settings.method, settings.starts, len(varied), [settings.seed, 1])
    # A grid over the perturbations too would leave few places: there they are drawn at random.
    method = "random" if settings.method == "grid" else settings.method
    values = sample(method, len(places), len(settings.perturbations), [settings.seed, 2])
    goal = kinematics.vector({**dict.fromkeys(kinematics.joint_names, 0.0), **scenario.sim.get("initial_positions", {}),
                              **scenario.experiment["goal"]["joints"]})
    starts = []
    for i, (place, u) in enumerate(zip(places, values)):
        point = {name: ends[0] for name, ends in settings.ranges.items()}
        point.update({name: float(low + t * (high - low)) for (name, (low, high)), t in zip(varied.items(), place)})
        parameters = {p.name: p.at(float(t)) for p, t in zip(settings.perturbations, u)}
        if settings.space == "joint":
            joints, refusal, offset = {**kinematics.by_name(goal), **point}, "", {}
        else:
            offset = point
            joints, refusal = reach(kinematics, goal, point)
        refusal = refusal or outside_limits(kinematics, joints)
        starts.append(Start(i + 1, joints, offset, parameters, refusal))
    return starts


def outside_limits(kinematics, joints):
    """"outside joint limits: ..." naming every such joint, "" if there is none."""
    faults = [f"{name} {joints[name]:.4g} not in [{lower:.4g}, {upper:.4g}]"
              for name, lower, upper in zip(kinematics.joint_names, kinematics.lower, kinematics.upper)
              if not lower <= joints[name] <= upper]
    return f"outside joint limits: {', '.join(faults)}" if faults else ""


def reach(kinematics, goal, offset):
    """Joints that displace the camera from the goal pose.

    Args:
        goal: (n,) joints of the goal.  offset: X_CgC by axis of CAMERA_AXES, rotation vector; missing axes 0.
    Returns:
        (joints by name, "") or (None, why not). Damped least squares from the goal, then from IK_GUESSES other
        postures, always the same ones; joints within their limits are preferred.
    """
    delta = np.array([offset.get(axis, 0.0) for axis in CAMERA_AXES])
    X_CgC = np.eye(4)
    X_CgC[:3, :3], X_CgC[:3, 3] = rotation(delta[3:]), delta[:3]
    X_BC = kinematics.pose(goal) @ X_CgC
    rng, found, missing = np.random.default_rng(0), None, None
    for guess in range(1 + IK_GUESSES):
        q = goal if guess == 0 else goal + rng.uniform(-IK_SPREAD, IK_SPREAD, len(goal))
        q, error = _solve(kinematics, X_BC, q)
        if np.linalg.norm(error[:3]) < REACHED_M and np.linalg.norm(error[3:]) < REACHED_RAD:
            found = kinematics.by_name(q) if found is None else found
            if not outside_limits(kinematics, kinematics.by_name(q)):
                return kinematics.by_name(q), ""
        elif missing is None or np.linalg.norm(error) < np.linalg.norm(missing):
            missing = error
    if found is not None:
        return found, ""
    return None, (f"camera pose out of reach: {1e3 * np.linalg.norm(missing[:3]):.3g} mm and "
                  f"{np.degrees(np.linalg.norm(missing[3:])):.3g} deg are missing")


def _solve(kinematics, X_BC, q):
    """(joints, what is left of the error (6,) in C) of damped least squares from q."""
    for _ in range(IK_STEPS):
        X = kinematics.pose(q)
        error = np.concatenate([X[:3, :3].T @ (X_BC[:3, 3] - X[:3, 3]), rotation_vector(X[:3, :3].T @ X_BC[:3, :3])])
        if np.linalg.norm(error[:3]) < REACHED_M and np.linalg.norm(error[3:]) < REACHED_RAD:
            break
        J = kinematics.jacobian(q)
        step = J.T @ np.linalg.solve(J @ J.T + IK_DAMPING ** 2 * np.eye(6), error)
        q = q + step * min(1.0, IK_MAX_STEP / max(float(np.abs(step).max()), 1e-12))
    return q, error


def rotation(vector):
    """Rotation matrix of a rotation vector (3,) [rad] (Rodrigues)."""
    angle = float(np.linalg.norm(vector))
    if angle == 0.0:
        return np.eye(3)
    x, y, z = np.asarray(vector) / angle
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * (K @ K)


def rotation_vector(R):
    """Rotation vector (3,) [rad] of a matrix, angle below pi."""
    axis = 0.5 * np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    sine, cosine = float(np.linalg.norm(axis)), 0.5 * (float(np.trace(R)) - 1.0)
    return axis if sine < 1e-12 else axis * (np.arctan2(sine, cosine) / sine)


def _grid_shape(count, dimensions):
    """Points along each axis, as even as can be, product <= count."""
    shape = [max(1, int(round(count ** (1.0 / dimensions), 9)))] * dimensions
    while np.prod(shape) > count:
        shape[int(np.argmax(shape))] -= 1
    for axis in range(dimensions):
        while np.prod(shape) // shape[axis] * (shape[axis] + 1) <= count and shape[axis] <= min(shape):
            shape[axis] += 1
    return shape


def _ranges(key, section, known, faults):
    ranges = {}
    for name, ends in section.items():
        if name not in known:
            faults.append(f"sweep.{key}.{name}: unknown, known are {', '.join(known)}")
        elif len(ends) != 2 or not all(isfinite(end) for end in ends) or ends[0] > ends[1]:
            faults.append(f"sweep.{key}.{name}: found {list(ends)}, allowed [low, high] with low <= high")
        else:
            ranges[name] = (float(ends[0]), float(ends[1]))
    return {name: ranges[name] for name in known if name in ranges}
