"""One run of a sweep. Its result depends on the scenario and the `Start` alone, not on the machine.

The arm is placed at the goal, settles there, and the view is taught; then it is placed at the start, settles and
servos. To drive to these places, as `run` does, takes two thirds of an experiment; only `drive_to_start: true` does so.
A run ends with the servo, or when the target has been out of view for LOST_LIMIT_S: the arm stands still by then.
"""

from collections import OrderedDict
from dataclasses import fields, replace
from typing import Any, Dict, Optional, Tuple

import numpy as np

from aras_visual_servo import (CAMERA_AXES, DEFAULT_LIMIT_S, ArasError, Outline, ParameterError, RecordBuilder,
                               RunRecord, Scenario, ServoLoop, Status, code_place, measures, pose_error)
from .judge import COLUMNS, initial_columns, judge_row
from .metrics import judge_by
from .perturb import perturbed, put_clutter, simulator_key, swap_picture
from .plan import Start

LOST_LIMIT_S = 1.0
#: A worker keeps this many simulators. Runs that differ only in gains or start share one.
KEPT_SIMULATORS = 4
#: Parameters of a start with which its run changes the scene. The reset before the next run undoes that.
CHANGING = frozenset(("picture", "clutter", "scene"))


class Infeasible(ArasError):
    """The start cannot be run, which is not the fault of the law."""


class _Shared:
    """A simulator that runs use in turn, and what they need not find out each for itself.

    Attributes:
        outline, settings: `Outline` and nested dict of the scenario of the last loop.
        goal: `TaughtGoal` from which the last loop has gone on, None if it begins at the very start.
    """

    def __init__(self, scenario):
        self._read(scenario)

    def _read(self, scenario, sim=None):
        self._loop, self.outline, self.goal = ServoLoop(scenario, sim=sim), Outline.of(scenario), None
        self.settings = scenario.as_dict()

    def loop(self, scenario, anew):
        """`ServoLoop` of the scenario.

        Where the scenario differs from the last one in `experiment` alone, nothing else of it is read again. Where it
        differs in the start alone, the loop goes on from the goal that a run before has taught: to teach it again gives
        the same bytes and takes as long as fifteen images of servoing.

        Args: anew: the run changes the scene or drives to its goal. It begins with a reset, and so does the next one.
        """
        last, self._anew = self._loop.scenario, anew
        if not _differs_in_experiment_alone(scenario, last):
            self._read(scenario, self._loop.sim)
            return self._loop
        if anew or dict(scenario.experiment, start=None) != dict(last.experiment, start=None):
            self.goal = None
        self._loop.begin_again(scenario, self.goal)
        self.settings = dict(self.settings, experiment=scenario.experiment)
        return self._loop

    def keep_goal(self):
        """Let the next runs go on from the goal that the last loop has just taught, where that is possible."""
        self.goal = None if self._anew else self._loop.taught_goal()


