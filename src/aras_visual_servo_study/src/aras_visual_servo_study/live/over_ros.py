"""Node `live_page`: serves the live page of a run over ROS. It listens to the run's topics and calls its services.

Images and features are subscribed to only while a page is ready for them, so that none are sent for nothing.
"""

import asyncio
import sys
import time
from typing import Any, Dict, List, Optional

import numpy as np
import rospy
from geometry_msgs.msg import PoseStamped
from sensor_msgs.msg import CameraInfo, Image, JointState
from std_srvs.srv import Empty, Trigger

from aras_visual_servo_msgs.msg import MomentFeatures, ServoState, SimStatus, VisualServoActionGoal
from aras_visual_servo_msgs.srv import SetModelMotion, SetTargetPose, Step, Teach

from aras_visual_servo_controller import JointReader, LazyJointState, call_service, goal_message, stamp_ns, to_time
from aras_visual_servo import (ArasError, ParameterError, Servo, ServoRecord, ShapeError, Status, image_of,
                               kinematics_of, scenario_from_dict, spatial)
from .messages import Start
from .page_run import PageRun
from .runner import Runner
from .server import Server
from .settings import AT_ONCE, acts_at_once, changed

EXIT_STOPPED, EXIT_PARAMETERS = 0, 2
#: Between two looks at what has come, while a page is ready for it, and while none is [s].
LOOK_S, IDLE_S = 1.0 / 60.0, 0.1
#: Images are listened to for this long after the last page was ready for one [s].
LINGER_S = 1.0
#: Joint states of several messages that are no farther apart make one [s].
APART_S = 0.1
#: Joint positions this close to an answer tell where the arm is with it [s].
FRESH_S = 0.2
#: How many places of the target are kept: one that belongs to an image is needed once that image is answered.
MOST_TARGETS = 1000


