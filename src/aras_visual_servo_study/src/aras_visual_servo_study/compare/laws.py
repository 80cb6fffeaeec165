"""Compares several laws on the same tasks of one scenario: reads the comparison file and runs it. No ROS.

A comparison file names a base scenario, tasks (where the camera starts) and laws (what each of them changes in the
scenario). The result of a run depends on law and task alone: it is the same on any core and in any order.
"""

from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np

from aras_visual_servo import (Feasibility, Outline, ParameterError, Scenario, Track, known_laws, load_scenario,
                               load_yaml, processes, reach, read, track_of)
from ..files import share_dir
from ..sweep.plan import Start
from ..sweep.run import SweepRunner, placed
from ..sweep.space import pose_of, tilted_goal
from .file import ComparisonFile

FOLDER = "comparisons"
#: (task, law, row with the COLUMNS of sweep.judge, `Track` or None), task by task.
Results = List[Tuple[str, str, Dict[str, Any], Optional[Track]]]


@dataclass(frozen=True)
class Task:
    """One start.  name, title.  X_CgC: (4, 4) pose of the camera in that of the goal."""

    name: str
    title: str
    X_CgC: np.ndarray


@dataclass(frozen=True)
class Comparison:
    """The content of a comparison file that was found valid; scenarios by law."""

    name: str
    description: str
    scenarios: Dict[str, Scenario]
    tasks: Tuple[Task, ...]


def load_comparison(name_or_path: Union[str, Path], laws: Optional[Sequence[str]] = (),
                    tasks: Optional[Sequence[str]] = (), overrides: Optional[Mapping[str, Any]] = None,
                    scenario: Optional[str] = None) -> Comparison:
    """Loads a comparison: a file of config/comparisons by its name, or any YAML file by its path.

    Args:
        laws, tasks: the names to compare, in this order; () takes all of the file.  A law may be NAME:INTERACTION. A
            registered law that the file does not name runs with the values of the scenario.
        overrides: dotted path -> value, put into the scenario of every law, see `load_scenario`.
        scenario: name or path of a scenario to take in place of the file's, for example another robot.
    Raises: ParameterError: it lists every fault, and for unknown names the known ones.
    """
    file = read(ComparisonFile, load_yaml(_find(name_or_path)), str(name_or_path))
    base = load_scenario(scenario or file.scenario, overrides)
    faults, scenarios = [], {}
    for wanted in laws or file.laws:
        law, _, interaction = wanted.partition(":")
        if law not in file.laws and law not in known_laws():
            faults.append(f"--laws: found {law}, allowed {', '.join(dict.fromkeys([*file.laws, *known_laws()]))}")
            continue
        changes = file.laws[law].overrides() if law in file.laws else {"servo.law": law}
        try:
            scenarios[wanted] = base.with_overrides({**changes, **({"servo.interaction": interaction} if interaction
                                                                   else {})})
        except ParameterError as error:
            faults += [f"law {wanted}: {fault}" for fault in error.faults]
    faults += [f"--tasks: found {task}, allowed {', '.join(file.tasks)}" for task in tasks if task not in file.tasks]
    if faults:
        raise ParameterError(faults)
    t_C, made = _target(base), []
    for name in tasks or file.tasks:
        task = file.tasks[name]
        X = pose_of(task.offset) if task.offset else tilted_goal(task.tilt, t_C, (0.0, 0.0, 1.0))[0]
        made.append(Task(name, task.title or name, X))
    name = f"{file.name}_{base.name}" if scenario else file.name
    return Comparison(name, file.description, scenarios, tuple(made))


def run_comparison(comparison: Comparison, workers: int = 1,
                   progress: Optional[Callable[[int, int], None]] = None) -> Results:
    """Runs every law on every task, in as many processes as there are `workers`, or for 0 in this one.

    `progress` is called with (laws done, all laws). A row of the results has the COLUMNS of sweep.judge.
    """
    scenarios, tasks = comparison.scenarios.values(), [comparison.tasks] * len(comparison.scenarios)

    def told(results):
        found = []
        for done, result in enumerate(results, start=1):
            found.append(result)
            if progress is not None:
                progress(done, len(scenarios))
        return found

    if not workers:
        found = told(map(_run_law, scenarios, tasks))
    else:
        with ProcessPoolExecutor(min(workers, len(tasks)), get_context("spawn"), processes.end_with_parent) as pool:
            try:
                # Not pool.map, which cancels what is left: a pool whose workers are killed trips over that.
                futures = [pool.submit(_run_law, *each) for each in zip(scenarios, tasks)]
                found = told(future.result() for future in futures)
            except KeyboardInterrupt:
                for process in pool._processes.values():  # their results are not wanted
                    process.kill()
                raise
    return [(task.name, law, row, track) for i, task in enumerate(comparison.tasks)
            for law, results in zip(comparison.scenarios, found) for row, track in [results[i]]]


def _run_law(scenario, tasks):
    """Runs all tasks of one law. Returns a list of (row, Track or None)."""
    bench, results = SweepRunner(scenario, images=False), []
    for start in starts_of(scenario, tasks):
        row, record = bench.run(start)
        results.append((row, record and track_of(record, Outline.of(placed(scenario, start)))))
    return results


def starts_of(scenario: Scenario, tasks: Sequence[Task]) -> List[Start]:
    """One `Start` for each `Task`, or the reason why the robot cannot begin there. Ids count from 1."""
    kinematics = scenario.kinematics(calibrated=False)
    goal, starts = scenario.goal_posture(kinematics), []
    feasibility = Feasibility(scenario, kinematics)
    for number, task in enumerate(tasks):
        joints, refusal = reach(kinematics, goal, kinematics.pose(goal) @ task.X_CgC)
        if joints is not None:
            refusal = feasibility.refusal(goal, kinematics.vector(joints))
        starts.append(Start(number + 1, joints, refusal=refusal))
    return starts


def known_comparisons() -> List[str]:
    """Names of the comparisons that come with the package, sorted."""
    return sorted(path.stem for path in (share_dir() / "config" / FOLDER).glob("*.yaml"))


def _find(name_or_path):
    path = Path(name_or_path).expanduser()
    if path.suffix not in (".yaml", ".yml"):
        path = share_dir() / "config" / FOLDER / f"{name_or_path}.yaml"
    if not path.is_file():
        raise ParameterError(f"comparison: found {name_or_path}, allowed the path of a YAML file, or one of "
                             f"{', '.join(known_comparisons())}")
    return path


def _target(scenario):
    """Position of the target in the goal camera, (3,) [m]. ParameterError if the scenario does not tell its outline."""
    outline = Outline.of(scenario)
    if outline is None:
        raise ParameterError(f"scenario '{scenario.name}': a task with tilt needs a flat target of known outline")
    kinematics = scenario.kinematics(calibrated=False)
    goal = scenario.goal_posture(kinematics)
    return np.linalg.solve(kinematics.pose(goal), outline.X_WT)[:3, 3]
