"""Node `experiment`: runs the scenario's experiment once, records it, judges it, and ends with an exit code.

Exit codes: 0 the run converged and the final pose is within the limits of the scenario's judge; 1 the run came to its
end, but did not; 2 bad parameters; 3 the run could not be made (no result folder, no simulator, the disk is full, ...);
128 + N signal N ended it, the bag is closed.

The node waits on wall time, because simulated time stands still while the simulator is paused.
"""

import dataclasses
import os
import threading
import time
from pathlib import Path
from typing import Any

import rospy
import yaml
from actionlib_msgs.msg import GoalStatus, GoalStatusArray
from std_msgs.msg import String
from std_srvs.srv import Empty

from aras_visual_servo import ArasError, CLOSING_S, ParameterError, Status, default_of, scenario_from_dict, study
from aras_visual_servo.processes import Interrupted, check_signals, signals_held, signals_raise
from aras_visual_servo_msgs.msg import (SimStatus, VisualServoActionFeedback, VisualServoActionGoal,
                                        VisualServoActionResult, VisualServoGoal)
from aras_visual_servo_msgs.srv import Step
from ..bags.bag import read_bag
from ..bags.record_groups import COMPRESSIONS, is_chosen, lacking, parse_groups
from .calls import GoalSender
from .graph import Graph
from .parameters import Parameters
from .recording import Recording

NODES = ("sim", "controller")   # and the publisher of FEATURES: a node, or a nodelet in the simulator's process
FEATURES = "camera/features"
OUTSIDE = ("/clock", "/tf", "/tf_static")
PRIVATE_PARAMETERS = ("results_dir", "record", "record_groups", "record_split_mb", "record_compression", "video",
                      "startup_timeout_s", "stall_timeout_s", "exit_code_file", "repeat")
POLL_S = 0.05             # wall time between looks
GRAPH_POLL_S = 0.5        # wall time between looks at the master while running
EXIT_PASSED, EXIT_FAILED, EXIT_PARAMETERS, EXIT_BROKEN = range(4)


class RunError(ArasError):
    """The run cannot start or continue; the text names the missing part."""


