"""Reads a RunRecord from the bags of a run, without ROS master and node.

Topics are found by the ends of their names, under any namespace. Those of `REQUIRED` must be there, those of `OPTIONAL`
add to the record. There is one row per ServoState in the order of stamps; everything else is paired with it by stamp.
Of several runs one after the other, the record is the first that servoed.
"""

from pathlib import Path
from typing import Any, Dict, List, Optional, Sequence, Tuple, Union

import numpy as np
import yaml

from aras_visual_servo import FEATURE_NAMES, PHASES, RecordBuilder, RunRecord, STOP_NAMES, Scenario, image_of, \
    load_plugins
from aras_visual_servo.spatial import pose_from_quaternion
from .files import BagError, BagFiles
from .record_groups import SOURCE_TOPICS, lacking

__all__ = ["BagError", "read_bag"]
REQUIRED = ("servo_state",)
OPTIONAL = ("ground_truth/camera_pose", "camera/image_raw", "camera/camera_info", "ground_truth/target_pose",
            "sim/status", "sim/recording", "scenario", *SOURCE_TOPICS)
SECTIONS = ("robot", "sim", "time", "vision", "servo", "experiment")  # of a scenario, each a table


def read_bag(paths: Union[str, Path, Sequence[Union[str, Path]]], namespace: Optional[str] = None,
             scenario: Optional[Scenario] = None, keep_images: bool = False) -> RunRecord:
    """Read a run from its bags.

    Args:
        paths: of a bag, of a folder of bags, or a list of bags; one part of a split bag stands for all of it. A bag
            that was not closed is copied, indexed anew and read as far as it goes.
        namespace: of the run, e.g. "/aras_visual_servo"; None takes the only one in the bag.
        scenario: `Scenario` of the run; None takes it from the topic `scenario` (std_msgs/String, YAML) if recorded.
        keep_images: keep every image of the servo phase in the record, for a video.
    Returns: RunRecord. Its `notes` name unrecorded, missing and truncated data.
    Raises:
        BagError: the file is missing or no bag, topics are missing (all are listed), there are several runs to choose
            from, or no row of a run.
    """
    with BagFiles(paths) as bags:
        return _read(bags, find_topics(bags, namespace), scenario, keep_images)


def find_topics(bags: BagFiles, namespace: Optional[str] = None) -> Dict[str, str]:
    """Dict of name (without namespace) -> topic, of an open `BagFiles`. Raises BagError as `read_bag`."""
    present = bags.topics
    if namespace is None:
        spaces = sorted({topic[:-len("servo_state")] for topic in present if topic.endswith("/servo_state")})
        if len(spaces) > 1:
            raise BagError(f"bag '{bags.name}': holds several runs, choose one namespace of "
                           + ", ".join(space.rstrip("/") or "/" for space in spaces))
        if not spaces:  # the other topics of a run tell its namespace for the error below
            spaces = sorted({topic[:-len(name)] for topic in present for name in OPTIONAL
                             if topic.endswith("/" + name)})
        prefix = spaces[0] if spaces else "/"
    else:
        prefix = "/" + namespace.strip("/") + "/" if namespace.strip("/") else "/"
    missing = [prefix + name for name in REQUIRED if prefix + name not in present]
    if missing:
        raise BagError(f"bag '{bags.name}': topics missing: {', '.join(missing)}; "
                       f"found: {', '.join(sorted(present)) or 'none'}")
    return {name: prefix + name for name in REQUIRED + OPTIONAL if prefix + name in present}


