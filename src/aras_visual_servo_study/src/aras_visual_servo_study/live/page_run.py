"""A run as pages see and change it. `run.LiveRun` is the backend in this process, `over_ros.RosRun` that over ROS."""

import math
import re
from dataclasses import replace
from functools import partial
from typing import Any, Callable, Dict, List, Optional, Sequence, Set, Tuple

import numpy as np
import yaml

from aras_visual_servo import (JOINT_HALF_WIDTH, TWIST_NAMES, Feasibility, Features, ParameterError, ReachMap,
                               RobotKinematics, Scenario, Servo, ServoRecord, Status, known_features, known_laws,
                               reach_map, scenario_schema, spatial, styles, works_on)
from .aftermath import MOVED_ARM, TAUGHT, Aftermath, last_servo
from .advice import Moment, Seen, advice, limit_joint
from .editor import LawEditor
from .following import Following
from .hand import Hand
from .offers import offer_for
from .settings import AT_ONCE, changed
from .swings import Swings
from .view.projection import project
from .view.scene import drawn, pose_numbers

QUIET = ("idle", "done")
#: The end of a name that stands for a number, as in xN, the first coordinate of point N.
NUMBERED = re.compile("N$")
#: How many random starts are tried to find one from which the target is in view.
MOST_STARTS = 200
#: A camera that stays farther away than this is no matter of the map of the reach [m].
MOST_MISSING_M = 1.0
#: Columns of a row that hold the poses of camera and target.
POSES = ("x", "y", "z", *(f"camera.{name}" for name in ("qx", "qy", "qz", "qw")),
         *(f"target.{name}" for name in ("x", "y", "z", "qx", "qy", "qz", "qw")))
NO_POSE = (None,) * 7


