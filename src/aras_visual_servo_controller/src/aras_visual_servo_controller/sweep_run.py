"""One run of a sweep, on any machine: a pure function of the scenario and the `Start`.

The arm is placed at the goal, settles, the view is taught; it is placed at the start, settles, and servos. Nothing
is driven there, which takes two thirds of an experiment (`drive_to_start: true` drives, as `run` does). A run ends when
the servo does, or once the target has been out of view for LOST_LIMIT_S: the arm stands still then.
"""

import ctypes
import hashlib
import os
import threading
import time
from collections import OrderedDict
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np

from .errors import ArasError, ParameterError
from .experiment import judge, pose_error
from .kinematics import Kinematics
from .loop import DEFAULT_LIMIT_S, ServoLoop
from .outline import Outline
from .record import RecordBuilder
from .run_measures import MEASURES, measures
from .scenario import resolve_uri, scenario_from_dict
from .sequence import ExperimentConfig
from .sweep_perturb import perturbed, simulator_key
from .sweep_plan import Start
from .sweep_space import CAMERA_AXES
from .types import FEATURE_NAMES, Status

#: A run has succeeded when this part of the initial distance is left, and less than this angle (the metric of recent
#: visual-servoing benchmarks) ...
SUCCESS_PART, SUCCESS_DEG = 0.1, 10.0
#: ... and strictly so when this is left.
STRICT_MM, STRICT_DEG = 1.0, 0.3
LOST_LIMIT_S = 1.0
#: Status that prevailed in the last part of a run that timed out.
LAST_PART_S = 1.0
#: Simulators kept by a worker: runs that differ in gains or start share one.
KEPT_SIMULATORS = 4

#: Columns of a run's result beside its start, and their type in SQLite.
COLUMNS = {
    "id": "INTEGER PRIMARY KEY", "outcome": "TEXT", "reason": "TEXT", "detail": "TEXT", "converged": "INTEGER",
    "success": "INTEGER", "success_strict": "INTEGER", "duration_s": "REAL", "images": "INTEGER",
    "distance0_mm": "REAL", "angle0_deg": "REAL", "x0_mm": "REAL", "y0_mm": "REAL", "z0_mm": "REAL",
    "error_mm": "REAL", "x_mm": "REAL", "y_mm": "REAL", "z_mm": "REAL", "angle_deg": "REAL",
    **dict.fromkeys(MEASURES, "REAL"), **{f"e_{name}": "REAL" for name in FEATURE_NAMES},
    "run_hash": "TEXT", "trace_hash": "TEXT",
}


class Infeasible(ArasError):
    """The start cannot be run; no fault of the law."""