def _read(bags, topics, scenario, keep_images):
    names = {topic: name for name, topic in topics.items() if name != "camera/image_raw"}
    found = {name: [] for name in REQUIRED + OPTIONAL}
    for topic, message in bags.messages(names):
        found[names[topic]].append(message)
    # Of equal stamps the last row counts: a restarted controller may answer an image again.
    states = [state for _, state in sorted(_by_stamp(found["servo_state"]).items())]
    if not states:
        raise BagError(f"bag '{bags.name}': {topics['servo_state']} holds no image's row")
    states, several = _first_run(states)
    features, statuses = _by_stamp(found["camera/features"]), found["sim/status"]
    poses, targets = ({stamp_ns: pose_matrix(message.pose) for stamp_ns, message in _by_stamp(found[name]).items()}
                      for name in ("ground_truth/camera_pose", "ground_truth/target_pose"))
    camera_info = camera_info_of(found["camera/camera_info"][0]) if found["camera/camera_info"] else None
    document = found["scenario"][-1].data if found["scenario"] else None
    published = {topic: number for message in found["sim/recording"][-1:]
                 for topic, number in zip(message.topics, message.published)}
    recorded, losses = _compare(bags, published)
    notes = bags.notes + lacking(topics) + losses + several
    settings, scenario_name = settings_of(scenario, document, notes)
    # Features of plugins bring the units and symbols they are shown with.
    plugins = settings.get("servo", {}).get("plugins", [])
    faults = load_plugins(plugins if isinstance(plugins, list) else [])
    notes += [f"features of this plugin are shown without unit and symbol: {fault}" for fault in faults]
    images = {}
    if "camera/image_raw" in topics:
        stamps = _stamps_to_keep(states, every=keep_images)
        images = _images(bags, topics["camera/image_raw"], stamps)
        if len(images) < len(stamps):
            notes.append(f"{len(stamps) - len(images)} of the {len(stamps)} images to show are not in the bag")
    joint_names = max((tuple(sorted(state.joint_names)) for state in states), key=len)
    # The features of the law that servoed. If they are among the default four, the record has all of these.
    feature_names = max((tuple(state.feature_names) for state in states), key=len)
    if set(feature_names) <= set(FEATURE_NAMES):
        feature_names = FEATURE_NAMES
    builder = RecordBuilder(scenario_name, joint_names, settings=settings, keep_images=keep_images,
                            feature_names=feature_names)
    unpaired = 0
    X_WT = next(reversed(targets.values()), None)
    if all(np.array_equal(X, X_WT) for X in targets.values()):
        targets = {}  # the target rests
    for state in states:
        stamp_ns = state.header.stamp.to_nsec()
        unpaired += stamp_ns not in poses
        builder.add_answer(_Answer(state, stamp_ns, feature_names), poses.get(stamp_ns), features.get(stamp_ns),
                           images.get(stamp_ns), targets.get(stamp_ns))
    if unpaired and "ground_truth/camera_pose" in topics:
        notes.append(f"{unpaired} of {len(states)} images have no true camera pose of the same stamp")
    if all(state.phase != "done" for state in states):
        notes.append(f"the recording ends before the run did, in phase {states[-1].phase}")
    for note in dict.fromkeys(notes + bags.notes):
        builder.note(note)
    factors = [s.real_time_factor for s in statuses if not s.paused and s.real_time_factor > 0.0]
    return builder.finish(run_hash=statuses[-1].run_hash if statuses else "",
                          real_time_factor=float(np.median(factors)) if factors else float("nan"),
                          camera_info=camera_info, X_WT=X_WT, recorded=recorded,
                          opengl=getattr(statuses[-1], "opengl", "") if statuses else "")


def _first_run(states):
    """(rows of the first run that servoed, [note about the others]). A run goes through `PHASES` in their order."""
    begins, highest = [], PHASES.index("done")
    for row, state in enumerate(states):
        phase = PHASES.index(state.phase) if state.phase in PHASES else 0
        if 0 < phase < highest:
            begins.append(row)
            highest = phase
        else:
            highest = max(highest, phase)
    if len(begins) < 2:
        return states, []
    runs = [states[begin:end] for begin, end in zip(begins, begins[1:] + [len(states)])]
    number = next((n for n, run in enumerate(runs) if any(state.phase == "servo" for state in run)), 0)
    # Rounded down, so that the first image is not before the time.
    times = ", ".join(f"{1e-3 * (run[0].header.stamp.to_nsec() // 10**6):.3f} s" for run in runs)
    return runs[number], [f"the bag holds {len(runs)} runs, which begin at {times}; this is number {number + 1}. "
                          "To make a bag of another: rosbag filter run.bag other.bag "
                          "\"topic.endswith('/scenario') or t.to_sec() >= BEGIN\""]


def _compare(bags, published):
    """({topic: {"published": n, "in_bag": m}}, notes about missing messages). published: topic -> number."""
    counts = {topic: {"published": number, "in_bag": bags.count(topic)}
              for topic, number in sorted(published.items())}
    return counts, [f"LOST in recording: {topic}: {count['published']} messages were published, {count['in_bag']} are "
                    "in the bag" for topic, count in counts.items() if count["in_bag"] < count["published"]]