class ExperimentNode:
    """One run, from an empty folder to a report. Raises ParameterError, which lists every fault of the parameters.

    Args: drawing: `Drawing` that draws the figure; None: this process draws it.
    """

    def __init__(self, drawing: Any = None) -> None:
        parameters = Parameters()
        self._drawing = drawing
        self._results = Path(os.path.expanduser(parameters.value("~results_dir", "results")))
        self._record = parameters.value("~record", True)
        self._split_mb = parameters.value("~record_split_mb", 0, minimum=0)
        self._compression = parameters.value("~record_compression", "lz4", allowed=COMPRESSIONS)
        self._video = parameters.value("~video", False)
        self._groups = parameters.build(parse_groups, rospy.get_param("~record_groups", "all"))
        self._startup_timeout_s = parameters.value("~startup_timeout_s", 60.0, minimum=1.0)
        self._stall_timeout_s = parameters.value("~stall_timeout_s", 60.0, minimum=1.0)
        parameters.known(PRIVATE_PARAMETERS)
        self._scenario = parameters.build(scenario_from_dict, rospy.get_param("scenario", {}), "scenario")
        parameters.check()
        self._graph = Graph(rospy.get_name(), os.environ["ROS_MASTER_URI"])
        self._recording = None
        self._changed = threading.Condition()
        self._status = self._state = self._result = None
        self._done_ns = None
        self._goals_sent = 0
        self.folder = None

    # ---- parts of a run -----------------------------------------------------------------------------------------

    def run(self) -> int:
        """The whole run. Returns the exit code; raises RunError, RecordingError."""
        self.folder = study("report").create_result_folder(self._results.absolute(), self._scenario.name)
        rospy.loginfo("results go to %s", self.folder)
        self._subscribe()
        self._wait("the nodes " + ", ".join(NODES), self._missing_parts, self._startup_timeout_s)
        try:
            if self._record:
                with signals_held():
                    self._recording = Recording(self.folder / "run.bag", self._topics(), self._compression,
                                                self._split_mb)
            self._wait("all connections", self._missing_connections, self._startup_timeout_s)
            wall_s = self._drive()
        except BaseException:
            with signals_held():
                self._end_recording()  # its error is not the reason
            raise
        if self._recording is not None:
            with signals_held():
                self._recording.stop()
        return self._report(wall_s)

    def _end_recording(self):
        try:
            if self._recording is not None:
                self._recording.stop()
        except (ArasError, rospy.ROSException) as error:
            rospy.logwarn("%s", error)

    def _subscribe(self):
        # The scenario is recorded in the bag, so that the bag alone is enough to judge the run again.
        self._settings = rospy.Publisher("scenario", String, queue_size=1, latch=True)
        self._settings.publish(yaml.safe_dump(self._scenario.as_dict(), sort_keys=False))
        self._goals = rospy.Publisher("servo/goal", VisualServoActionGoal, queue_size=10, latch=False)
        self._goal = GoalSender(self._goals.publish)
        rospy.Subscriber("sim/status", SimStatus, self._on_status)
        # It holds the phases and the last state. Each servo_state would wake this node at every image.
        rospy.Subscriber("servo/feedback", VisualServoActionFeedback, self._on_feedback)
        rospy.Subscriber("servo/result", VisualServoActionResult, self._on_result)
        rospy.Subscriber("servo/status", GoalStatusArray, self._on_goals)
        self._step = rospy.ServiceProxy("sim/step", Step)
        self._pause, self._unpause = (rospy.ServiceProxy(f"sim/{name}", Empty) for name in ("pause", "unpause"))

    def _missing_parts(self):
        missing = [name for name in NODES if self._graph.node_uri(rospy.resolve_name(name)) is None]
        services = self._graph.services()
        wanted = ("sim/pause", "sim/unpause", "camera/set_reference", "teach")
        missing += [f"service {name}" for name in wanted if rospy.resolve_name(name) not in services]
        topics = self._graph.topics()
        wanted = ("camera/image_raw", "camera/features", "joint_states", "joint_command", "servo_state", "servo/result")
        missing += [f"topic {name}" for name in wanted if rospy.resolve_name(name) not in topics]
        return missing + ([] if self._status is not None else ["sim/status"])

    def _topics(self):
        """Resolved names of the topics to record."""
        namespace = rospy.get_namespace()
        known = set(self._graph.topics(namespace)) | {rospy.resolve_name(topic) for topic in OUTSIDE}
        topics = sorted(topic for topic in known if is_chosen(topic, namespace, self._groups))
        for sentence in lacking({topic[len(namespace):] for topic in topics}):
            rospy.logwarn("%s", sentence)
        return topics

    def _nodes(self):
        """Full names of the nodes of a run, this one among them."""
        return {rospy.resolve_name(name) for name in NODES} | {rospy.get_name()} | \
            self._graph.publishers(rospy.resolve_name(FEATURES))

    def _missing_connections(self):
        if self._recording is not None:
            self._recording.check(self._status)
        return [f"{topic}: {publisher} -> {subscriber}"
                for topic, publisher, subscriber in self._graph.missing_connections(self._nodes())]

    def _wait(self, what, missing, timeout_s):
        """Waits on wall time until missing() returns an empty list. Raises RunError with the missing parts."""
        deadline = time.monotonic() + timeout_s
        while True:
            lacking = missing()
            if not lacking:
                return
            check_signals()
            if rospy.is_shutdown():
                raise RunError(f"shut down while waiting for {what}")
            if time.monotonic() > deadline:
                raise RunError(f"{what}: after {timeout_s:g} s still missing: {', '.join(lacking[:10])}")
            time.sleep(POLL_S)

    # ---- the run itself -----------------------------------------------------------------------------------------

    def _drive(self):
        """Send the goal, let time run, wait for the result, pause. Returns the wall time for which time ran [s]."""
        controller = rospy.resolve_name("controller")
        uri = self._graph.node_uri(controller)
        self._send_goal(VisualServoGoal.EXPERIMENT)
        lockstep = bool(self._scenario.time.get("lockstep", False))
        self._wait("the controller to take the goal" + (" and to arm the lockstep" if lockstep else ""),
                   lambda: [] if self._taken(lockstep) else ["lockstep armed" if self._goal.taken else "goal taken"],
                   self._startup_timeout_s)
        started_s = time.monotonic()
        self._unpause()
        last_time, moved_s, looked_s = None, started_s, started_s
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._result is not None or rospy.is_shutdown(), POLL_S)
            now_s = time.monotonic()
            if self._result is not None:
                break
            check_signals()
            if rospy.is_shutdown():
                raise RunError("shut down before the result")
            if self._recording is not None:
                self._recording.check(self._status)
            if now_s - looked_s > GRAPH_POLL_S:
                looked_s = now_s
                with self._changed:
                    self._goal.look(now_s)
                uri = self._follow_controller(controller, uri)
            stamp = self._status.header.stamp
            if stamp != last_time:
                last_time, moved_s = stamp, now_s
            elif now_s - moved_s > self._stall_timeout_s:
                raise RunError(f"simulated time stands still at {stamp.to_sec():.3f} s, held by "
                               f"{self._status.held_by or 'no node'}")
        if lockstep:
            self._wait("the answer to the last image", lambda: [] if self._answered() else ["a later time"], 10.0)
            self._let_it_end()
        self._pause()
        wall_s = now_s - started_s
        if self._recording is not None and self._drawing is not None:
            self._drawing.prepare()  # while the bag is closed and read
        if lockstep:
            self._close_run()
        if self._recording is not None:
            self._recording.settle()
        return wall_s

    def _taken(self, lockstep):
        """Whether the controller has accepted the goal and, in lockstep, the simulator waits for its answers."""
        if self._result is not None:
            raise RunError(f"the controller refused the goal: {self._result.reason}")
        with self._changed:
            self._goal.look(time.monotonic())
        return self._goal.taken and (not lockstep or self._status.lockstep_armed)

    def _send_goal(self, reference):
        goal = VisualServoActionGoal()
        goal.header.stamp = self._status.header.stamp
        goal.goal_id.id = f"{rospy.get_name()}-{os.getpid()}-{self._goals_sent}"
        goal.goal_id.stamp = goal.header.stamp
        goal.goal.reference = reference
        if self._scenario.time.get("lockstep", False):
            goal.goal.pause_after_s = CLOSING_S
        with self._changed:
            self._goals_sent += 1
            self._goal.send(goal, time.monotonic())

    def _follow_controller(self, controller, uri):
        """If the controller was started again, send the goal again: to its taught reference if it was servoing.

        Args: uri: the controller's address when it got the goal. Returns the address of the one that has the goal now.
        """
        now = self._graph.node_uri(controller)
        if now is None or now == uri:
            return uri
        ready = not self._graph.missing_connections(self._nodes())
        if not ready or self._goals.get_num_connections() == 0:
            return uri
        phase = self._state.phase if self._state is not None else "idle"
        reference = VisualServoGoal.TAUGHT if phase == "servo" else VisualServoGoal.EXPERIMENT
        rospy.logwarn("the controller was started again in phase %s: goal %s", phase, reference)
        self._send_goal(reference)
        return now

    def _answered(self):
        """Whether the simulator has the command that ends the servo, which may come after the result."""
        return self._done_ns is not None and self._status.header.stamp.to_nsec() > self._done_ns

    def _let_it_end(self):
        """Wait until the simulator pauses by itself, CLOSING_S after the end of the servo, as the controller told it.

        Until then the controller holds the arm, in lockstep: a step of the paused simulator would not wait for it.
        """
        end_ns, last_ns, moved_s = self._done_ns + round(CLOSING_S * 1e9), 0, time.monotonic()
        while last_ns < end_ns and time.monotonic() - moved_s < self._stall_timeout_s:
            check_signals()
            if rospy.is_shutdown():
                raise RunError("shut down before the end")
            time.sleep(POLL_S)
            now_ns = self._status.header.stamp.to_nsec()
            if now_ns != last_ns:
                last_ns, moved_s = now_ns, time.monotonic()

    def _close_run(self):
        """Step the paused simulator to exactly CLOSING_S after the end of the servo, where it has not come there.

        Without this the recorded run of a controller that has died, and its hash, would end anywhere.
        """
        end_ns = self._done_ns + round(CLOSING_S * 1e9)
        period_ns = round(self._scenario.sim.get("period_s", default_of("sim.period_s")) * 1e9)
        steps = (end_ns - self._step(0).stamp.to_nsec()) // period_ns  # sim/status may be of before the pause
        if steps < 0:
            rospy.logwarn("the pause came later than %g s after the end of the servo: the run hash differs from that "
                          "of other runs of this scenario", CLOSING_S)
            return
        self._step(steps)
        self._wait("the end", lambda: [] if self._status.header.stamp.to_nsec() >= end_ns else ["sim/status"], 10.0)

    def _on_status(self, message):
        with self._changed:
            self._status = message

    def _on_feedback(self, message):
        state = message.feedback.state
        if state.phase == "done" and self._done_ns is None and self._state is not None:
            self._done_ns = state.header.stamp.to_nsec()
        if state.phase not in ("idle", "done"):  # a controller that was just started again is idle: keep the old one
            self._state = state

    def _on_result(self, message):
        with self._changed:
            if message.status.goal_id.id == self._goal.goal_id:
                self._result = message.result
                self._changed.notify_all()

    def _on_goals(self, message):
        with self._changed:
            self._goal.heard({entry.goal_id.id: entry.status == GoalStatus.PENDING for entry in message.status_list})

    # ---- afterwards ---------------------------------------------------------------------------------------------

    def _report(self, wall_s):
        """Judge the run, write the result folder and print the result table. Returns the exit code."""
        result = self._result
        rospy.loginfo("%s after %.2f s of servoing: %s", "converged" if result.converged else "not converged",
                      result.duration_s, result.reason)
        if self._recording is None:
            if self._done_ns is not None:
                rospy.loginfo("real-time factor %.1f", self._done_ns * 1e-9 / wall_s)
            rospy.logwarn("nothing was recorded (record:=false): not judged by the true pose")
            return EXIT_PASSED if result.converged or result.status == Status.STOPPED_BY_RULE else EXIT_FAILED
        record = read_bag(self._recording.bags(), rospy.get_namespace(), keep_images=self._video)
        simulated_s = float(record.t_s[-1]) if self._done_ns is None else self._done_ns * 1e-9
        record = dataclasses.replace(record, wall_s=wall_s, real_time_factor=simulated_s / wall_s)
        report = study("report")
        summary = report.save_results(record, self.folder, rospy.get_param("~repeat", None), self._video,
                                      drawing=self._drawing)
        print(report.format_summary(summary), flush=True)
        if "truth" not in self._groups:
            rospy.logwarn("the true camera pose was not recorded (record_groups without truth): the run is not judged "
                          "by it")
            return EXIT_PASSED if summary["converged"] or summary["stopped_by_rule"] else EXIT_FAILED
        return EXIT_PASSED if summary["passed"] else EXIT_FAILED


def main() -> int:
    """Entry of node experiment. Returns the exit code, and writes it into the file ~exit_code_file if that is given.

    roslaunch ends with 0 whatever its nodes ended with; a program that starts roslaunch reads the code from the file.
    """
    with signals_raise():
        path, code = "", EXIT_BROKEN
        try:
            with study("report").Drawing(at_once=False) as drawing:
                rospy.init_node("experiment", disable_signals=True)  # rospy would not end the main thread
                path = rospy.get_param("~exit_code_file", "")
                code = ExperimentNode(drawing).run()
        except Interrupted as interrupt:
            rospy.logfatal("%s", interrupt)
            code = interrupt.exit_code
        except ParameterError as error:
            rospy.logfatal("bad parameters:\n%s", error)
            code = EXIT_PARAMETERS
        except (ArasError, rospy.ROSException, rospy.ServiceException) as error:
            rospy.logfatal("%s", error)
        if path:
            Path(path).write_text(f"{code}\n", encoding="ascii")
        return code
