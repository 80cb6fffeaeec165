"""Node `live_page`: serves the live page of a run over ROS. It listens to the run's topics and calls its services.

What a page sees and asks for is the same as in process (live/messages.py).
Images and features are subscribed to only while a page is ready for them, so that nobody sends them for nothing.
"""

import asyncio
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace

import numpy as np
import rospy
from geometry_msgs.msg import PoseStamped
from sensor_msgs.msg import CameraInfo, Image, JointState
from std_srvs.srv import Empty, Trigger

from aras_visual_servo_msgs.msg import MomentFeatures, ServoState, SimStatus, VisualServoActionGoal
from aras_visual_servo_msgs.srv import SetModelMotion, SetTargetPose, Step, Teach

from aras_visual_servo_controller.nodes import conversions as convert
from aras_visual_servo_controller.nodes.calls.services import call_service
from aras_visual_servo import (ArasError, ParameterError, Servo, ShapeError, Status, image_of, kinematics_of,
                               scenario_from_dict, spatial)
from .about import about, marks_of, row, saved
from .following import Following
from .hand import Hand
from .runner import MOST_ROWS, Sample
from .server import Server
from .settings import AT_ONCE, acts_at_once, changed
from .view.scene import pose_numbers

EXIT_STOPPED, EXIT_PARAMETERS = 0, 2
LOOK_S = 1.0 / 60.0
#: Images are listened to for this long after the last page was ready for one [s].
LINGER_S = 1.0
#: How many places of the target are kept: one that belongs to an image is needed once that image is answered.
MOST_TARGETS = 1000
#: Settings that nodes take over while they run.
ROS_AT_ONCE = tuple(pattern for pattern in AT_ONCE if pattern.startswith(("servo", "sim")))
MOVING = ("to_goal", "settle_goal", "teach", "to_start", "settle_start", "servo")


