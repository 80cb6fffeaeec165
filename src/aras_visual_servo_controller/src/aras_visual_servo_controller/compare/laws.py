"""Several laws on the same tasks of one scenario: what is compared, and one run of it. No ROS.

A comparison file names a base scenario, tasks (where the camera starts) and laws (what each of them changes in the
scenario). Every run is a function of the file and its place in it: the same bytes on any core, in any order.
"""

from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path

import numpy as np

from ..config.reader import ConfigReader
from ..ground.errors import ParameterError
from ..ground.processes import end_with_parent
from ..scenario.feasibility import Feasibility
from ..arm.kinematics import Kinematics
from ..target.outline import Outline
from ..arm.reach import reach
from ..scenario.scenario import load_scenario
from ..config.files import load_yaml, share_dir
from ..sweep.plan import Start
from ..sweep.run import Bench, placed
from ..sweep.space import CAMERA_AXES, GOAL_AXES, pose_of, tilted_goal
from ..run.track import track_of

#: Sections of a scenario that a law may change.
SECTIONS = ("servo", "vision", "sim")
FOLDER = "comparisons"


@dataclass(frozen=True)
class Task:
    """One start.  name, title.  X_CgC: (4, 4) pose of the camera in that of the goal."""

    name: str
    title: str
    X_CgC: np.ndarray


@dataclass(frozen=True)
class Comparison:
    """A comparison file, checked.

    Attributes:
        name, description.  scenarios: law -> `Scenario`.  tasks: tuple of `Task`.
    """

    name: str
    description: str
    scenarios: dict
    tasks: tuple


def load_comparison(name_or_path, laws=(), tasks=(), overrides=None):
    """Load a comparison.

    Args:
        name_or_path: name of a file of config/comparisons, or path of a YAML file.
        laws, tasks: the names to compare, in this order; (): all of the file.  A law may be NAME:INTERACTION.
        overrides: dotted path -> value, for every law, as of `load_scenario`.
    Raises:
        ParameterError: every fault; unknown names list the known ones.
    """
    path = _find(name_or_path)
    reader = ConfigReader(load_yaml(path), str(name_or_path))
    name, scenario = (reader.texts(key, (), single=True) for key in ("name", "scenario"))
    description = reader.texts("description", "", single=True)
    for key, value in (("name", name), ("scenario", scenario)):
        if not value:
            reader.fault(f"{key}: found nothing, allowed a text")
    found_tasks, found_laws = _tasks(reader.section("tasks", True)), _laws(reader.section("laws", True))
    reader.finish()
    base = load_scenario(scenario, overrides)
    faults, scenarios = [], {}
    for wanted in laws or found_laws:
        law, _, interaction = wanted.partition(":")
        if law not in found_laws:
            faults.append(f"--laws: found {law}, allowed {', '.join(found_laws)}")
            continue
        changes = dict(found_laws[law], **({"servo.interaction": interaction} if interaction else {}))
        try:
            scenarios[wanted] = base.with_overrides(changes)
        except ParameterError as error:
            faults += [f"law {wanted}: {fault}" for fault in error.faults]
    faults += [f"--tasks: found {task}, allowed {', '.join(found_tasks)}" for task in tasks if task not in found_tasks]
    if faults:
        raise ParameterError(faults)
    t_C = _target(base)
    made = []
    for task in tasks or found_tasks:
        title, offset, tilt = found_tasks[task]
        X = pose_of(offset) if offset else tilted_goal(tilt, t_C, (0.0, 0.0, 1.0))[0]
        made.append(Task(task, title, X))
    return Comparison(name, description, scenarios, tuple(made))


