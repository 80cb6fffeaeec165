"""Repeats a recorded run on the arm's twin: the scenario of the run, from the same start, on an identified robot."""

from dataclasses import dataclass
from typing import Any, Dict, List, Optional, Tuple

import numpy as np

import aras_visual_servo as avs
from aras_visual_servo import ParameterError, RunRecord, Scenario, Status, load_scenario, load_yaml, resolve_uri, \
    scenario_from_dict
from .settling import settling_s, settling_times_s

#: Sections of an overlay that take the place of those of the recorded scenario, key by key.
OF_ROBOT = ("robot", "sim")
FILES = ("urdf", "controllers")
#: Keys of `real` that limit the arm's motion, and not the twin's.
OF_REAL = ("speed_part", "joint_speed", "joint_acceleration", "workspace")
#: Intrinsics that differ by less are those of the scenario [px].
SAME_PX = 1e-3
#: Images farther apart than this many periods have lost ones between them.
GAP = 1.5
#: Rates of images that differ by less are that of the scenario.
SAME_RATE = 0.01


@dataclass(frozen=True)
class OnTwin:
    """A recorded run, and what the twin did from the same start.

    Attributes:
        scenario: of the twin.  measured, twin: records of the runs.  notes: what the bag did not tell, in words.
    """

    scenario: Scenario
    measured: RunRecord
    twin: RunRecord
    notes: Tuple[str, ...]


def image_age_s(paths: Any, namespace: Optional[str] = None) -> Optional[float]:
    """Returns the mean age of the images that a real arm's controller answered [s]; None if the bag does not tell it.

    Args: as of `read_bag`.
    """
    from aras_visual_servo_controller import BagFiles  # needs rosbag
    wanted = "/input_timing" if namespace is None else f"/{namespace.strip('/')}/input_timing"
    with BagFiles(paths) as bags:
        topics = [topic for topic in bags.topics if topic.endswith(wanted)]
        ages = [message.image_age_s for _, message in bags.messages(topics) if message.used] if topics else []
    return float(np.mean(ages)) if ages else None


def replay_on_twin(measured: RunRecord, overlay: Optional[str] = None, age_s: Optional[float] = None) -> OnTwin:
    """Runs the recorded controller on the twin.

    Args:
        measured: record of a bag (`read_bag`).  overlay: name or path of a scenario whose own keys of `robot` and `sim`
            replace those of the recorded one, as `aras-servo identify` writes it; None: the recorded robot.
        age_s: of the images when they were answered (`image_age_s`), the latency of the twin's camera; None: that of
            the scenario.
    Raises: ParameterError: as `twin_scenario`, or the twin ended before its servo began.
    """
    scenario, notes = twin_scenario(measured, overlay, age_s)
    twin = avs.run(scenario)
    if not len(twin.servo_rows):
        raise ParameterError(f"twin: ended before its servo began: {twin.status_text[-1]}; allowed a scenario whose "
                             "target is in view at the goal and at the start")
    return OnTwin(scenario, measured, twin, (*measured.notes, *notes))


def twin_scenario(measured: RunRecord, overlay: Optional[str] = None,
                  age_s: Optional[float] = None) -> Tuple[Scenario, List[str]]:
    """Returns (the scenario that repeats the run, notes).

    A run that drove to its goal and start by itself is repeated whole. Otherwise the first servo image gives the start,
    and the goal is where the run converged, or the goal of the scenario. The camera of the twin has the intrinsics of
    the bag and the rate of its images. Arguments as of `replay_on_twin`.

    Raises: ParameterError: the bag holds no scenario or no servo image, features of the record are not those of the
        scenario, or the overlay is of another robot.
    """
    faults = []
    if not measured.settings:
        faults.append("scenario: found none in the bag, allowed a bag with the topic scenario, or --scenario")
    if not len(measured.servo_rows):
        faults.append("phase: found no image of the servo, allowed a recorded servo run")
    if faults:
        raise ParameterError(faults)
    scenario = scenario_from_dict(dict(measured.settings), source="scenario of the bag")
    names = scenario.kinematics().joint_names
    if set(names) != set(measured.joint_names):
        raise ParameterError(f"joints: found {', '.join(measured.joint_names)} in the bag, allowed those of its "
                             f"scenario, {', '.join(names)}")
    places, notes = _places(measured)
    ignored = [key for key in OF_REAL if key in scenario.real]
    if ignored:
        notes.append(f"the twin does not use these keys of `real`: {', '.join(ignored)}")
    robot = {} if overlay is None else _of_overlay(overlay, names)
    changes = {**_camera(measured, scenario, age_s), **places, **robot}
    return scenario.with_overrides(changes) if changes else scenario, notes


def differences(run: OnTwin) -> Dict[str, Any]:
    """Returns the numbers of a comparison, for JSON.

    settling_s, duration_s and ended_with: measured and twin. features: name -> start, final and settling_s of both, and
    the root mean square of twin minus measured. joints: name -> root mean square and largest difference [m, rad]. Both
    are compared at the images of the record, over the time that both runs servo. None: unknown.
    """
    both = (run.measured, run.twin)
    times = [record.servo_t_s for record in both]
    until = min(times[0][-1], times[1][-1])
    here = times[0] <= until
    features, joints = {}, {}
    settled = [settling_times_s(record) for record in both]
    for name in run.measured.feature_names:
        columns = [feature_of(record, name) for record in both]
        apart = np.interp(times[0][here], times[1], columns[1]) - columns[0][here]
        features[name] = {"start": _pair(column[0] for column in columns), "final": _pair(map(_last, columns)),
                          "settling_s": _pair(each.get(name, np.nan) for each in settled), "rms": _plain(_rms(apart))}
    for name in run.measured.joint_names:
        columns = [joint_of(record, name) for record in both]
        apart = np.interp(times[0][here], times[1], columns[1]) - columns[0][here]
        joints[name] = {"rms": _plain(_rms(apart)), "largest": _plain(np.nanmax(np.abs(apart)))}
    judged = [avs.judge(record).reason if len(record.rows("teach")) else str(record.status_text[record.servo_rows[-1]])
              for record in both]
    return {"ended_with": dict(zip(("measured", "twin"), judged)), "duration_s": _pair(t[-1] for t in times),
            "settling_s": _pair(map(settling_s, both)), "features": features, "joints": joints}