class Bench:
    """Runs starts of one scenario, one after another.

    Args:
        scenario: `Scenario`.  drive_to_start: drive to goal and start as `run` does, instead of placing the arm.
    """

    def __init__(self, scenario, drive_to_start=False):
        self.scenario = scenario
        self.drive_to_start = drive_to_start
        self._simulators = OrderedDict()
        self._kinematics = None

    def run(self, start):
        """Run one start.

        Returns:
            (row, record): dict of COLUMNS, never raises for what goes wrong in a run; RunRecord, or None if infeasible
            or broken.
        """
        try:
            if start.refusal:
                raise Infeasible(start.refusal)
            parameters = dict(start.parameters)
            if self._noisy(parameters):  # every run its own noise
                parameters.setdefault("sim.seed", self.scenario.sim.get("seed", 0) + start.id)
            scenario = perturbed(self.scenario, parameters)
            scenario = placed(scenario, start)
            loop = ServoLoop(scenario, sim=self._simulator(scenario, parameters))
            builder = RecordBuilder(scenario.name, loop.kinematics.joint_names, settings=scenario.as_dict(),
                                    feature_names=loop.servo.feature_names)
            builder.note(f"start {start.id} of a sweep, the arm {'driven' if self.drive_to_start else 'placed'} there")
            for name, value in parameters.items():
                builder.note(f"sweep: {name} {value}")
            drive = self._drive if self.drive_to_start else self._place
            drive(loop, builder, start)
            self._servo(loop, builder)
            record = builder.finish(run_hash=loop.sim.run_hash, camera_info=loop.camera_info)
            lower, upper = loop.kinematics.lower, loop.kinematics.upper
            row = dict(judge_row(record), **measures(record, lower, upper, Outline.of(scenario)), id=start.id)
            return row, record
        except Infeasible as refusal:
            reason = str(refusal).partition(":")[0]
            return dict(self._empty(start), outcome="infeasible", reason=reason, detail=str(refusal)), None
        except Exception as error:  # whatever a run dies of is its result; the sweep goes on
            return dict(self._empty(start), outcome="error", reason=f"error: {type(error).__name__}",
                        detail=str(error)), None

    def _simulator(self, scenario, parameters):
        key = simulator_key(scenario, parameters)
        if key not in self._simulators:
            self._simulators[key] = ServoLoop(scenario).sim
            while len(self._simulators) > KEPT_SIMULATORS:
                self._simulators.popitem(last=False)
        self._simulators.move_to_end(key)
        return self._simulators[key]

    def _noisy(self, parameters):
        stddevs = [camera.get("noise_stddev", 0.0) for camera in self.scenario.sim["cameras"]]
        return parameters.get("noise_stddev", max(stddevs)) > 0.0

    @staticmethod
    def _place(loop, builder, start):
        config = ExperimentConfig.from_dict(loop.scenario.experiment, loop.kinematics)
        loop.place(config.goal, config.settle_s)
        try:
            record, features, image = loop.teach(config.z_star_m)
        except ParameterError as error:
            raise Infeasible(str(error)) from error
        builder.add_answer(record, loop.sim.camera_pose(loop.camera), features, image)
        loop.place(start.joints, config.settle_s)
        loop.start(servo_only=True)

    @staticmethod
    def _drive(loop, builder, start):
        loop.start()

    @staticmethod
    def _servo(loop, builder):
        lost_since_ns = None
        while not loop.sequence.done:
            record, features, image = loop.step()
            builder.add_answer(record, loop.sim.camera_pose(loop.camera), features, image)
            if record.status != Status.TARGET_LOST:
                lost_since_ns = None
            elif lost_since_ns is None:
                lost_since_ns = record.stamp_ns
            elif record.stamp_ns - lost_since_ns >= LOST_LIMIT_S * 1e9:
                return
            if record.stamp_ns >= DEFAULT_LIMIT_S * 1e9:
                raise ArasError(f"given up after {DEFAULT_LIMIT_S:g} s of simulated time in phase {record.phase}")
        status, reason = loop.sequence.result.status, loop.sequence.result.reason
        if loop.sequence.servo_stamp_ns is None:
            if status == Status.TARGET_LOST:
                raise Infeasible(reason.replace("where servoing starts", "at the start"))
            raise ArasError(reason)

    def _empty(self, start):
        row = dict.fromkeys(COLUMNS)
        row.update(id=start.id, success=0, success_strict=0, converged=0)
        try:
            if start.joints is not None:
                row.update(_initial(self._planned_error(start)))
            elif start.offset:
                offset = [start.offset.get(axis, 0.0) for axis in CAMERA_AXES]
                row.update(_initial({"x_mm": 1e3 * offset[0], "y_mm": 1e3 * offset[1], "z_mm": 1e3 * offset[2],
                                     "angle_deg": float(np.degrees(np.linalg.norm(offset[3:])))}))
        except ArasError:
            pass  # no robot, no distance: the reason is told already
        return row

    def _planned_error(self, start):
        """Error of the start by kinematics, for runs that never began."""
        if self._kinematics is None:
            robot = self.scenario.robot
            self._kinematics = Kinematics(self.scenario.urdf_xml(), robot["base_link"], robot["tip_link"])
        goal = {**dict.fromkeys(self._kinematics.joint_names, 0.0), **self.scenario.sim.get("initial_positions", {}),
                **placed(self.scenario, start).experiment["goal"]["joints"]}
        pose = self._kinematics.pose
        return pose_error(pose(self._kinematics.vector(goal)), pose(self._kinematics.vector(start.joints)))


def placed(scenario, start):
    """The scenario with the goal and the start of a run in place."""
    experiment = dict(scenario.experiment, start={"joints": dict(start.joints)})
    if not start.goal:
        return replace(scenario, experiment=experiment)
    experiment["goal"] = {"joints": dict(start.goal["joints"])}
    return replace(scenario, experiment=experiment,
                   servo=dict(scenario.servo, target_normal_C=list(start.goal["target_normal_C"])))


def judge_row(record):
    """Result of a run as a dict of COLUMNS, without id and MEASURES; a pure function of the record."""
    judgement = judge(record)
    error, row = judgement.final_error, dict.fromkeys(COLUMNS)
    row.update(_initial(judgement.initial_error))
    row.update({key: error[key] for key in ("x_mm", "y_mm", "z_mm", "angle_deg")})
    row["error_mm"] = _length(error)
    row["converged"] = int(judgement.converged)
    near_mm = max(SUCCESS_PART * row["distance0_mm"], STRICT_MM)  # a turn on the spot begins at no distance
    row["success"] = int(row["error_mm"] < near_mm and row["angle_deg"] < SUCCESS_DEG)
    row["success_strict"] = int(row["error_mm"] < STRICT_MM and row["angle_deg"] < STRICT_DEG)
    row.update(outcome="success" if row["success"] else "failure", reason=_reason(record, judgement, row["success"]),
               detail=judgement.reason, duration_s=judgement.duration_s, images=judgement.images,
               run_hash=record.run_hash, trace_hash=trace_hash(record))
    row.update({f"e_{name}": value for name, value in judgement.final_feature_error.items() if f"e_{name}" in COLUMNS})
    return row