class SweepRunner:
    """Runs starts of one scenario, one after another.

    Args: drive_to_start: drive the arm to goal and start as `run` does, instead of placing it there.
        images: keep the taught view, the first and the last one in the records; rows do not depend on it.
    """

    def __init__(self, scenario: Scenario, drive_to_start: bool = False, images: bool = True) -> None:
        self.scenario = scenario
        self.drive_to_start, self._images = drive_to_start, images
        self._simulators = OrderedDict()  # key -> _Shared
        self._key = simulator_key(scenario, {})
        self._kinematics = None

    def run(self, start: Start) -> Tuple[Dict[str, Any], Optional[RunRecord]]:
        """Runs one start. Returns (row, record): dict of COLUMNS, and None if the run was infeasible or broke off.

        Whatever goes wrong in a run is told in its row and not raised.
        """
        try:
            if start.refusal:
                raise Infeasible(start.refusal)
            parameters = dict(start.parameters)
            if self._noisy(parameters):  # every run has its own noise
                parameters.setdefault("sim.seed", self.scenario.sim.get("seed", 0) + start.id)
            scenario = perturbed(self.scenario, parameters)
            scenario = placed(scenario, start)
            shared = self._simulator(scenario, parameters)
            loop = shared.loop(scenario, anew=self.drive_to_start or not CHANGING.isdisjoint(parameters))
            builder = RecordBuilder(scenario.name, loop.kinematics.joint_names, settings=shared.settings,
                                    feature_names=loop.servo.feature_names)
            builder.note(f"start {start.id} of a sweep, the arm {'driven' if self.drive_to_start else 'placed'} there")
            for name, value in parameters.items():
                builder.note(f"sweep: {name} {value}")
            if self.drive_to_start:
                self._drive(loop, start)
            else:
                self._place(loop, builder, start, shared)
            self._servo(loop, builder, start)
            record = builder.finish(run_hash=loop.sim.run_hash, camera_info=loop.camera_info,
                                    X_WT=loop.target_pose(), opengl=loop.sim.opengl)
            lower, upper = loop.kinematics.lower, loop.kinematics.upper
            row = dict(judge_row(record), **measures(record, lower, upper, shared.outline), id=start.id)
            return row, record
        except Infeasible as refusal:
            reason = str(refusal).partition(":")[0]
            return dict(self._empty(start), outcome="infeasible", reason=reason, detail=str(refusal)), None
        except Exception as error:  # whatever stops a run is its result; the sweep goes on
            return dict(self._empty(start), outcome="error", reason=f"error: {type(error).__name__}",
                        detail=f"{code_place(error)}{error}"), None

    def _simulator(self, scenario, parameters):
        key = simulator_key(scenario, parameters) if parameters else self._key
        if key not in self._simulators:
            self._simulators[key] = _Shared(scenario)
            while len(self._simulators) > KEPT_SIMULATORS:
                self._simulators.popitem(last=False)
        self._simulators.move_to_end(key)
        return self._simulators[key]

    def _noisy(self, parameters):
        stddevs = [camera.get("noise_stddev", 0.0) for camera in self.scenario.sim["cameras"]]
        return parameters.get("noise_stddev", max(stddevs)) > 0.0

    def _place(self, loop, builder, start, shared):
        config = loop.sequence.config
        if shared.goal is None:
            if "scene" in start.parameters:
                put_clutter(loop.sim, loop.scenario, start.parameters["scene"])
            loop.place(config.goal.joints, config.settle_s)
            try:
                for answer in loop.teach(config.z_star_m):
                    self._add(builder, *answer)
            except ParameterError as error:
                raise Infeasible(str(error)) from error
            shared.keep_goal()
        else:
            for answer in shared.goal.answers:
                self._add(builder, *answer)
        if "picture" in start.parameters:
            swap_picture(loop.sim, loop.scenario, start.parameters["picture"])
        if "clutter" in start.parameters:
            put_clutter(loop.sim, loop.scenario, start.parameters["clutter"])
        loop.place(start.joints, config.settle_s)
        loop.start(servo_only=True)

    @staticmethod
    def _drive(loop, start):
        for name in start.parameters:
            if name in CHANGING:
                raise Infeasible(f"{name}: allowed without drive_to_start, where the bench teaches the goal")
        loop.start()

    def _add(self, builder, record, X_WC, features, image, X_WT):
        builder.add_answer(record, X_WC, features, image if self._images else None, X_WT)

    def _servo(self, loop, builder, start):
        lost_since_ns, farthest_mm, factor = None, np.inf, self.scenario.sweep.get("abort_factor")
        if factor is not None:
            X_WCg = self._goal_pose(start)
            farthest_mm = factor * initial_columns(self._planned_error(start))["distance0_mm"]
        while not loop.sequence.done:
            record, features, image = loop.step()
            X_WC = loop.camera_pose()
            too_far = factor is not None and self._distance_mm(loop, X_WCg) > farthest_mm
            if too_far:
                record.status, record.status_text = Status.STOPPED, f"farther than {factor:g} times the start"
            self._add(builder, record, X_WC, features, image, loop.moving_target_pose())
            if too_far:
                return
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
        row.update(id=start.id, converged=0, **judge_by(None))
        try:
            if start.joints is not None:
                row.update(initial_columns(self._planned_error(start)))
            elif start.offset:
                offset = [start.offset.get(axis, 0.0) for axis in CAMERA_AXES]
                angle_deg = float(np.degrees(np.linalg.norm(offset[3:])))
                row.update(initial_columns({"x_mm": 1e3 * offset[0], "y_mm": 1e3 * offset[1], "z_mm": 1e3 * offset[2],
                                            "angle_deg": angle_deg}))
        except ArasError:
            pass  # the distance is unknown; the row tells already why there was no run
        return row

    def _distance_mm(self, loop, X_WCg):
        """Distance of the camera, at the last image, from where the kinematics have the goal [mm]."""
        X_WC = self._kinematics.pose(loop.seen.q) if loop.eye_to_hand else loop.camera_pose()
        return 1e3 * np.linalg.norm(X_WC[:3, 3] - X_WCg[:3, 3])

    def _planned_error(self, start):
        """`pose_error` of the start by kinematics."""
        goal = self._goal_pose(start)
        return pose_error(goal, self._kinematics.pose(self._kinematics.vector(start.joints)))

    def _goal_pose(self, start):
        """X_WCg, (4, 4), by kinematics."""
        if self._kinematics is None:
            self._kinematics = self.scenario.kinematics(calibrated=False)
        return self._kinematics.pose(placed(self.scenario, start).goal_posture(self._kinematics))


def _differs_in_experiment_alone(scenario, other):
    """Whether these two, as `perturbed` and `placed` make them, are the same but for `experiment`."""
    def others(of):
        return type(of), [getattr(of, each.name) for each in fields(of) if each.name != "experiment"]

    return others(scenario) == others(other)


def placed(scenario: Scenario, start: Start) -> Scenario:
    """The scenario with the goal and the start of a run put in."""
    experiment = dict(scenario.experiment, start={"joints": dict(start.joints or {})})
    if not start.goal:
        return replace(scenario, experiment=experiment)
    experiment["goal"] = {"joints": dict(start.goal["joints"])}
    return replace(scenario, experiment=experiment,
                   servo=dict(scenario.servo, target_normal_C=list(start.goal["target_normal_C"])))
