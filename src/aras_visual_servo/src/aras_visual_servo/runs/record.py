"""RunRecord: the data of one run, one row per image.

The in-process loop fills it row by row with a `RecordBuilder`, and so does the reader of rosbags. The judge, the
figures and the reports read nothing else. It holds no wall time except `wall_s`.
"""

from dataclasses import dataclass, field
from functools import cached_property
from operator import attrgetter
from typing import Any, Dict, Mapping, Optional, Sequence

import numpy as np

from ..ground.errors import ShapeError
from ..ground.images import eight_bit
from ..ground.types import FEATURE_NAMES, FINAL
from ..spatial import inverse, mean_pose, plane_depth, size_of
from .settings import still

TWIST_NAMES = ("vx", "vy", "vz", "wx", "wy", "wz")
RAW_NAMES = ("area", "xg", "yg", "alpha")

# Quantities of the stop rule besides the feature errors, and the condition of the interaction matrix.
STOP_NAMES = ("tilt_rad", "position_m", "rotation_rad", "cond_l")

#: A depth that is off by more than this part of the true one is noted.
DEPTH_OFF = 0.1

_RAW = attrgetter(*RAW_NAMES)


@dataclass(frozen=True)
class RunRecord:
    """Data of one run: n images, k features, m joints. Missing values are NaN, missing images None.

    Attributes:
        scenario: name of the scenario.
        settings: the scenario as a nested dict (`Scenario.as_dict`), {} if unknown.
        joint_names: m names, sorted: the columns of q and set_point.  feature_names: k names.
        stamp_ns: (n,) int64, simulated time of the state each image shows [ns].
        phase: (n,) str, one of types.PHASES.  status: (n,) int, codes of ServoState.  status_text: (n,) str.
        s, s_star, e: (n, k), features, reference, e = s - s_star, in the features' units (features.styles).
        twist: (n, 6), commanded V_C = [v; w] in the camera frame [m/s, rad/s].
        q: (n, m) measured at the stamp, set_point: (n, m) sent in answer [m or rad].
        raw: (n, 4), columns RAW_NAMES: m00, centroid, orientation; normalised image coordinates [-], [rad].
        X_WC: (n, 4, 4), true pose of the camera optical frame in the world.
        stop: (n, 4), columns STOP_NAMES, as far as the servo knew them; None: not recorded.
        X_WT: (4, 4) true pose of the target in the world at the end, or None.
        target_poses: (n, 4, 4) of a target that moves, at each image, NaN where unknown; None if it rests.
        desired_image, initial_image, final_image: uint8 (h, w) or (h, w, 3): the taught view, the first and the
            last view of the servo phase.
        images: {row: uint8 image} of the servo phase, for a video; {} unless they were asked for.
        camera_info: dict as `Simulation.camera_info`, {} if unknown.
        run_hash: of joint trajectory and images, hexadecimal, "" if unknown.
        real_time_factor: simulated over wall seconds, NaN if unknown.  wall_s: of the whole run, NaN if unknown.
        opengl: renderer and version of the OpenGL images; "" without any. The run hash holds for one of these.
        recorded: topic -> {"published": n, "in_bag": m}, messages of a run that was recorded; {} of any other.
        notes: texts about missing and repaired data of the record.
    """

    scenario: str
    settings: dict
    joint_names: tuple
    feature_names: tuple
    stamp_ns: np.ndarray
    phase: np.ndarray
    status: np.ndarray
    status_text: np.ndarray
    s: np.ndarray
    s_star: np.ndarray
    e: np.ndarray
    twist: np.ndarray
    q: np.ndarray
    set_point: np.ndarray
    raw: np.ndarray
    X_WC: np.ndarray
    stop: Optional[np.ndarray] = None
    X_WT: Optional[np.ndarray] = None
    target_poses: Optional[np.ndarray] = None
    desired_image: Optional[np.ndarray] = None
    initial_image: Optional[np.ndarray] = None
    final_image: Optional[np.ndarray] = None
    images: dict = field(default_factory=dict)
    camera_info: dict = field(default_factory=dict)
    run_hash: str = ""
    real_time_factor: float = float("nan")
    wall_s: float = float("nan")
    opengl: str = ""
    recorded: dict = field(default_factory=dict)
    notes: tuple = ()

    def __len__(self) -> int:
        return len(self.stamp_ns)

    @property
    def eye_to_hand(self) -> bool:
        """Whether the arm carried the target and the camera stood still."""
        return bool(self.settings.get("robot", {}).get("target_link"))

    @cached_property
    def X_WM(self) -> np.ndarray:
        """(n, 4, 4), true pose in the world of the moved body: the camera, or eye-to-hand the target."""
        return self.target_poses if self.eye_to_hand and self.target_poses is not None else self.X_WC

    @property
    def t_s(self) -> np.ndarray:
        """(n,) simulated time of each image [s]."""
        return self.stamp_ns * 1e-9

    def rows(self, *phases: str) -> np.ndarray:
        """Indices of the images of these phases, in order: (j,) int."""
        return np.flatnonzero(np.isin(self.phase, phases))

    @cached_property
    def taught_row(self) -> int:
        """Row of the image that stands for the taught view: of several averaged ones, that nearest to their mean place.

        The arm may creep a little while it is taught, fast at first and then slower.
        """
        rows = self.rows("teach")
        places = self.X_WC[rows, :3, 3]
        return rows[np.linalg.norm(places - places.mean(axis=0), axis=1).argmin()]

    @cached_property
    def taught_pose(self) -> np.ndarray:
        """(4, 4), X_WC of the taught view: of several averaged images the mean."""
        return mean_pose(self.X_WC[self.taught_rows])

    @cached_property
    def taught_rows(self) -> np.ndarray:
        """Rows of the images whose mean is the taught view: (j,) int. `runs.teaching` leaves out those of before the
        camera was still."""
        rows, judge = self.rows("teach"), self.settings.get("experiment", {}).get("judge")
        if judge is None or not len(rows) or not np.isfinite(self.X_WC[rows]).all():
            return rows
        still_m, still_rad = still(**judge)
        away = [size_of(inverse(self.X_WC[rows[-1]]) @ X) for X in self.X_WC[rows]]
        near = [moved_m <= still_m and turned_rad <= still_rad for moved_m, turned_rad in away]
        return rows[len(near) - near[::-1].index(False):] if False in near else rows

    @cached_property
    def servo_rows(self) -> np.ndarray:
        """Indices of the images of the servo phase, with the one that ended it: (j,) int.

        The phase ends with a `servo` row whose status is in types.FINAL, or with the `done` row that follows.
        """
        rows = self.rows("servo")
        if not len(rows):
            return rows
        ended = [row for row, status in enumerate(self.status[rows].tolist()) if status in FINAL]
        if ended:
            return rows[:ended[0] + 1]
        follows = rows[-1] + 1
        return np.append(rows, follows) if follows < len(self) and self.phase[follows] == "done" else rows

    @property
    def servo_t_s(self) -> np.ndarray:
        """(j,) time of each servo image since the first one [s]."""
        rows = self.servo_rows
        return (self.stamp_ns[rows] - self.stamp_ns[rows[:1]]) * 1e-9


