"""Collects joint states and commands of one arm from a bag, as arrays."""

from dataclasses import dataclass
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple

import numpy as np

from aras_visual_servo import ParameterError
from .any_bag import AnyBag, duration_s, stamp_s
from .motions import from_rest, spline

JOINT_STATE = "sensor_msgs/JointState"
ONE, MANY, TRAJECTORY = "std_msgs/Float64", "std_msgs/Float64MultiArray", "trajectory_msgs/JointTrajectory"
#: An arm that rests nearer than this to the first point of its first trajectory was told to be there. [m or rad]
NEAR = 0.05
#: The recorder's clock is that of the stamps if messages arrive within this time. [s]
MOST_LATE_S = 5.0


@dataclass(frozen=True)
class JointLog:
    """Joint states and commands, as they stand in the bag.

    Attributes:
        names: m joints.  times_s: (n,) stamps.  position: (n, m).  velocity, effort: (n, m) or None.
        received_s: (n,) when the recorder got them, or None if on another clock.
        kind: of the commands, `position` or `velocity`; None without commands.
        told_s: (k,) stamps of the commands.  told: (k, m) commands.
    """

    names: Tuple[str, ...]
    times_s: np.ndarray
    position: np.ndarray
    velocity: Optional[np.ndarray]
    effort: Optional[np.ndarray]
    received_s: Optional[np.ndarray]
    kind: Optional[str]
    told_s: np.ndarray
    told: np.ndarray


def read_joint_log(bag: AnyBag, names: Sequence[str], controllers: Mapping[str, Any],
                   joint_states: Optional[str] = None, kind: str = "position", *, step_s: float) -> JointLog:
    """Returns the log of the joints `names`.

    Commands are JointState messages of a topic whose last word has `command`, or on CONTROLLER/command Float64 of each
    controller, Float64MultiArray of all joints sorted by name, or JointTrajectory.

    Args:
        controllers: name -> section in ros_control's layout, for the joints of Float64 messages.
        joint_states: topic, where several have these joints.  kind: of commands in Float64MultiArray.
        step_s: distance of the set points between the points of a trajectory. That of the simulator that replays them:
        held for two of its periods, they would make velocities that ripple.
    Raises: ParameterError: with every fault found.  BagError.
    """
    types = bag.types
    states = {topic for topic, name in types.items() if name == JOINT_STATE and not _commands(topic)}
    orders = {topic: name for topic, name in types.items() if _commands(topic)
              and name in (JOINT_STATE, ONE, MANY, TRAJECTORY)}
    if joint_states is not None and joint_states not in states:
        raise ParameterError(f"--joint-states: found {joint_states}, allowed "
                             f"{', '.join(sorted(states)) or 'a bag with joint states'}")
    states = {joint_states} if joint_states is not None else states
    found: Dict[str, List[Tuple[Any, float]]] = {topic: [] for topic in (*states, *orders)}
    for topic, message, at in bag.messages(found) if found else ():
        found[topic].append((message, at))
    topic = _states_topic(bag, {topic: found[topic] for topic in states}, names)
    prefix = topic.rpartition("/")[0] + "/"
    near = {name: value for name, value in orders.items() if name.startswith(prefix)} or orders
    whole = [each for each in found[topic] if set(names) <= set(each[0].name)]
    told = _told({name: found[name] for name in near}, near, names, controllers, kind, whole, step_s)
    return _log(names, whole, *told)


def _commands(topic):
    return "command" in topic.rpartition("/")[2]


def _states_topic(bag, found, names):
    """The only topic whose messages have all joints."""
    has = {topic: {name for message, _ in messages for name in message.name} for topic, messages in found.items()}
    whole = sorted(topic for topic, messages in found.items()
                   if any(set(names) <= set(message.name) for message, _ in messages))
    if len(whole) > 1:
        raise ParameterError(f"bag '{bag.name}': found joint states of {', '.join(names)} on {', '.join(whole)}, "
                             "allowed one arm: choose it with --joint-states TOPIC")
    if not whole:
        those = "; ".join(f"{topic} has {', '.join(sorted(joints)) or 'none'}" for topic, joints in sorted(has.items()))
        raise ParameterError(f"bag '{bag.name}': found no topic with the joints {', '.join(names)} in one message, "
                             f"allowed one: {those or 'no topic has joint states'}")
    return whole[0]