class PageRun:
    """Base class of the backends: what is told to pages, and the checks of what they ask for.

    A backend calls `renew`, keeps the attributes below up to date, and implements what is missing here, as `LiveRun`.

    Attributes:
        scenario: as it stands now.  used: as it was when the last image was answered.
        target: name of the target, or None.  watched: whether a page is ready for news.
        record: of the last image, or None.  X_WC: (4, 4) of the camera then.  image, features: the newest ones or None.
        goal: (image, marks, pose numbers) of the taught view, or None.
        starts: how many servos were begun, where the backend knows.
        editor: of the law that pages write, or None.
        version: grows whenever `about` would say something else.  images: how many came so far.
    """

    at_once: Sequence[str] = AT_ONCE
    asks_nodes, ready = False, True

    def __init__(self, scenario: Scenario) -> None:
        self.scenario, self.version, self.images, self.watched = scenario, 0, 0, False
        self.used = scenario
        self._draws = self.starts = 0
        self.editor: Optional[LawEditor] = None
        # A target that the arm carries moves with every motion of the arm: there is nothing to follow.
        self.follow = scenario.robot.get("target_link") is None

    def renew(self, kinematics: RobotKinematics, servo: Servo, camera_info: Dict[str, Any],
              target: Optional[str]) -> None:
        """Begins anew, with nothing seen and nothing taught."""
        self.kinematics, self.servo, self.camera_info, self.target = kinematics, servo, camera_info, target
        self.hand, self.following = Hand(kinematics), Following()
        self.aftermath, self.swings = Aftermath(kinematics), Swings()
        self.record: Optional[ServoRecord] = None
        self.image: Optional[np.ndarray] = None
        self.features: Optional[Features] = None
        self.goal: Optional[Tuple[np.ndarray, Dict[str, Any], List[float]]] = None
        self._view: Optional[Tuple[np.ndarray, np.ndarray]] = None
        self.X_WC, self.taught, self._marked, self._marks = np.eye(4), False, None, {}
        self._seen: Optional[Seen] = None
        self._advised: Optional[Tuple[Status, str, str, bool]] = None
        self._advice = "", ""
        self._last: Optional[Tuple[int, np.ndarray]] = None
        self._ended = Status.IDLE
        self.waiting: Set[str] = set()
        self.version += 1

    @property
    def phase(self) -> str:
        """Returns the phase of the run, one of `ServoRecord.phase`."""
        return "idle" if self.record is None else self.record.phase

    # --- what pages are told --------------------------------------------------------------------------------------

    def about(self) -> Dict[str, Any]:
        """Returns, for JSON, what a page has to know before anything moves, and again when `version` has grown."""
        features = [{"name": style.name, "symbol": style.symbol, "label": style.label, "unit": style.unit,
                     "factor": style.factor, "read_unit": style.read_unit, "colour": style.colour,
                     "threshold": threshold}
                    for style, threshold in zip(styles(self.servo.feature_names), self.servo.config.thresholds)]
        rows = ["t", *(f"e.{name}" for name in self.servo.feature_names), *(f"v.{name}" for name in TWIST_NAMES),
                *(f"q.{name}" for name in self.kinematics.joint_names), "condition", "manipulability",
                "real_time_factor", *POSES, "u", "v", "image", "status", "servo", "limited"]
        return {
            **drawn(self.scenario, self.kinematics, self.camera_info, self.camera_pose()[:3, 3], self.target_pose(),
                    self.target),
            "statuses": [status.name for status in Status],
            "draws_starts": not self.asks_nodes, "features": features, "lessons": self.lessons(),
            "editor": None if self.editor is None else {"text": self.editor.text},
            "scenario": self.scenario.name, "description": self.scenario.description,
            "rows": rows, "schema": scenario_schema()["properties"], "at_once": list(self.at_once),
            "choices": {"servo.law": known_laws(), "servo.features": known_features()},
            "works_on": {name: works_on(name) for name in known_laws()},
            "known": [{"name": style.name, "symbol": style.symbol, "label": style.label}
                      for style in styles([NUMBERED.sub("1", name) for name in known_features()])],
            "version": self.version,
            **self.standing()}

    def lessons(self) -> List[Dict[str, Any]]:
        """Returns, for JSON, the lessons that this backend can give."""
        return []

    def standing(self) -> Dict[str, Any]:
        """Returns the part of `about` that changes with every setting: values, which wait for a reset, and by path the
        ends that other settings make (rounded down)."""
        ends = {f"sim.cameras.{i}.latency_s": math.floor(1e4 * longest_s) / 1e4
                for i, longest_s in enumerate(self.scenario.longest_latencies)}
        return {"values": self.scenario.as_dict(), "waiting": sorted(self.waiting), "ends": ends}

    def row(self, real_time_factor: float) -> List[Optional[float]]:
        """Returns the numbers of the last image that curves show (`rows` of `about`), None where one does not exist.

        limited: place of the joint whose limit holds the arm back.
        """
        record, centre = self.record, self.marks()["centre"]
        if centre is not None:
            self._seen = Seen(*centre)
        numbers = [record.stamp_ns * 1e-9, *record.e, *record.twist, *record.q, record.cond_l, record.manipulability,
                   real_time_factor]
        poses = pose_numbers(self.X_WC) or NO_POSE, pose_numbers(self.target_pose()) or NO_POSE
        return [*(rounded(x) for x in numbers), *poses[0], *poses[1],
                *(centre or (None, None)), self.images, int(record.status), int(record.phase == "servo"),
                self._limited()]

    def _limited(self) -> Optional[int]:
        assert self.record is not None
        names = self.kinematics.joint_names
        name = limit_joint(self.record.status, self.record.status_text)
        return names.index(name) if name in names else None

    def state(self) -> Dict[str, Any]:
        """Returns what moves, for JSON. ended, since: status of the last servo and what has changed since, or ""."""
        record = self.record
        return {"t": round(self.time_ns * 1e-9, 4), "q": [rounded(x) for x in self.joints()],
                "camera": pose_numbers(self.camera_pose()), "target": pose_numbers(self.target_pose()),
                "s": [] if self.record is None else [rounded(x) for x in self.record.s],
                "phase": self.phase, "taught": self.taught, "frame": self.frame, "follow": self.follow,
                "ended": self._ended.name if self.aftermath.change else "", "since": self.aftermath.change,
                **self.why(record.status if record else Status.IDLE, record.status_text if record else "")}

    def why(self, status: Status, text: str) -> Dict[str, str]:
        """Returns, for JSON, why the run is where it is (status, text), and what a user can do now (kind, advice)."""
        q, moment = self.joints(), (status, text, self.phase, self.swings.found)
        if self._advised != moment and q is not None:
            size = self.camera_info["width"], self.camera_info["height"]
            self._advised = moment
            self._advice = advice(Moment(*moment[:3], self.kinematics, q, size, self._seen, self._away(), moment[3]))
        kind, now = self._advice
        return {"status": status.name, "text": text, "kind": kind, "advice": now}

    def _away(self) -> Optional[np.ndarray]:
        """(4, 4): what brings the target back to where it was taught, in the camera's frame: the way of its origin, and
        its turn. None without a target, or before a goal was taught."""
        X_WT = self.target_pose()
        if self._view is None or X_WT is None:
            return None
        R_WC, taught = self.camera_pose()[:3, :3], self._view[1]
        away = np.eye(4)
        away[:3, 3] = R_WC.T @ (taught[:3, 3] - X_WT[:3, 3])
        away[:3, :3] = R_WC.T @ taught[:3, :3] @ X_WT[:3, :3].T @ R_WC
        return away

    def marks(self) -> Dict[str, Any]:
        """Returns what is drawn into the last image, see `marks_of`."""
        if self._marked != (self.images, id(self.features)):
            self._marked, self._marks = (self.images, id(self.features)), marks_of(self.features, self.camera_info)
        return self._marks

    # --- what backends tell ---------------------------------------------------------------------------------------

    def keep_goal(self, X_WC: np.ndarray) -> None:
        """Keeps the last image, taken from X_WC, (4, 4), as the taught one."""
        self.taught, X_WT = True, self.target_pose()
        self._view = None if X_WT is None else (X_WC, X_WT)
        if self.image is not None:
            self.goal = np.array(self.image), self.marks(), pose_numbers(X_WC)

    def of_now(self, record: ServoRecord, q: np.ndarray, X_WT: Optional[np.ndarray],
               e: Optional[np.ndarray] = None) -> ServoRecord:
        """Returns the record of an answered image, which after a servo repeats its end, with what holds now.

        Args: q: (n,) joints and X_WT: (4, 4) target of this image, None: not known.  e: (k,) errors; None: not known.
        """
        before, self._last = self._last, (record.stamp_ns, q)
        self.swings.take(record, X_WT)
        end = self.starts, record.status, record.status_text
        self.aftermath.take(record.phase, end, record.stamp_ns, q, X_WT, self.servo.config.thresholds)
        if record.phase == "done" and not self.aftermath.over or record.phase not in QUIET:
            self._ended = record.status
            return record
        change = self.aftermath.change
        if e is not None:
            dt_s = 0.0 if before is None else 1e-9 * (record.stamp_ns - before[0])
            moved = np.zeros(len(q)) if before is None or dt_s <= 0.0 else self.kinematics.way(before[1], q) / dt_s
            record = replace(record, q=q, e=e, twist=self.kinematics.jacobian(q) @ moved)
        elif change:
            record = replace(record, q=q, e=np.full(len(record.e), math.nan), twist=np.full(6, math.nan))
        if change:
            record = replace(record, status=Status.IDLE, converged=False, status_text=last_servo(self._ended, change))
        return record

    def begin_again(self, record: ServoRecord, X_WT: Optional[np.ndarray], follow: bool) -> bool:
        """Returns whether the servo is to begin again, because the target has moved since it ended.

        Args: X_WT: (4, 4), of the target at the image of the record; None: not known.
        """
        return X_WT is not None and self.following.answered(record.phase, record.status, X_WT, follow)

    def drive_by_hand(self, stamp_ns: int) -> None:
        """Moves the joints that are driven by hand a little farther."""
        positions = self.hand.walk(stamp_ns)
        if positions:
            self.command(positions, stamp_ns)

    # --- what pages ask for ---------------------------------------------------------------------------------------

    def do(self, request: Any) -> Any:
        """Answers a request of live/messages.py: dict for the page, {} if there is no more to say than that it is done.
        An answer that takes seconds is a function that returns the dict: `Runner` calls it beside the run.

        Raises: ArasError: it cannot be done; nothing has changed.
        """
        return getattr(self, "do_" + request.do)(request) or {}

    def _quiet(self, do: str) -> None:
        if self.phase not in QUIET:
            raise ParameterError(f"{do}: found the run in phase {self.phase}, allowed when it is stopped")

    def do_teach(self, request: Any) -> Optional[Dict[str, Any]]:
        self._quiet("teach")
        answer = self.teach(request.z_star_m)
        self.following.taught()
        self.aftermath.note(TAUGHT)
        return answer

    def do_follow(self, request: Any) -> None:
        self.follow = request.follow

    def do_place_target(self, request: Any) -> None:
        length = math.sqrt(sum(x * x for x in request.q_xyzw))
        if self.target is None:
            raise ParameterError("place_target: the scene has no target")
        if not 0.99 < length < 1.01:
            raise ParameterError(f"place_target.q_xyzw: found a length of {length:.4g}, allowed 1")
        self.place_target(list(request.position_m), [x / length for x in request.q_xyzw])

    def do_reach(self, _request: Any) -> Callable[[], Dict[str, Any]]:
        """Returns a function that takes seconds, and answers with the `ReachMap` for JSON.

        pose: of the plane.  first_m, step_m: [x, y] on it.  missing_mm: rows along y of how far the camera stays away,
        rounded up, 0 within reach.
        """
        X_WT, q = self.target_pose(), self.joints()
        if self._view is None or X_WT is None or q is None:
            raise ParameterError("reach: found no taught goal; teach a view of the target first")
        if not self.kinematics.spare_motion or self.scenario.robot.get("target_link") is not None:
            raise ParameterError("reach: found a camera that flies, or a target that the arm carries; allowed an arm "
                                 "that carries the camera")
        found = partial(reach_map, self.scenario, self.kinematics, self.servo, *self._view, X_WT, np.array(q))
        return lambda: reach_message(found())

    def do_move_target(self, request: Any) -> None:
        if self.target is None:
            raise ParameterError("move_target: the scene has no target")
        self.move_target(request.motion)

    def do_joint(self, request: Any) -> None:
        self._quiet("joint")
        self.hand.hold(request.name, request.position, self.joints())
        self.aftermath.note(MOVED_ARM)

    def do_lesson(self, _request: Any) -> Optional[Dict[str, Any]]:
        raise ParameterError("lesson: found a run over ROS, allowed one in process (aras-servo live)")

    do_try_lesson = do_lesson

    def do_write_law(self, _request: Any) -> Dict[str, Any]:
        raise ParameterError("write_law: found a run without an editor, allowed one of `aras-servo live --edit`")

    def do_offer(self, request: Any) -> Dict[str, Any]:
        offer = offer_for(self.scenario, request.law)
        # A goal that was taught with one source of features does not tell what another would see.
        source = Servo(self.kinematics, changed(self.scenario, offer["values"]).servo).source
        return {**offer, "reset": offer["reset"] or source is not self.servo.source}

    def do_draw_start(self, _request: Any) -> Dict[str, Any]:
        """Answers with joints drawn evenly about the goal's, within `JOINT_HALF_WIDTH`; the first that are feasible."""
        scenario = changed(self.scenario, {"name": self.scenario.name, **self._target_values()})
        feasibility, goal = Feasibility(scenario, self.kinematics), scenario.goal_posture(self.kinematics)
        self._draws += 1
        draws = np.random.default_rng(self._draws)
        for _ in range(MOST_STARTS):
            start = goal + JOINT_HALF_WIDTH * draws.uniform(-1.0, 1.0, len(goal))
            if not feasibility.refusal(goal, start):
                return {"start": {"joints": {name: round(q, 4) for name, q in self.kinematics.by_name(start).items()}}}
        raise ParameterError(f"draw_start: none of {MOST_STARTS} starts within {JOINT_HALF_WIDTH:g} m or rad of the "
                             "goal shows the target; allowed is a target that is in view at the goal")

    def _target_values(self):
        """Dotted path -> value of a scenario whose target, if it rests, is where it is now."""
        X_WT, values = self.target_pose(), {}
        for i, model in enumerate(self.scenario.sim.get("scene", {}).get("models", []) if X_WT is not None else ()):
            if model["name"] == self.target and {"motion", "attached_to"}.isdisjoint(model):
                values[f"sim.scene.models.{i}.position_m"] = [round(float(x), 6) for x in X_WT[:3, 3]]
                values[f"sim.scene.models.{i}.rpy_rad"] = [round(x, 7) for x in spatial.rpy_of(X_WT[:3, :3])]
        return values

    def do_save(self, request: Any) -> Dict[str, Any]:
        """Answers with the scenario file: the target where it is and, if asked for, the start where the arm is."""
        scenario, values = self.scenario, {"name": request.name, **self._target_values()}
        for key, path in (("urdf", scenario.urdf_path), ("controllers", scenario.controllers_path)):
            given = scenario.robot[key]
            values[f"robot.{key}"] = given if given.startswith("package://") else str(path.resolve())
        if request.start_here:
            values["experiment.start"] = {"joints": {
                name: round(float(x), 7) for name, x in zip(self.kinematics.joint_names, self.joints())}}
        content = changed(scenario, values).as_dict()
        return {"yaml": f"# Saved from the live page, from the scenario {scenario.name}.\n" + yaml.safe_dump(
            content, sort_keys=False, allow_unicode=True, default_flow_style=None)}