def joint_of(record: RunRecord, name: str) -> np.ndarray:
    """Returns the positions of a joint at the servo images, (j,) [m or rad]."""
    return record.q[record.servo_rows, record.joint_names.index(name)]


def feature_of(record: RunRecord, name: str) -> np.ndarray:
    """Returns the error of a feature at the servo images, (j,); NaN where the run has no such feature."""
    rows = record.servo_rows
    if name not in record.feature_names:
        return np.full(len(rows), np.nan)
    return record.e[rows, record.feature_names.index(name)]


def _last(column):
    seen = column[np.isfinite(column)]
    return seen[-1] if len(seen) else np.nan


def _rms(values):
    seen = values[np.isfinite(values)]
    return np.sqrt(np.mean(seen**2)) if len(seen) else np.nan


def _plain(value):
    return float(value) if np.isfinite(value) else None


def _pair(values):
    return dict(zip(("measured", "twin"), map(_plain, values)))


def _places(measured):
    """(changes of goal and start, notes) that make the twin begin where the run began."""
    if len(measured.rows("teach")) and len(measured.rows("to_start")):
        return {}, []
    q, rows = measured.q, measured.servo_rows
    known = rows[np.isfinite(q[rows]).all(axis=1)]
    if not len(known):
        raise ParameterError("joints: found no finite positions at the servo images, allowed those of every joint")
    changes = {"experiment.start": _joints(measured, q[known[0]])}
    taught = measured.rows("teach")
    if len(taught):
        return {**changes, "experiment.goal": _joints(measured, np.nanmean(q[taught], axis=0))}, []
    if measured.status[rows[-1]] in (Status.CONVERGED, Status.SETTLED, Status.STOPPED_BY_RULE):
        return {**changes, "experiment.goal": _joints(measured, q[known[-1]])}, [
            "the bag does not hold the taught image: the goal of the twin is where the run arrived"]
    return changes, ["the bag does not hold the taught image: the goal of the twin is that of the scenario"]


def _joints(record, q):
    return {"joints": dict(zip(record.joint_names, q.tolist()))}


def _camera(measured, scenario, age_s):
    """Changes of the simulated camera that give it the intrinsics, rate and latency of the recorded one."""
    cameras = [dict(camera) for camera in scenario.sim.get("cameras") or []]
    if not cameras:
        return {}
    camera, info, rows = cameras[0], measured.camera_info, measured.servo_rows
    before = dict(camera)
    if age_s is not None and not scenario.real.get("predict"):  # predicted features are those of the answer's time
        camera["latency_s"] = round(age_s, 6)
    if len(rows) > 2:
        periods = np.diff(measured.stamp_ns[rows])
        rate = 1e9 / float(np.mean(periods[periods < GAP * np.median(periods)]))
        if abs(rate / camera.get("rate_hz", 30.0) - 1.0) > SAME_RATE:
            camera["rate_hz"] = round(rate, 3)
    if info:
        own = avs.simulation_of(scenario).camera_info(camera["name"])
        if any(info[key] != own[key] for key in ("width", "height", "distortion_model")) or \
                not np.allclose(info["K"], own["K"], rtol=0.0, atol=SAME_PX) or \
                not np.allclose(_filled(info["D"]), _filled(own["D"]), rtol=0.0, atol=1e-9):
            camera.pop("horizontal_fov_rad", None)
            fx, _, cx, _, fy, cy = info["K"][:6]
            camera.update(width=info["width"], height=info["height"], fx_px=fx, fy_px=fy, cx_px=cx, cy_px=cy,
                          distortion_model=info["distortion_model"] if any(info["D"]) else "none",
                          distortion=list(info["D"]) if any(info["D"]) else [])
    return {} if camera == before else {"sim.cameras": [camera, *cameras[1:]]}


def _filled(values):
    return np.r_[np.asarray(values, dtype=float), np.zeros(8 - len(values))]


def _of_overlay(overlay, names):
    """Changes that the overlay's own keys of its robot make. Raises ParameterError: it is of another robot."""
    robot = load_scenario(overlay)
    found = robot.kinematics(calibrated=False).joint_names
    if set(found) != set(names):
        raise ParameterError(f"--robot: found {overlay} with the joints {', '.join(found)}, allowed those of the run, "
                             f"{', '.join(names)}")
    own, folder = load_yaml(robot.path), robot.path.parent
    changes = {f"{section}.{key}": value for section in OF_ROBOT if isinstance(own.get(section), dict)
               for key, value in own[section].items()}
    for key in FILES:
        if f"robot.{key}" in changes:
            changes[f"robot.{key}"] = str(resolve_uri(changes[f"robot.{key}"], folder, f"robot.{key}"))
    return changes