def trace_hash(record):
    """SHA-256 of every number of the trace, hexadecimal: equal for equal runs, bit for bit."""
    digest = hashlib.sha256(",".join(record.phase).encode())
    for name in ("stamp_ns", "status", "s", "e", "twist", "q", "X_WC"):
        digest.update(np.ascontiguousarray(getattr(record, name)).tobytes())
    return digest.hexdigest()


def _reason(record, judgement, success):
    rows = record.servo_rows
    status = record.status[rows]
    last = Status(status[-1])
    if judgement.converged:
        return "converged" if success else "converged elsewhere"
    if last == Status.TARGET_LOST:
        return "target lost"
    if last == Status.TIMED_OUT:
        part = status[:-1][record.t_s[rows[:-1]] >= record.t_s[rows[-1]] - LAST_PART_S]
        counts = np.bincount(part) if len(part) else np.zeros(1)
        names = {Status.JOINT_LIMIT: ", at a joint limit", Status.NEAR_SINGULARITY: ", at a singularity",
                 Status.TARGET_LOST: ", target lost"}
        return "timed out" + names.get(int(np.argmax(counts)), "")
    return last.name.lower().replace("_", " ")


def _initial(error):
    return {"distance0_mm": _length(error), "angle0_deg": error["angle_deg"], "x0_mm": error["x_mm"],
            "y0_mm": error["y_mm"], "z0_mm": error["z_mm"]}


def _length(error):
    return float(np.sqrt(error["x_mm"] ** 2 + error["y_mm"] ** 2 + error["z_mm"] ** 2))


# --- on workers -------------------------------------------------------------------------------------------------


def make_setup(scenario, drive_to_start):
    """What a worker must know of a sweep: a plain dict, with the hash of the files it must have too."""
    return {"scenario": scenario.as_dict(), "base": str(scenario._base or "."), "path": str(scenario.path or ""),
            "drive_to_start": bool(drive_to_start), "files": files_hash(scenario)}


def files_hash(scenario):
    """SHA-256 of robot, controllers and models of a scenario, hexadecimal."""
    digest = hashlib.sha256(scenario.urdf_path.read_bytes() + scenario.controllers_path.read_bytes())
    for model in scenario.sim.get("scene", {}).get("models", []):
        if "file" in model:
            digest.update(resolve_uri(model["file"], scenario._base).read_bytes())
    return digest.hexdigest()


def scenario_of(setup):
    """The scenario of `make_setup`. Raises ParameterError if this machine's files are others."""
    path = Path(setup["path"]) if setup["path"] else None
    scenario = scenario_from_dict(setup["scenario"], source=setup["scenario"]["name"], base=Path(setup["base"]),
                                  path=path)
    if files_hash(scenario) != setup["files"]:
        raise ParameterError("robot, controllers or target files differ from those the sweep was begun with: "
                             f"{scenario.urdf_path}, {scenario.controllers_path}")
    return scenario


def run_chunk(setup, starts):
    """Run some starts; what a worker calls.

    Args:
        setup: of `make_setup`.  starts: list of dicts, fields of `Start`.
    Returns:
        list of (row, wall_s).
    Raises:
        ParameterError: this machine cannot run the sweep at all.
    """
    bench = _bench(setup)
    results = []
    for start in starts:
        began_s = time.perf_counter()
        row, _ = bench.run(Start(**start))
        results.append((row, time.perf_counter() - began_s))
    return results


def plain(start):
    """A Start as a plain dict."""
    return asdict(start)


_kept = threading.local()  # simulators belong to one thread


def _bench(setup):
    if getattr(_kept, "setup", None) != setup:
        _keep_memory()
        _kept.bench, _kept.setup = Bench(scenario_of(setup), setup["drive_to_start"]), setup
    return _kept.bench


def _keep_memory():
    """Undo what Dask asks of glibc on its workers, to return every freed image to the system: 10 000 page faults and
    two thirds more time a run. M_TRIM_THRESHOLD is -1, M_MMAP_THRESHOLD -3 (malloc.h); 32 MiB is the most it takes."""
    if "MALLOC_TRIM_THRESHOLD_" in os.environ:
        mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
        if mallopt is not None:
            mallopt(-1, 256 * 2 ** 20)
            mallopt(-3, 32 * 2 ** 20)