class RosRun:
    """The run of this namespace, with the attributes of `Runner` that hub and server use.

    Raises: ParameterError and ModelError: what is wrong with the parameters.
    """

    def __init__(self, start_with_page=False):
        document = rospy.get_param("scenario")
        self._scenario = scenario_from_dict(document)
        self.urdf_xml = self._scenario.urdf_xml()
        self._kinematics = kinematics_of(self.urdf_xml, self._scenario.robot, calibrated=False)
        self._servo = Servo(self._kinematics, self._scenario.servo)
        models = self._scenario.sim.get("scene", {}).get("models", [])
        self._target = models[0]["name"] if models else None
        self._joints, self._hand = convert.JointReader(self._kinematics.joint_names), Hand(self._kinematics)
        self._pool, self._lock = ThreadPoolExecutor(1), threading.Lock()
        self.rows, self.sample, self.watched = [], None, False
        self._row_count, self._start_with_page, self._listening = 0, start_with_page, []
        self._q = self._q_all = self._state = self._image = self._features = self._goal = None
        self._X_WC, self._X_WT, self._teach, self._status = None, None, None, SimStatus()
        self._image_number, self._shown, self._ready_s, self._taught = 0, -1.0, 0.0, False
        self._speed, self._following = float(self._scenario.time.get("real_time_factor", 0.0)), Following()
        self._targets = {}  # stamp of an image [ns]: X_WT, of the last ones
        self._follow = self._scenario.robot.get("target_link") is None  # one that the arm carries moves with the arm
        info = rospy.wait_for_message("camera/camera_info", CameraInfo, timeout=60.0)
        self._info = {"width": info.width, "height": info.height, "K": list(info.K), "D": list(info.D),
                      "distortion_model": info.distortion_model}
        self._commands = rospy.Publisher("joint_command", JointState, queue_size=10)
        self._goals = rospy.Publisher("servo/goal", VisualServoActionGoal, queue_size=10)
        self._always = [
            rospy.Subscriber("joint_states", convert.LazyJointState, self._on_joints, tcp_nodelay=True),
            rospy.Subscriber("servo_state", ServoState, self._on_state, tcp_nodelay=True),
            rospy.Subscriber("sim/status", SimStatus, self._on_status),
            rospy.Subscriber("ground_truth/target_pose", PoseStamped, self._on_target)]
        at_C = self._kinematics.camera(np.clip(np.zeros(len(self._kinematics.joint_names)), self._kinematics.lower,
                                               self._kinematics.upper))[:3, 3]
        self._at_C, self.about = at_C, None
        self._tell()

    def _tell(self):
        version = 1 if self.about is None else self.about["version"] + 1
        self.about = {**about(self._scenario, self._kinematics, self._info, self._servo, self._at_C, self._X_WT,
                              self._target),
                      "version": version, "values": self._scenario.as_dict(), "waiting": [],
                      "at_once": list(ROS_AT_ONCE)}

    # --- what comes -------------------------------------------------------------------------------------------------

    def _on_joints(self, message):
        if not (self.watched or self._hand.busy):
            return
        unpacked = message.unpack()
        self._q = self._joints.positions(unpacked)
        self._q_all = unpacked
        if self._hand.busy:
            self._drive(unpacked)

    def _drive(self, joints):
        """Joints by hand: the same walk as in process, its commands sent as messages."""
        stamp_ns = convert.stamp_ns(joints.header)
        sim = SimpleNamespace(joint_names=joints.name, joint_positions=joints.position, set_command=self._command)
        self._hand.drive(SimpleNamespace(sim=sim), stamp_ns)

    def _command(self, position, velocity, stamp_ns):
        names = list(position)
        message = JointState(name=names, position=[position[name] for name in names])
        message.header.stamp = convert.to_time(stamp_ns)
        self._commands.publish(message)

    def _on_state(self, message):
        self._state = message
        self._follow_target(message)
        if message.phase == "teach":
            self._keep_goal(np.asarray(message.q))
        if not message.q or time.perf_counter() - self._row_s < 0.9 / 30.0:
            return
        self._row_s = time.perf_counter()
        record = SimpleNamespace(
            stamp_ns=convert.stamp_ns(message.header), e=message.e, cond_l=message.cond_l,
            manipulability=message.manipulability, twist=_twist(message.twist))
        q = np.asarray(message.q)
        if not np.isfinite(q).all():
            return
        at_C = self._kinematics.pose(q)[:3, 3]
        if len(message.e) == len(self._servo.feature_names):
            numbers = row(record, q, self._status.real_time_factor, at_C, self._marks())
            self.rows.append((self._row_count, numbers))
            self._row_count += 1
            del self.rows[:-MOST_ROWS]

    _row_s = -1.0

    def _on_status(self, message):
        if message.header.stamp < self._status.header.stamp:  # the simulator was reset
            self.rows.clear()
            self._goal, self._taught, self._targets = None, False, {}
        self._status = message

    def _on_target(self, message):
        p, q = message.pose.position, message.pose.orientation
        self._X_WT = spatial.pose_from_quaternion((p.x, p.y, p.z), (q.x, q.y, q.z, q.w))
        targets = self._targets
        targets[convert.stamp_ns(message.header)] = self._X_WT
        if len(targets) > MOST_TARGETS:
            del targets[next(iter(targets))]

    def _follow_target(self, state):
        """Begin to servo again when the target has moved since the servo ended."""
        X_WT, follow = self._targets.get(convert.stamp_ns(state.header)), self._follow and not self._hand.busy
        if X_WT is not None and self._following.answered(state.phase, state.status, X_WT, follow):
            self._send_goal("taught")

    def _on_image(self, message):
        try:
            self._image = image_of(message)
        except ShapeError as error:
            rospy.logwarn_throttle(10.0, "%s", error)
            return
        self._image_number += 1

    def _keep_goal(self, q):
        """The image that came last is the one that was taught."""
        self._taught = True
        if self._image is not None and np.isfinite(q).all():
            self._goal = self._image_number, self._image, self._marks(), pose_numbers(self._kinematics.camera(q))

    def _on_features(self, message):
        self._features = message

    def _marks(self):
        return marks_of(self._features, self._info)

    def look(self):
        """Called often: listen to images while somebody looks, and make the newest sample."""
        now_s = time.perf_counter()
        if self.watched:
            self._ready_s = now_s
            if not self._listening:
                self._listening = [
                    rospy.Subscriber("camera/image_raw", Image, self._on_image, queue_size=1, buff_size=1 << 24),
                    rospy.Subscriber("camera/features", MomentFeatures, self._on_features, queue_size=1)]
            if self._start_with_page and self._goals.get_num_connections():
                self._start_with_page = False
                self._send_goal("experiment")
        elif self._listening and now_s - self._ready_s > LINGER_S:
            for subscriber in self._listening:
                subscriber.unregister()
            self._listening = []
        if not self.watched or self._q is None or now_s - self._shown < 0.9 * LOOK_S:
            return
        self._shown = now_s
        state, status = self._state, self._status
        code = Status(state.status) if state is not None else Status.IDLE
        shown = {"t": round(convert.stamp_ns(self._q_all.header) * 1e-9, 4), "q": [round(float(x), 6) for x in self._q],
                 "camera": pose_numbers(self._kinematics.camera(self._q)), "target": pose_numbers(self._X_WT),
                 "status": code.name, "text": state.status_text if state else "",
                 "phase": state.phase if state else "idle", "taught": self._taught,
                 "frame": status.frames, "follow": self._follow, "paused": status.paused, "speed": self._speed,
                 "factor": round(status.real_time_factor, 3)}
        number = 0 if self.sample is None else self.sample.number + 1
        self.sample = Sample(number, shown, self._image, self._image_number, self._marks(), self._goal,
                             self.about["version"])

    # --- what a page asks for ---------------------------------------------------------------------------------------

    def submit(self, request):
        """Future of the answer to a request, dict; an ArasError where it is refused."""
        return self._pool.submit(self._do, request)

    def _do(self, request):
        try:
            return getattr(self, "do_" + request.do)(request) or {}
        except (rospy.ROSException, rospy.ServiceException) as error:
            raise ArasError(f"{request.do}: {error}") from error

    def _moving(self):
        return self._state is not None and self._state.phase in MOVING

    def _send_goal(self, reference):
        self._goals.publish(convert.goal_message(reference))

    def do_start(self, request):
        """A goal of the action `servo`."""
        self._hand.let_go()
        self._send_goal(request.reference)

    def do_stop(self, _request):
        """The service `stop`."""
        self._hand.let_go()
        call_service("stop", Trigger)

    def do_teach(self, request):
        """The service `teach`."""
        if self._moving():
            raise ParameterError(f"teach: found the run in phase {self._state.phase}, allowed when it is stopped")
        call_service("teach", Teach, request.z_star_m or 0.0)
        self._following.taught()
        self._keep_goal(self._q)

    def do_reset(self, _request):
        """The simulator's reset; the controller sees time go back."""
        self._hand.let_go()
        call_service("sim/reset", Empty)

    def do_pause(self, request):
        """The simulator's pause and unpause."""
        call_service("sim/pause" if request.paused else "sim/unpause", Empty)

    def do_step(self, request):
        """Steps of the simulator, as many as lie between images."""
        sim = self._scenario.sim
        rate_hz = (sim.get("cameras") or [{}])[0].get("rate_hz", 30.0)
        call_service("sim/step", Step, max(1, round(request.images / rate_hz / sim.get("period_s", 0.001))))

    def do_set(self, request):
        """Settings of the servo: the parameters are set, and the controller reads them again."""
        others = [path for path in (request.values or {}) if not acts_at_once(path, ROS_AT_ONCE)]
        if others:
            raise ParameterError(f"{', '.join(others)}: over ROS this is read when the nodes start; allowed are "
                                 "settings of servo, of how cameras see, and of light")
        scenario = changed(self._scenario, request.values)
        for section, service in (("servo", "reconfigure"), ("sim", "sim/reconfigure")):
            if getattr(scenario, section) != getattr(self._scenario, section):
                self._reread(section, getattr(scenario, section), service)
        self._scenario, names = scenario, self._servo.feature_names
        self._servo = Servo(self._kinematics, scenario.servo)
        if self._servo.feature_names != names or "servo.law" in request.values:
            self.rows.clear()
            self._tell()
        else:
            self.about = {**self.about, "values": scenario.as_dict()}
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

    def do_speed(self, request):
        """The simulator reads its pace again."""
        self._reread("time/real_time_factor", float(request.factor), "sim/reconfigure")
        self._speed = request.factor

    def do_follow(self, request):
        """Servo again when the target has moved since the servo ended."""
        self._follow = request.follow

    def do_place_target(self, request):
        """The simulator's set_target_pose."""
        message = PoseStamped().pose
        message.position.x, message.position.y, message.position.z = request.position_m
        turn = message.orientation
        turn.x, turn.y, turn.z, turn.w = request.q_xyzw
        call_service("sim/set_target_pose", SetTargetPose, self._target or "", message)

    def do_move_target(self, request):
        """The simulator's set_model_motion."""
        text = "" if request.motion is None else str(request.motion)
        call_service("sim/set_model_motion", SetModelMotion, self._target or "target", text)

    def do_joint(self, request):
        """Commands on joint_command, a little farther with every joint state."""
        if self._moving():
            raise ParameterError(f"joint: found the run in phase {self._state.phase}, allowed when it is stopped")
        joints = self._q_all
        sim = SimpleNamespace(joint_names=joints.name, joint_positions=joints.position)
        self._hand.hold(request.name, request.position, SimpleNamespace(sim=sim))

    def do_save(self, request):
        """What stands there as a scenario file."""
        start = dict(zip(self._kinematics.joint_names, self._q)) if request.start_here else None
        target = None if self._X_WT is None else self._target
        return {"yaml": saved(self._scenario, request.name, self._X_WT, target, start)}


def _twist(message):
    return [*(getattr(message.linear, axis) for axis in "xyz"), *(getattr(message.angular, axis) for axis in "xyz")]


async def _serve(run, host, port):
    server = Server(run, run.urdf_xml)
    address = server.listen(host, port)
    rospy.set_param("~address", address)
    print(f"live page: {address}", flush=True)
    try:
        while not rospy.is_shutdown():
            run.look()
            await asyncio.sleep(LOOK_S if server.hub.viewers else 0.1)
    finally:
        server.close()


def main():
    """Entry point. Returns the exit code."""
    rospy.init_node("live_page")
    try:
        run = RosRun(rospy.get_param("~start_with_page", False))
        asyncio.run(_serve(run, rospy.get_param("~host", "127.0.0.1"), rospy.get_param("~port", 8765)))
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
