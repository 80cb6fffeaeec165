"""Plans the runs of a sweep: starts, goals and perturbations from one seed. Starts that cannot be run are marked so.

Starts and goals depend on method, space, ranges, number and seed, but not on perturbations or the law. So two sweeps
with the same seed have the same starts, and their runs can be compared in pairs.
"""

from dataclasses import asdict, dataclass, field
from typing import Any, Dict, List, Optional, Sequence, Tuple, Union

import numpy as np

from aras_visual_servo import (JOINT_HALF_WIDTH, Feasibility, Names, ParameterError, RobotKinematics, Scenario,
                               SweepSection, place_of, reach, read)
from .perturb import read_perturbations
from .space import View, in_ball, pose_of, tilted_goal


@dataclass(frozen=True)
class Start:
    """One run of a sweep.

    Attributes:
        id: from 1, in the order of sampling.
        joints: where the arm starts, by name [m, rad]; None if no joint positions take the camera there.
        offset: displacement X_CgC from the goal by axis (rotation vector) [m, rad]; {} in space joint.
        parameters: perturbation name -> value.
        refusal: why this start cannot be run, "" if it can be tried.
        goal: tilt_rad, about_rad, joints and target_normal_C of the goal; {} keeps that of the scenario.
    """

    id: int
    joints: Optional[dict]
    offset: dict = field(default_factory=dict)
    parameters: dict = field(default_factory=dict)
    refusal: str = ""
    goal: dict = field(default_factory=dict)


@dataclass(frozen=True)
class SweepSettings:
    """The checked section `sweep` of a scenario, with defaults for what it leaves out."""

    starts: int
    method: str
    space: str
    seed: int
    drive_to_start: bool
    ranges: dict  # axis or joint name -> (low, high)
    perturbations: tuple
    goal: dict = field(default_factory=dict)  # axis -> (low, high); {}: the scenario's goal

    @classmethod
    def from_scenario(cls, scenario: Scenario, kinematics: RobotKinematics, **changes: Any) -> "SweepSettings":
        """Read the section. Keyword arguments that are not None replace its keys.

        Raises: ParameterError: it lists every fault in a line of its own.
        """
        given = dict(scenario.sweep)
        given.update({key: value for key, value in changes.items() if value is not None})
        faults, perturbations = [], ()
        section = read(SweepSection, given, "sweep", Names(joints=kinematics.joint_names), faults=faults)
        try:
            perturbations = tuple(read_perturbations(given.get("perturb", {}), scenario))
        except ParameterError as error:
            faults += error.faults
        if faults:
            raise ParameterError(faults)
        if section.space == "joint":
            goal = place_of(scenario.experiment["goal"], "experiment.goal", kinematics)
            ranges = section.joints or {name: (at - JOINT_HALF_WIDTH, at + JOINT_HALF_WIDTH)
                                        for name, at in goal.joints.items()}
            ranges = {name: ranges[name] for name in kinematics.joint_names if name in ranges}
        else:
            ranges = getattr(section, section.space).as_dict()
        return cls(section.starts, section.method, section.space, section.seed, section.drive_to_start, ranges,
                   perturbations, section.goal.as_dict() if section.goal else {})

    def as_plain(self) -> Dict[str, Any]:
        """Returns the settings with the types that JSON gives back, so that they can be compared with stored ones."""
        values = asdict(self)
        values["ranges"] = {name: list(ends) for name, ends in self.ranges.items()}
        values["goal"] = {name: list(ends) for name, ends in self.goal.items()}
        values["perturb"] = {p.name: ", ".join(map(str, p.values)) if p.values else f"{p.low:g} to {p.high:g}"
                             for p in self.perturbations}
        del values["perturbations"]
        return values