class RosRun(PageRun):
    """The run of this namespace.

    Raises: ParameterError and ModelError: what is wrong with the parameters.
    """

    #: Settings that nodes take over while they run.
    at_once = tuple(pattern for pattern in AT_ONCE if pattern.startswith(("servo", "sim")))
    asks_nodes = True

    def __init__(self) -> None:
        super().__init__(scenario_from_dict(rospy.get_param("scenario")))
        self.urdf_xml, scenario = self.scenario.urdf_xml(), self.scenario
        kinematics = kinematics_of(self.urdf_xml, scenario.robot, calibrated=False)
        models = scenario.sim.get("scene", {}).get("models", [])
        info = rospy.wait_for_message("camera/camera_info", CameraInfo, timeout=60.0)
        self.renew(kinematics, Servo(kinematics, scenario.servo), {
            "width": info.width, "height": info.height, "K": list(info.K), "D": list(info.D),
            "distortion_model": info.distortion_model}, models[0]["name"] if models else None)
        self._reader, self._q = JointReader(kinematics.joint_names), None
        self._joints: Any = None
        self._status, self._speed = SimStatus(), float(scenario.time.get("real_time_factor", 0.0))
        self._X_WT, self._targets = None, {}  # the newest; stamp of an image [ns]: X_WT, of the last ones
        self._is_new, self._listening, self._ready_s = False, [], 0.0
        self._commands = rospy.Publisher("joint_command", JointState, queue_size=10)
        self._goals = rospy.Publisher("servo/goal", VisualServoActionGoal, queue_size=10)
        self._always = [
            rospy.Subscriber("joint_states", LazyJointState, self._on_joints, tcp_nodelay=True),
            rospy.Subscriber("servo_state", ServoState, self._on_state, tcp_nodelay=True),
            rospy.Subscriber("sim/status", SimStatus, self._on_status),
            rospy.Subscriber("ground_truth/target_pose", PoseStamped, self._on_target)]

    # --- what comes -------------------------------------------------------------------------------------------------

    def _on_joints(self, message):
        if self.watched or self.hand.busy:
            message = message.unpack()
            q = self._reader.merged(message, APART_S)
            if q is not None:
                self._joints, self._q = message, q
                self.drive_by_hand(self.time_ns)

    def _on_state(self, message):
        twist, at_ns, self.used = message.twist, stamp_ns(message.header), self.scenario
        self.record = record = ServoRecord(
            at_ns, Status(message.status), message.status_text, message.phase or "idle", e=np.asarray(message.e),
            twist=np.array([getattr(part, axis) for part in (twist.linear, twist.angular) for axis in "xyz"]),
            q=np.asarray(message.q), cond_l=message.cond_l, manipulability=message.manipulability)
        X_WT = self._targets.get(at_ns)
        if self.begin_again(record, X_WT, self.follow and not self.hand.busy):
            self._send_goal("taught")
        else:  # joints are listened to only while a page looks
            fresh = self._q is not None and abs(self.time_ns - at_ns) < 1e9 * FRESH_S
            q = self._q if fresh else record.q
            if len(q):
                self.record = record = self.of_now(record, q, X_WT)
        known = len(record.q) > 0 and np.isfinite(record.q).all()
        if known:
            self.X_WC = self.kinematics.pose(record.q)
        if record.phase == "teach":
            self._taught_at(record.q if known else None)
        if known and len(record.e) == len(self.servo.feature_names):
            self._is_new = True

    def _on_status(self, message):
        if message.header.stamp < self._status.header.stamp:  # the simulator was reset
            self.goal, self.taught, self._targets = None, False, {}
        self._status = message

    def _on_target(self, message):
        p, q = message.pose.position, message.pose.orientation
        self._X_WT = spatial.pose_from_quaternion((p.x, p.y, p.z), (q.x, q.y, q.z, q.w))
        targets = self._targets
        targets[stamp_ns(message.header)] = self._X_WT
        if len(targets) > MOST_TARGETS:
            del targets[next(iter(targets))]

    def _on_image(self, message):
        try:
            self.image = image_of(message)
        except ShapeError as error:
            rospy.logwarn_throttle(10.0, "%s", error)
            return
        self.images += 1

    def _on_features(self, message):
        self.features = message

    def _taught_at(self, q):
        self.taught = True
        if q is not None:
            self.keep_goal(self.kinematics.camera(q))

    # --- what stands there ------------------------------------------------------------------------------------------

    @property
    def ready(self) -> bool:
        """Returns whether the controller takes goals."""
        return self._goals.get_num_connections() > 0

    @property
    def time_ns(self) -> int:
        """Returns the stamp of the newest joint positions [ns]."""
        return 0 if self._joints is None else stamp_ns(self._joints.header)

    @property
    def frame(self) -> int:
        """Returns the number of images that the simulator has taken."""
        return self._status.frames

    def joints(self) -> Optional[np.ndarray]:
        """Returns the newest joint positions, (n,), None before the first."""
        return self._q

    def camera_pose(self) -> np.ndarray:
        """Returns X_WC, (4, 4), at the newest joint positions; at zero within the limits before the first."""
        kinematics = self.kinematics
        zero = np.clip(np.zeros(len(kinematics.joint_names)), kinematics.lower, kinematics.upper)
        return kinematics.camera(zero if self._q is None else self._q)

    def target_pose(self) -> Optional[np.ndarray]:
        """Returns the newest X_WT, (4, 4), None before the first."""
        return self._X_WT

    def row(self, _real_time_factor: float) -> List[Optional[float]]:
        return super().row(self._status.real_time_factor)

    def state(self) -> Dict[str, Any]:
        return {**super().state(), "paused": self._status.paused, "speed": self._speed,
                "factor": round(self._status.real_time_factor, 3)}

    def advance(self, _most_ns: int) -> bool:
        """Waits a moment, and listens to images while there are viewers. Returns whether the servo has answered one."""
        time.sleep(LOOK_S if self.watched else IDLE_S)
        if self.watched:
            self._ready_s = time.perf_counter()
            self._listening = self._listening or [
                rospy.Subscriber("camera/image_raw", Image, self._on_image, queue_size=1, buff_size=1 << 24),
                rospy.Subscriber("camera/features", MomentFeatures, self._on_features, queue_size=1)]
        elif self._listening and time.perf_counter() - self._ready_s > LINGER_S:
            for subscriber in self._listening:
                subscriber.unregister()
            self._listening = []
        new, self._is_new = self._is_new, False
        return new

    # --- what a page asks for ---------------------------------------------------------------------------------------

    def do(self, request: Any) -> Dict[str, Any]:
        try:
            return super().do(request)
        except (rospy.ROSException, rospy.ServiceException) as error:
            raise ArasError(f"{request.do}: {error}") from error

    def command(self, positions: Dict[str, float], time_ns: int) -> None:
        """Publishes set-points of joints by name [m or rad]."""
        message = JointState(name=list(positions), position=list(positions.values()))
        message.header.stamp = to_time(time_ns)
        self._commands.publish(message)

    def _send_goal(self, reference):
        self._goals.publish(goal_message(reference))

    def do_start(self, request: Any) -> None:
        self.hand.let_go()
        self._send_goal(request.reference)

    def do_again(self, _request: Any) -> None:
        self.do_start(Start())

    def do_draw_start(self, _request: Any) -> Dict[str, Any]:
        raise ParameterError("draw_start: over ROS the start is read when the nodes begin; allowed: `aras-servo live`")

    def do_stop(self, _request: Any) -> None:
        self.hand.let_go()
        call_service("stop", Trigger)

    def teach(self, z_star_m: Optional[float]) -> None:
        """Calls the service `teach`. Args: z_star_m: depth of the target; None: the experiment's."""
        call_service("teach", Teach, z_star_m or 0.0)
        self._taught_at(self._q)

    def do_reset(self, _request: Any) -> None:
        self.hand.let_go()
        call_service("sim/reset", Empty)

    def do_pause(self, request: Any) -> None:
        call_service("sim/pause" if request.paused else "sim/unpause", Empty)

    def do_step(self, request: Any) -> None:
        sim = self.scenario.sim
        rate_hz = (sim.get("cameras") or [{}])[0].get("rate_hz", 30.0)
        call_service("sim/step", Step, max(1, round(request.images / rate_hz / sim.get("period_s", 0.001))))

    def do_set(self, request: Any) -> Dict[str, Any]:
        if request.reset:
            raise ParameterError("set.reset: found true; over ROS the simulator alone begins anew, allowed false")
        others = [path for path in (request.values or {}) if not acts_at_once(path, self.at_once)]
        if others:
            raise ParameterError(f"{', '.join(others)}: over ROS this is read when the nodes start; allowed are "
                                 "settings of servo, of how cameras see, and of light")
        scenario = changed(self.scenario, request.values)
        for section, service in (("servo", "reconfigure"), ("sim", "sim/reconfigure")):
            if getattr(scenario, section) != getattr(self.scenario, section):
                self._reread(section, getattr(scenario, section), service)
        self.scenario, names = scenario, self.servo.feature_names
        self.servo = Servo(self.kinematics, scenario.servo)
        if self.servo.feature_names != names or "servo.law" in request.values:
            self.version += 1
        return {"waiting": []}

    def _reread(self, section, values, service):
        """Set a section of the scenario and let its node read it again; as it was if the node refuses it."""
        before = rospy.get_param("scenario/" + section)
        rospy.set_param("scenario/" + section, values)
        try:
            call_service(service, Trigger)
        except Exception:
            rospy.set_param("scenario/" + section, before)
            raise

    def do_speed(self, request: Any) -> None:
        self._reread("time/real_time_factor", float(request.factor), "sim/reconfigure")
        self._speed = request.factor

    def place_target(self, position_m: List[float], q_xyzw: List[float]) -> None:
        """Calls the simulator's set_target_pose."""
        message = PoseStamped().pose
        message.position.x, message.position.y, message.position.z = position_m
        turn = message.orientation
        turn.x, turn.y, turn.z, turn.w = q_xyzw
        call_service("sim/set_target_pose", SetTargetPose, self.target, message)

    def move_target(self, motion: Optional[Dict[str, Any]]) -> None:
        """Calls the simulator's set_model_motion."""
        call_service("sim/set_model_motion", SetModelMotion, self.target, "" if motion is None else str(motion))


async def _serve(run, host, port):
    runner = Runner(run, 0.0, Start() if rospy.get_param("~start_with_page", False) else None)
    server = Server(runner, run.urdf_xml)
    address = server.listen(host, port)
    rospy.set_param("~address", address)
    print(f"live page: {address}", flush=True)
    runner.start()
    try:
        while not rospy.is_shutdown():
            await asyncio.sleep(IDLE_S)
    finally:
        server.close()
        runner.close()


def main() -> int:
    """Serves until ROS shuts down. Returns the exit code."""
    rospy.init_node("live_page")
    try:
        asyncio.run(_serve(RosRun(), rospy.get_param("~host", "127.0.0.1"), rospy.get_param("~port", 8765)))
    except (ArasError, KeyError) as error:
        rospy.logfatal("live page: %s", error)
        return EXIT_PARAMETERS
    except rospy.ROSException as error:
        if not rospy.is_shutdown():
            rospy.logfatal("live page: %s", error)
            return EXIT_PARAMETERS
    return EXIT_STOPPED


if __name__ == "__main__":
    sys.exit(main())