def reach_message(found: ReachMap) -> Dict[str, Any]:
    """Returns the map for JSON, as `PageRun.do_reach` says."""
    mm = np.ceil(1e3 * np.minimum(found.missing_m, MOST_MISSING_M)).astype(int)
    return {"pose": pose_numbers(found.X_WP), "first_m": found.first_m.tolist(), "step_m": found.step_m.tolist(),
            "missing_mm": mm.tolist()}


def marks_of(features: Optional[Features], camera_info: Dict[str, Any]) -> Dict[str, Any]:
    """Returns what is drawn into an image [px]: centre [u, v] or None, axis [rad] or None, points [[u, v], ...]."""
    if features is None or not features.target_visible:
        return {"centre": None, "axis": None, "points": []}
    xy = [(features.xg, features.yg), *zip(features.point_x, features.point_y)]
    pixels = [[round(float(u), 2), round(float(v), 2)] if math.isfinite(u) and math.isfinite(v) else None
              for u, v in project(np.array(xy, dtype=float), camera_info)]
    return {"centre": pixels[0], "axis": rounded(features.alpha), "points": [p for p in pixels[1:] if p]}


def rounded(value: float) -> Optional[float]:
    """Returns the value with the six digits that a screen shows; None if it is not finite, as JSON has no NaN."""
    return float(f"{value:.6g}") if math.isfinite(value) else None