def sample(method: str, count: int, dimensions: int, seed: Union[int, Sequence[int]]) -> np.ndarray:
    """Points in the unit cube.

    Args:
        method: one of METHODS. A grid is the largest with at most `count` points, the centres of its cells.
        count: >= 1.  dimensions: >= 0.  seed: whole number, or a sequence of them.
    Returns: (n, dimensions), n <= count, each in [0, 1).
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


def make_starts(settings: SweepSettings, scenario: Scenario, kinematics: RobotKinematics) -> List[Start]:
    """The runs of a sweep, a list of `Start`; equal arguments give equal runs.

    Raises: ParameterError: the scenario does not have what the space or the goals need.
    """
    varied = {name: ends for name, ends in settings.ranges.items() if ends[0] < ends[1]}
    places = sample(settings.method, settings.starts, 6 if settings.space == "ball" else len(varied),
                    [settings.seed, 1])
    # A grid over starts and perturbations would have few places for each, so perturbations are drawn at random then.
    method = "random" if settings.method == "grid" else settings.method
    values = sample(method, len(places), len(settings.perturbations), [settings.seed, 2])
    goals = sample(method, len(places), len(settings.goal), [settings.seed, 3])
    planner = Planner(settings, scenario, kinematics)
    starts = []
    for i, (place, u, g) in enumerate(zip(places, values, goals)):
        point = {name: ends[0] for name, ends in settings.ranges.items()}
        point.update({name: _between(ends, t) for (name, ends), t in zip(varied.items(), place)})
        parameters = {p.name: p.at(float(t)) for p, t in zip(settings.perturbations, u)}
        wanted = {name: _between(ends, t) for (name, ends), t in zip(settings.goal.items(), g)}
        joints, offset, goal, refusal = planner.plan(place, point, wanted)
        starts.append(Start(i + 1, joints, offset, parameters, refusal, goal))
    return starts


class Planner:
    """Turns a sampled place into joint positions, or into the reason why there are none.

    Attributes: settings: `SweepSettings`.  feasibility: `Feasibility` of the scenario.
    """

    def __init__(self, settings: SweepSettings, scenario: Scenario, kinematics: RobotKinematics) -> None:
        self.settings, self._scenario, self._kinematics = settings, scenario, kinematics
        self._goal = scenario.goal_posture(kinematics)
        self._X_WCg = kinematics.pose(self._goal)
        # If perturbations change target or camera, only the run itself shows whether the target is in view.
        known = not any(p.name.startswith(("target", "sim.")) for p in settings.perturbations)
        self.feasibility = Feasibility(scenario, kinematics, look=known)
        self._view = View(scenario, self._X_WCg) if settings.space == "view" else None
        if settings.goal and self.feasibility.outline is None:
            raise ParameterError("sweep.goal: needs a flat target of known outline and a camera without fisheye lens")

    def plan(self, place: np.ndarray, point: Dict[str, float],
             wanted: Dict[str, float]) -> Tuple[Optional[Dict[str, float]], Dict[str, float], Dict[str, Any], str]:
        """(joints, offset, goal, refusal) of one run."""
        goal, q_goal, refusal = {}, self._goal, ""
        space, offset = self.settings.space, {}
        if space in ("camera", "ball"):
            offset = point if space == "camera" else in_ball(self.settings.ranges, place)
        if wanted:
            goal, refusal = self.tilted(wanted)
            if refusal:
                return None, offset, goal, f"goal {refusal}"
            q_goal = self._kinematics.vector(goal["joints"])
        if space == "joint":
            joints = {**self._kinematics.by_name(q_goal), **point}
        else:
            try:
                offset = offset or self._view.offset(point)
            except ParameterError as error:
                return None, offset, goal, str(error)
            joints, refusal = reach(self._kinematics, q_goal, self._kinematics.pose(q_goal) @ pose_of(offset))
        return joints, offset, goal, refusal or self.feasibility.refusal(q_goal, self._kinematics.vector(joints))

    def tilted(self, wanted: Dict[str, float]) -> Tuple[Dict[str, Any], str]:
        """(goal of a `Start`, why it cannot be reached or \"\") of a tilted goal."""
        X_WT = self.feasibility.outline.X_WT
        t_C = np.linalg.solve(self._X_WCg, X_WT)[:3, 3]
        normal_C = self._scenario.servo.get("target_normal_C", (0.0, 0.0, 1.0))
        X_CgCn, normal = tilted_goal(wanted, t_C, normal_C)
        joints, refusal = reach(self._kinematics, self._goal, self._X_WCg @ X_CgCn)
        return dict(wanted, joints=joints, target_normal_C=normal.tolist()), refusal


def _between(ends, t):
    return float(ends[0] + float(t) * (ends[1] - ends[0]))


def _grid_shape(count, dimensions):
    """Number of points along each axis: as equal as possible, with a product of at most `count`."""
    shape = [max(1, int(round(count ** (1.0 / dimensions), 9)))] * dimensions
    while np.prod(shape) > count:
        shape[int(np.argmax(shape))] -= 1
    for axis in range(dimensions):
        while np.prod(shape) // shape[axis] * (shape[axis] + 1) <= count and shape[axis] <= min(shape):
            shape[axis] += 1
    return shape