def run_comparison(comparison, workers=1, progress=None):
    """Run every law on every task.

    Args:
        comparison: `Comparison`.  workers: processes; 0: this one.  progress: called with (done, total), or None.
    Returns:
        list of (task name, law name, row, `Track` or None) task by task; row as of `sweep_judge.COLUMNS`.
    """
    jobs = [(law, scenario, comparison.tasks) for law, scenario in comparison.scenarios.items()]
    total, done, by_law = len(jobs), 0, {}
    if workers:
        with ProcessPoolExecutor(min(workers, total), get_context("spawn"), end_with_parent) as pool:
            futures = [pool.submit(_run_law, job) for job in jobs]
            try:
                for law, future in zip(comparison.scenarios, futures):
                    by_law[law], done = future.result(), done + 1
                    if progress is not None:
                        progress(done, total)
            except KeyboardInterrupt:
                for process in pool._processes.values():  # nobody waits for what they are doing
                    process.kill()
                raise
    else:
        for job in jobs:
            by_law[job[0]], done = _run_law(job), done + 1
            if progress is not None:
                progress(done, total)
    return [(task.name, law, *by_law[law][i]) for i, task in enumerate(comparison.tasks) for law in by_law]


def _run_law(job):
    """All tasks of one law: list of (row, Track or None)."""
    _, scenario, tasks = job
    bench, results = Bench(scenario), []
    kinematics = Kinematics(scenario.urdf_xml(), scenario.robot["base_link"], scenario.robot["tip_link"])
    goal = scenario.goal_posture(kinematics)
    feasibility = Feasibility(scenario, kinematics)
    for number, task in enumerate(tasks):
        joints, refusal = reach(kinematics, goal, kinematics.pose(goal) @ task.X_CgC)
        refusal = refusal or feasibility.refusal(goal, kinematics.vector(joints))
        start = Start(number + 1, joints, refusal=refusal)
        row, record = bench.run(start)
        results.append((row, record and track_of(record, Outline.of(placed(scenario, start)))))
    return results


def known_comparisons():
    """Names of the comparisons that come with the package, sorted."""
    return sorted(path.stem for path in (share_dir() / "config" / FOLDER).glob("*.yaml"))


def _find(name_or_path):
    path = Path(name_or_path).expanduser()
    if path.suffix in (".yaml", ".yml"):
        if not path.is_file():
            raise ParameterError(f"comparison '{path}': no such file")
        return path
    path = share_dir() / "config" / FOLDER / f"{name_or_path}.yaml"
    if not path.is_file():
        raise ParameterError(f"comparison '{name_or_path}': not found, known are {', '.join(known_comparisons())} "
                             "(or give a path)")
    return path


def _tasks(section):
    """name -> (title, offset, tilt)."""
    found = {}
    for name in section.keys():
        task = section.section(name)
        parts = {}
        for key, axes in (("offset", CAMERA_AXES), ("tilt", GOAL_AXES)):
            part = task.section(key)
            parts[key] = {axis: part.number(axis) for axis in axes if axis in part.keys()}
            part.close()
        if bool(parts["offset"]) == bool(parts["tilt"]) or (parts["tilt"] and len(parts["tilt"]) != len(GOAL_AXES)):
            task.fault("allowed is either offset, or tilt with tilt_rad and about_rad")
        found[name] = (task.texts("title", name, single=True), parts["offset"], parts["tilt"])
        task.close()
    section.close()
    return found


def _laws(section):
    """name -> dotted overrides of the scenario."""
    found = {}
    for name in section.keys():
        law = section.section(name)
        found[name] = {}
        for part in law.keys():
            keys = law.section(part)
            if part not in SECTIONS:
                law.fault(f"{part}: unknown section, known are {', '.join(SECTIONS)}")
            found[name].update({f"{part}.{key}": keys.value(key) for key in keys.keys()})
            keys.close()
        law.close()
    section.close()
    return found


def _target(scenario):
    """(3,) where the goal camera sees the target [m]; ParameterError where that cannot be told."""
    outline = Outline.of(scenario)
    if outline is None:
        raise ParameterError(f"scenario '{scenario.name}': a task with tilt needs a flat target of known outline")
    kinematics = Kinematics(scenario.urdf_xml(), scenario.robot["base_link"], scenario.robot["tip_link"])
    goal = scenario.goal_posture(kinematics)
    return np.linalg.solve(kinematics.pose(goal), outline.X_WT)[:3, 3]