class RecordBuilder:
    """Builds a RunRecord: `add_answer` for each image, then `finish`.

    Args: keep_images: keep every image of the servo phase, not only the first and the last one.
    """

    def __init__(self, scenario: str, joint_names: Sequence[str], settings: Optional[Mapping[str, Any]] = None,
                 feature_names: Sequence[str] = FEATURE_NAMES, keep_images: bool = False) -> None:
        self.scenario = str(scenario)
        self.settings = dict(settings or {})
        self.joint_names = tuple(joint_names)
        self.feature_names = tuple(feature_names)
        k, m = len(self.feature_names), len(self.joint_names)
        self._shapes = {"s": (k,), "s_star": (k,), "e": (k,), "twist": (6,), "q": (m,), "set_point": (m,),
                        "raw": (len(RAW_NAMES),), "stop": (len(STOP_NAMES),), "X_WC": (4, 4),
                        "target_poses": (4, 4)}
        self._sizes = tuple(shape[0] for shape in self._shapes.values())
        self._names = self._by_name = None  # joints of the answer added last, and where each of joint_names is in them
        self._rows = []    # (stamp_ns, phase, status, status_text)
        self._values = []  # of the rows, in the order of _shapes, None for NaN
        self._moving = False
        self._images, self._last_servo_image = {}, None
        self._keep_images, self._all_images = keep_images, {}
        self._notes = []

    def __len__(self) -> int:
        return len(self._rows)

    @property
    def begin_ns(self) -> int:
        """Stamp of the first row."""
        return self._rows[0][0]

    def add_row(self, stamp_ns: int, phase: str, status: int = 0, status_text: str = "",
                s: Optional[Sequence[float]] = None, s_star: Optional[Sequence[float]] = None,
                e: Optional[Sequence[float]] = None, twist: Optional[Sequence[float]] = None,
                q: Optional[Sequence[float]] = None, set_point: Optional[Sequence[float]] = None,
                X_WC: Optional[np.ndarray] = None, raw: Optional[Sequence[float]] = None,
                image: Optional[np.ndarray] = None, X_WT: Optional[np.ndarray] = None,
                stop: Optional[Sequence[float]] = None) -> None:
        """Appends the row of one image; values that are None become NaN.

        Args:
            stamp_ns: simulated time of the image [ns].  phase: one of types.PHASES.  status: code of ServoState.
            s, s_star, e: (k,).  twist: (6,).  q, set_point: (m,) in the order of joint_names.  X_WC: (4, 4).
            raw: (area, xg, yg, alpha).  X_WT: (4, 4) of a target that moves.  stop: values of STOP_NAMES.
            image: uint8 or uint16, (h, w) or (h, w, 3), unchanged until the next row or `finish`; copied only where
                the record keeps it (see `_keep_image`).
        The other arrays are copied later: do not change their content after this call.
        Raises:
            ShapeError: an array has not the length its names have.
        """
        values = (s, s_star, e, twist, q, set_point, raw, stop, X_WC, X_WT)
        if any([value is not None and len(value) != size for value, size in zip(values, self._sizes)]) or \
                X_WC is not None and getattr(X_WC, "shape", None) != (4, 4) or X_WT is not None:
            self._check_shapes(values)
        self._values.append(values)
        self._rows.append((int(stamp_ns), str(phase), int(status), str(status_text)))
        self._moving |= X_WT is not None
        if image is not None:
            self._keep_image(phase, image)

    def _check_shapes(self, values):
        """Raises ShapeError if one of these values of a row has not the shape of its column."""
        for (name, shape), value in zip(self._shapes.items(), values):
            found = shape if value is None else np.shape(value)
            if found != shape:
                expected = f"shape {shape}, got {found}" if len(shape) > 1 else f"{shape[0]} values, got {len(value)}"
                raise ShapeError(f"{name}: expected {expected}")

    def add_answer(self, answer: Any, X_WC: Optional[np.ndarray] = None, features: Optional[Any] = None,
                   image: Optional[np.ndarray] = None, X_WT: Optional[np.ndarray] = None) -> None:
        """Appends the row of one answered image.

        Args:
            answer: `types.ServoRecord` (or an object with its fields), joints by name in any order.
            X_WC: (4, 4) true camera pose at the image.  features: `Features` of the image, or None.
            image: uint8 or uint16, (h, w) or (h, w, 3), or None.  X_WT: (4, 4) true pose of a target that moves, or
                None.
        """
        names = answer.joint_names
        if names is not self._names:
            self._names, own = names, self.joint_names
            self._by_name = None if tuple(names) == own else [
                names.index(name) if name in names else None for name in own]
        q, set_point, m = answer.q, answer.set_point, len(self.joint_names)
        if self._by_name is not None or len(q) != m or len(set_point) != m:
            q, set_point = self._in_order(q), self._in_order(set_point)
        same = tuple(getattr(answer, "feature_names", self.feature_names)) == self.feature_names
        s, s_star, e = (answer.s, answer.s_star, answer.e) if same else (None, None, None)
        stop = [getattr(answer, name, np.nan) for name in STOP_NAMES]
        self.add_row(answer.stamp_ns, answer.phase, answer.status, answer.status_text, s, s_star, e, answer.twist,
                     q, set_point, X_WC, None if features is None else _RAW(features), image, X_WT, stop)

    def _in_order(self, values):
        """Values of the joints of an answer, in the order of joint_names; NaN for those it does not have."""
        if self._by_name is None and len(values) == len(self.joint_names):
            return values
        return [np.nan if i is None or i >= len(values) else values[i]
                for i in self._by_name or range(len(self.joint_names))]

    def _keep_image(self, phase: str, image: np.ndarray) -> None:
        """Keeps the image of the row just added if it is the taught view, or the first or last one of the servo.

        The `done` row's image is the last one only if no servo row before it reported the end (see `servo_rows`).
        """
        ends = phase == "done" and len(self._rows) > 1 and self._rows[-2][1] == "servo" and \
            self._rows[-2][2] not in FINAL
        if self._keep_images and (phase == "servo" or ends):
            self._all_images[len(self._rows) - 1] = _copy(image)
        if phase == "teach":
            self._images["desired"] = _copy(image)
        elif phase == "servo" and "initial" not in self._images:
            self._images["initial"] = _copy(image)
        if ends or phase == "servo" and self._rows[-1][2] in FINAL:
            self._images["final"], self._last_servo_image = _copy(image), None
        elif phase == "servo":
            self._last_servo_image = image  # it is the last view only if the run breaks off here: copied then

    def note(self, text: str) -> None:
        """Adds a note for readers of the report."""
        self._notes.append(str(text))

    def _end(self):
        """Number of rows up to the one that says how the run ended.

        How many a node sends after it depends on wall time. Without them a run over ROS and one in process give the
        same trace, byte for byte.
        """
        active = [i for i, row in enumerate(self._rows) if row[1] not in ("idle", "done")]
        if not active:
            return len(self._rows)
        last = active[-1] + 1
        return last + (last < len(self._rows) and self._rows[last][1] == "done")

    def finish(self, run_hash: str = "", wall_s: float = float("nan"), real_time_factor: Optional[float] = None,
               camera_info: Optional[Mapping[str, Any]] = None, X_WT: Optional[np.ndarray] = None, opengl: str = "",
               recorded: Optional[Mapping[str, Any]] = None) -> RunRecord:
        """The record, up to the end of the run. real_time_factor: None: simulated time of all rows over wall_s."""
        if real_time_factor is None:
            simulated_s = (self._rows[-1][0] - self._rows[0][0]) * 1e-9 if self._rows else np.nan
            real_time_factor = simulated_s / wall_s
        count = self._end()
        stamp_ns, phase, status, status_text = list(zip(*self._rows[:count])) or [()] * 4
        if self._last_servo_image is not None:
            self._images["final"], self._last_servo_image = _copy(self._last_servo_image), None
        tables: Dict[str, Any] = {name: self._table(column, shape, count)
                                  for column, (name, shape) in enumerate(self._shapes.items())}
        tables.update({f"{name}_image": self._images.get(name) for name in ("desired", "initial", "final")})
        if not self._moving:
            tables["target_poses"] = None
        self._notes += self._depth_notes(tables, list(phase), X_WT)
        return RunRecord(
            scenario=self.scenario, settings=self.settings, joint_names=self.joint_names,
            feature_names=self.feature_names, stamp_ns=np.array(stamp_ns, dtype=np.int64),
            phase=np.array(phase, dtype=str), status=np.array(status, dtype=int),
            status_text=np.array(status_text, dtype=str), **tables,
            X_WT=None if X_WT is None else np.array(X_WT, dtype=float),
            images=dict(self._all_images), camera_info=dict(camera_info or {}), run_hash=str(run_hash),
            real_time_factor=float(real_time_factor), wall_s=float(wall_s), opengl=str(opengl),
            recorded=dict(recorded or {}), notes=tuple(self._notes))

    def _depth_notes(self, tables, phase, X_WT):
        """[text] if experiment.z_star_m contradicts the true depth of the target in the taught view, else [].

        Where depth images tell the depth, z_star_m is not used.
        """
        z_star_m, vision = (self.settings.get(name, {}) for name in ("experiment", "vision"))
        z_star_m = z_star_m.get("z_star_m")
        if "teach" not in phase or not z_star_m or "depth" in vision or "depth" in vision.get("matches", {}):
            return []
        row = phase.index("teach")
        X_WT = X_WT if tables["target_poses"] is None else tables["target_poses"][row]
        if X_WT is None:
            return []
        seen = tables["raw"][row, 1:3]
        true_m = plane_depth(tables["X_WC"][row], np.asarray(X_WT), *(seen if np.isfinite(seen).all() else (0.0, 0.0)))
        if not abs(z_star_m - true_m) > DEPTH_OFF * true_m:
            return []
        return [f"teach: experiment.z_star_m: found {z_star_m:g} m, the target is {true_m:.4g} m away in this view"]

    def _table(self, column, shape, count):
        """Values of a column of the first rows, (count, *shape), NaN where there are none."""
        values = [values[column] for values in self._values[:count]]
        if all([value is None for value in values]):
            return np.full((count, *shape), np.nan)
        missing = np.full(shape, np.nan)
        joined = np.concatenate([missing if value is None else value for value in values], dtype=float)
        return joined.reshape(count, *shape)


def _copy(image):
    """A copy with 8 bits a value."""
    return np.array(eight_bit(image))
