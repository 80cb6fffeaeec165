"""Groups of topics that a run records, chosen by name, and the parts of a report that need them. No ROS."""

from typing import Iterable, List, Sequence, Tuple

from aras_visual_servo import ParameterError, known_sources

#: Topics of the features that a servo may work on, without the namespace.
SOURCE_TOPICS = tuple(source.topic for source in known_sources())
# Group -> its topics without the namespace. "name/" stands for all topics below it. A topic belongs to the first group
# that fits.
GROUPS = {
    "servo": ("servo_state", "servo/", "scenario"),
    "images": ("camera/image_raw",),
    "features": (*SOURCE_TOPICS, "camera/camera_info"),
    "joints": ("joint_states", "joint_command"),
    "truth": ("ground_truth/",),
    "tf": ("tf", "tf_static"),
    "clock": ("clock",),
    "status": ("sim/status",),
    "other": (),
}
# Group -> part of the names of topics that are published only on request, of any camera. "all" excludes these.
ON_DEMAND = {"converted": "/converted_image", "overlay": "/overlay", "depth": "/depth/",
             "segmentation": "/segmentation/"}
# Parts of names that are never recorded: other topics determine them.
NEVER = ("/null_space_bars", "/camera_path", "/image_joint_states", "/parameter_descriptions", "/parameter_updates",
         "/compressed", "/theora", "/state")
COMPRESSIONS = ("lz4", "bz2", "none")
ALWAYS = "servo"       # always recorded: without it nothing can be reported
# (topic, its group, part of a report that needs it).
NEEDED = (("ground_truth/camera_pose", "truth", "the true camera pose: nothing to judge by, no path"),
          ("camera/image_raw", "images", "the camera's images, the video and --replay"),
          ("camera/features", "features", "the features drawn into the video and --replay"),
          ("camera/camera_info", "features", "the features drawn into the video and --replay"),
          ("sim/status", "status", "run hash and real-time factor"))


def parse_groups(value: str) -> Tuple[str, ...]:
    """Names of the groups to record.

    Args:
        value: "all", names with commas between ("images, truth"), a list of names, or names with a minus
            ("-images,-tf") for all groups but these. The group `servo` is always among them, those of ON_DEMAND only
            if they are named ("all, segmentation").
    Returns: tuple of names, in the order of GROUPS and ON_DEMAND.
    Raises: ParameterError: a name is unknown (the known ones are listed), or names with and without a minus are mixed.
    """
    names = [str(name).strip() for name in (value if isinstance(value, (list, tuple)) else str(value).split(","))]
    names = [name for name in names if name]
    known = ", ".join((*GROUPS, *ON_DEMAND))
    faults = [f"record_groups: found '{name}', allowed all | {known}, or -NAME to leave one out"
              for name in names if name.lstrip("-") not in (*GROUPS, *ON_DEMAND, "all") or name == "-all"]
    without = {name[1:] for name in names if name.startswith("-")}
    chosen = {name for name in names if not name.startswith("-")}
    if without and chosen - {"all"}:
        faults.append("record_groups: names with and without a minus do not go together")
    if ALWAYS in without:
        faults.append(f"record_groups: {ALWAYS} cannot be left out, a report is made of it")
    if faults:
        raise ParameterError(faults)
    if without or not chosen or "all" in chosen:
        chosen |= set(GROUPS) - without
    return tuple(name for name in (*GROUPS, *ON_DEMAND) if name in chosen or name == ALWAYS)


def _within(topic, namespace):
    """Name of a topic in its namespace, without a slash before it."""
    return (topic[len(namespace):] if topic.startswith(namespace) else topic).lstrip("/")


def group_of(topic: str, namespace: str = "/") -> str:
    """Group of a topic, given by its resolved name. namespace: of the run, e.g. "/aras_visual_servo/"."""
    name = _within(topic, namespace)
    for group, part in ON_DEMAND.items():
        if part in "/" + name:
            return group
    for group, starts in GROUPS.items():
        if any(name == start or start.endswith("/") and name.startswith(start) for start in starts):
            return group
    return "other"


def is_chosen(topic: str, namespace: str, groups: Sequence[str]) -> bool:
    """Whether a topic, given by its resolved name, is recorded when these groups are. namespace: as `group_of`."""
    name = "/" + _within(topic, namespace)
    return group_of(topic, namespace) in groups and not any(part in name for part in NEVER)


def lacking(present: Iterable[str]) -> List[str]:
    """Returns sentences about missing parts of a report if only `present` (names without namespace) was recorded."""
    gone = [(topic, group, what) for topic, group, what in NEEDED if topic not in present]
    return [f"not recorded: {topic} (group {group}); the report lacks {what}" for topic, group, what in gone]
