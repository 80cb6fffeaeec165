"""Joints that follow trajectories: the topics command and state, the action follow_joint_trajectory."""
import typing

import numpy
import rospy
from control_msgs.msg import (FollowJointTrajectoryAction, FollowJointTrajectoryFeedback, FollowJointTrajectoryResult,
                              JointTrajectoryControllerState)
from control_msgs.srv import QueryTrajectoryState, QueryTrajectoryStateResponse
from std_msgs.msg import Header
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from aras_visual_servo_sim import ArasError

from ..node.convert import stamped
from ..node.outlet import NEVER_NS, Beat
from .actions import NOT_RUNNING, ActionAdapter
from .adapter import register

Result = FollowJointTrajectoryResult
#: End of a goal -> result of the action.
ENDS = {"succeeded": (Result.SUCCESSFUL, "succeeded"),
        "path_tolerance_violated": (Result.PATH_TOLERANCE_VIOLATED, "aborted"),
        "goal_tolerance_violated": (Result.GOAL_TOLERANCE_VIOLATED, "aborted")}
Vector = typing.List[float]
WRONG_JOINTS = "Joints on incoming goal don't match the controller joints."


def points_of(trajectory: JointTrajectory) -> typing.List[typing.Tuple[float, Vector, Vector, Vector]]:
    """Returns the simulator's form: (time_s, positions, velocities, accelerations) of each point."""
    return [(point.time_from_start.to_sec(), list(point.positions), list(point.velocities), list(point.accelerations))
            for point in trajectory.points]


def tolerances_of(messages: typing.Iterable[typing.Any]) -> typing.Dict[str, typing.Tuple[float, float, float]]:
    return {each.name: (each.position, each.velocity, each.acceleration) for each in messages}


def point_message(rows: numpy.ndarray) -> JointTrajectoryPoint:
    """JointTrajectoryPoint of (n, 3) position, velocity, acceleration."""
    positions, velocities, accelerations = (list(map(float, rows[:, k])) for k in range(3))
    return JointTrajectoryPoint(positions=positions, velocities=velocities, accelerations=accelerations)


@register("effort_controllers/JointTrajectoryController", "position_controllers/JointTrajectoryController",
          "velocity_controllers/JointTrajectoryController", "pos_vel_controllers/JointTrajectoryController")
class TrajectoryFollower(ActionAdapter):
    def open(self) -> None:
        settings = self.simulation.trajectory_report(self.name)
        self.rate_hz, self._monitor_rate_hz = settings["state_rate_hz"], settings["monitor_rate_hz"]
        self._partial = settings["partial_joints"]
        self._feedback_beat: typing.Optional[Beat] = None
        self.listen(self.topic("command"), JointTrajectory, self._command)
        self._states = self.advertise(self.topic("state"), JointTrajectoryControllerState)
        query = rospy.Service(self.topic("query_state"), QueryTrajectoryState,
                              lambda request: self.work.call(lambda: self._query(request)))
        self.ends_with(query.shutdown)
        self.serve("follow_joint_trajectory", FollowJointTrajectoryAction)

    # --- inputs

    def _start_s(self, header: Header) -> typing.Optional[float]:
        """When a trajectory begins; None: now."""
        return None if header.stamp.is_zero() else self.world.core_s(header.stamp.to_nsec())

    def _command(self, message: typing.Any) -> None:
        note = self.simulation.follow_trajectory(self.name, list(message.joint_names), points_of(message),
                                                 self._start_s(message.header))
        if note:
            rospy.logwarn("%s: %s" % (self.place, note))
        self._watch()

    def accept(self, handle: typing.Any) -> None:
        goal = handle.get_goal()
        trajectory = goal.trajectory
        if not self.running:
            return self._reject(handle, Result.INVALID_GOAL, NOT_RUNNING)
        named = set(trajectory.joint_names)
        fits = named and named <= set(self.joints) and (self._partial or named == set(self.joints))
        if not fits or len(named) != len(trajectory.joint_names):
            return self._reject(handle, Result.INVALID_JOINTS, WRONG_JOINTS)
        try:
            note = self.simulation.pursue_trajectory(
                self.name, list(trajectory.joint_names), points_of(trajectory), self._start_s(trajectory.header),
                tolerances_of(goal.path_tolerance), tolerances_of(goal.goal_tolerance),
                goal.goal_time_tolerance.to_sec())
        except ArasError as error:
            return self._reject(handle, Result.INVALID_GOAL, str(error))
        if note:
            rospy.logwarn("%s: %s" % (self.place, note))
        self.take(handle)
        self._feedback_beat = Beat(self._monitor_rate_hz, self.world.time_ns)

    def _reject(self, handle: typing.Any, code: int, text: str) -> None:
        rospy.logerr("%s: %s" % (self.place, text))
        handle.set_rejected(Result(error_code=code, error_string=text), text)

    def _query(self, request: typing.Any) -> QueryTrajectoryStateResponse:
        if not self.running:
            raise rospy.ServiceException("Can't sample trajectory. Controller is not running.")
        rows = self.simulation.trajectory_at(self.name, self.world.core_s(request.time.to_nsec()))
        return QueryTrajectoryStateResponse(list(self.joints), *(list(map(float, rows[:, k])) for k in range(3)))

    # --- outputs

    @property
    def next_ns(self) -> int:
        feedback_ns = self._feedback_beat.next_ns if self.running and self._goal is not None else NEVER_NS
        return min(super().next_ns, feedback_ns)

    def started(self, now_ns: int) -> None:
        super().started(now_ns)
        self._watch()

    def stopped(self) -> None:
        super().stopped()
        self._watch()

    def _watch(self) -> None:
        """Ends the goal when the controller has."""
        if self._goal is None:
            return
        report = self.simulation.trajectory_report(self.name)
        if report["goal"] in ENDS:
            code, end = ENDS[report["goal"]]
            self.finish(end, Result(error_code=code, error_string=report["goal_error"]), report["goal_error"])
        elif report["goal"] != "active":
            self.finish("canceled")

    def publish(self, now_ns: int) -> None:
        if not self.running:
            return
        self._watch()
        wants_state = self._beat.due(now_ns) and self._states.get_num_connections()
        wants_feedback = self._goal is not None and self._feedback_beat.due(now_ns)
        if not wants_state and not wants_feedback:
            return
        report = self.simulation.trajectory_report(self.name)
        for wanted, kind, send in ((wants_state, JointTrajectoryControllerState, self._states.publish),
                                   (wants_feedback, FollowJointTrajectoryFeedback,
                                    lambda message: self._goal.publish_feedback(message))):
            if wanted:
                send(stamped(kind, now_ns, joint_names=report["joints"],
                             **{part: point_message(report[part]) for part in ("desired", "actual", "error")}))