class _Answer:
    """ServoState message with the attributes of `types.ServoRecord`."""

    def __init__(self, message, stamp_ns, feature_names):
        self.stamp_ns, self.phase = stamp_ns, message.phase
        self.status, self.status_text = message.status, message.status_text
        self.feature_names = feature_names
        by_name = {name: i for i, name in enumerate(message.feature_names)}
        self.s, self.s_star, self.e = ([row[by_name[name]] if name in by_name and by_name[name] < len(row) else np.nan
                                        for name in feature_names] for row in (message.s, message.s_star, message.e))
        v, w = message.twist.linear, message.twist.angular
        self.twist = [v.x, v.y, v.z, w.x, w.y, w.z]
        self.joint_names, self.q, self.set_point = message.joint_names, message.q, message.set_point
        for name in STOP_NAMES:  # older bags do not have all of them
            setattr(self, name, getattr(message, name, np.nan))


def _by_stamp(messages):
    """Dict of stamp [ns] -> the last message of it."""
    return {message.header.stamp.to_nsec(): message for message in messages}


def _stamps_to_keep(states, every):
    """Stamps of the rows whose images the record keeps: taught, first and last (or every) servo row, and done."""
    servo = [s for s in states if s.phase == "servo"]
    done = [s for s in states if s.phase == "done"]
    kept = [s for s in states if s.phase == "teach"] + (servo if every else servo[:1] + servo[-1:]) + done[:1]
    return {state.header.stamp.to_nsec() for state in kept}


def _images(bags, topic, stamps):
    images = {}
    for _, message in bags.messages([topic]):
        stamp_ns = message.header.stamp.to_nsec()
        if stamp_ns in stamps:
            images[stamp_ns] = image_of(message)
            if len(images) == len(stamps):
                break
    return images


def decode_depth(message: Any) -> np.ndarray:
    """The depth image of a sensor_msgs/Image, (h, w), float32 [m] or uint16 [mm]. Raises BagError: another encoding."""
    code = {"32FC1": "f4", "16UC1": "u2"}.get(message.encoding)
    if code is None:
        raise BagError(f"depth image encoding: found '{message.encoding}', allowed 32FC1 | 16UC1")
    value = np.dtype((">" if message.is_bigendian else "<") + code)
    rows = np.frombuffer(message.data, dtype=np.uint8).reshape(message.height, message.step)
    return rows[:, :message.width * value.itemsize].copy().view(value).astype(value.newbyteorder("="))


def camera_info_of(message: Any) -> Dict[str, Any]:
    """A sensor_msgs/CameraInfo as the dict of `Simulation.camera_info`, K and size being those of the images."""
    roi = {key: getattr(message.roi, key) for key in ("x_offset", "y_offset", "width", "height")}
    info = {"width": message.width, "height": message.height, "K": list(message.K), "D": list(message.D),
            "distortion_model": message.distortion_model, "P": list(message.P), "R": list(message.R),
            "frame_id": message.header.frame_id}
    if message.binning_x <= 1 and message.binning_y <= 1 and not any(roi.values()):
        return info
    from aras_visual_servo_camera import image_info  # here, as most bags do without
    return image_info({**info, "binning_x": message.binning_x, "binning_y": message.binning_y, "roi": roi})


def settings_of(scenario: Optional[Scenario], document: Any, notes: List[str]) -> Tuple[Dict[str, Any], str]:
    """(settings, name) of the given scenario, else of the recorded text, else ({}, "unknown") and a note."""
    if scenario is not None:
        return scenario.as_dict(), scenario.name
    try:
        settings = yaml.safe_load(document) if document else None
    except yaml.YAMLError:
        settings = None
    if isinstance(settings, dict) and all(isinstance(settings.get(section, {}), dict) for section in SECTIONS):
        return settings, str(settings.get("name", "unknown"))
    notes.append("the bag does not say which scenario ran: nothing to judge the final error against")
    return {}, "unknown"


def pose_matrix(pose: Any) -> np.ndarray:
    """(4, 4) matrix of a geometry_msgs/Pose; NaN where its quaternion is zero."""
    position, q = pose.position, pose.orientation
    return pose_from_quaternion((position.x, position.y, position.z), (q.x, q.y, q.z, q.w))