def _log(names, states, kind, told_s, told):
    times, late = np.array([stamp_s(message) for message, _ in states]), np.array([at for _, at in states])
    first = np.r_[True, np.diff(times) != 0.0]  # a state that is sent again with an image has its stamp
    rows = [[list(message.name).index(name) for name in names] for message, _ in states]

    def values(key):
        columns = [getattr(message, key) for message, _ in states]
        if any(len(column) < len(message.name) for column, (message, _) in zip(columns, states)):
            return None
        return np.array([[column[i] for i in row] for column, row in zip(columns, rows)], dtype=float)[first]
    position = values("position")
    if position is None:
        raise ParameterError("joint states: found messages without positions, allowed positions of all joints")
    on_time = 0.0 <= float(np.median(late - times)) < MOST_LATE_S
    if kind is not None and len(told_s):
        # Before a joint is told anything it stays.
        rest = position[0] if kind == "position" else np.zeros(len(names))
        told = np.where(np.isnan(told), rest, told)
    return JointLog(tuple(names), times[first], position, values("velocity"), values("effort"),
                    late[first] if on_time else None, kind, told_s, told)


def _told(found, types, names, controllers, kind, states, step_s):
    """(kind, stamps, values): commands of all topics in order, NaN where a joint was not told anything yet."""
    events, kinds = [], set()
    for topic, messages in found.items():
        joint = _joint_of(topic, controllers)
        for message, at in messages:
            if types[topic] == JOINT_STATE:
                speed = len(message.velocity) > 0 and len(message.position) == 0
                these = dict(zip(message.name, message.velocity if speed else message.position))
                kinds.add("velocity" if speed else "position")
                events.append((stamp_s(message), these))
            elif types[topic] == ONE and joint is not None:
                type_name = str(controllers[topic.split("/")[-2]].get("type"))
                kinds.add("velocity" if "Velocity" in type_name else "position")
                events.append((at, {joint: message.data}))
            elif types[topic] == MANY and len(message.data) == len(names):
                kinds.add(kind)
                events.append((at, dict(zip(sorted(names), message.data))))
        if types[topic] == TRAJECTORY and messages:
            kinds.add("position")
            events += _points(messages, states, step_s)
    events = [(at, {name: float(value) for name, value in these.items() if name in names}) for at, these in events]
    events = sorted((each for each in events if each[1]), key=lambda each: each[0])
    if not events:
        return None, np.zeros(0), np.zeros((0, len(names)))
    if len(kinds) > 1:
        raise ParameterError(f"commands: found positions and velocities on {', '.join(sorted(found))}, allowed one of "
                             "them")
    stamps, values, now = [], [], dict.fromkeys(names, np.nan)
    for at, these in events:
        now.update(these)
        if stamps and stamps[-1] == at:
            values[-1] = [now[name] for name in names]
        else:
            stamps.append(at)
            values.append([now[name] for name in names])
    return kinds.pop(), np.array(stamps), np.array(values)


def _joint_of(topic, controllers):
    """The joint that the Float64 of CONTROLLER/command drive, None if that is no controller of one joint."""
    section = controllers.get(topic.split("/")[-2]) if "/" in topic else None
    return section.get("joint") if isinstance(section, Mapping) else None


def _points(messages, states, step_s):
    """(stamp, positions by joint) of the set points that a driver interpolates; a new trajectory replaces the old one.

    Between two points is the polynomial of ros_controllers: of order 1, 3 or 5, as the points have velocities and
    accelerations. The set point of an arm that is not near the first point is unknown: it begins with this point if
    others follow, and where the arm is otherwise.
    """
    events, stamps = [], [stamp_s(state) for state, _ in states]
    for k, (message, at) in enumerate(messages):
        start = stamp_s(message) or at
        until = (stamp_s(messages[k + 1][0]) or messages[k + 1][1]) if k + 1 < len(messages) else np.inf
        times = np.array([duration_s(point.time_from_start) for point in message.points])
        if not len(times):
            continue
        keys = [key for key in ("positions", "velocities", "accelerations")
                if all(len(getattr(point, key)) for point in message.points)]
        knots = np.array([[getattr(point, key) for key in keys] for point in message.points], dtype=float)
        if times[0] > 0.0:
            state = states[min(int(np.searchsorted(stamps, start)), len(states) - 1)][0]
            measured = dict(zip(state.name, state.position))
            near = all(abs(measured[name] - place) < NEAR for name, place in zip(message.joint_names, knots[0, 0]))
            before = events[-1][1] if events else dict(zip(message.joint_names, knots[0, 0])) if near else measured
            if events or near or len(times) == 1:
                times, knots = from_rest([before[name] for name in message.joint_names], times, knots)
        grid = np.unique(np.r_[np.arange(times[0], times[-1], step_s), times[-1]])
        # The driver's set point moves on; one that is held here is that of the middle.
        middle = np.minimum(grid + 0.5 * step_s, times[-1])
        path = spline(times, knots)(middle) if len(times) > 1 else knots[:, 0]
        events += [(start + t, dict(zip(message.joint_names, row))) for t, row in zip(grid.tolist(), path.tolist())
                   if start + t < until]
    return events
