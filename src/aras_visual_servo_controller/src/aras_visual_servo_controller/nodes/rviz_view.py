"""Node `rviz_view`: markers, images and buttons of a servo run for rviz, started by `servo.launch rviz:=true`.

It publishes the view that was taught (`goal_view`), the errors as a curve (`error_plot`), the pyramid that the camera
sees (`camera_frustum`), and buttons in the 3-D view (`buttons`): run again, servo to the taught view, stop, reset.
It only listens, except for the actions of its buttons.
"""

import time
from collections import OrderedDict
from typing import Any

import rospy
from geometry_msgs.msg import Point, Pose, Quaternion, Vector3
from interactive_markers.interactive_marker_server import InteractiveMarkerServer
from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import ColorRGBA, Header
from std_srvs.srv import Empty, Trigger
from visualization_msgs.msg import InteractiveMarker, InteractiveMarkerControl, InteractiveMarkerFeedback, Marker

from aras_visual_servo import ParameterError
from aras_visual_servo_msgs.msg import ServoState, VisualServoActionGoal
from . import conversions as convert
from .calls import SERVICE_TIMEOUT_S, call_service
from .error_plot import ErrorPlot
from .parameters import ControllerSetup

EXIT_STOPPED, EXIT_PARAMETERS = 0, 2
#: Wall time between two pictures of the errors within one phase [s].
PLOT_S = 0.2
#: The image that was taught is looked for among so many.
KEPT_IMAGES = 64
#: Place of the first button in the world, and the way to the next [m].
FIRST_BUTTON_M, BUTTON_WAY_M, BUTTON_M = (0.75, 0.55, 1.35), -0.19, 0.08
#: Button: its label, its colour.
BUTTONS = {"run again": (0.20, 0.55, 0.25), "servo to the taught view": (0.15, 0.40, 0.75), "stop": (0.75, 0.20, 0.15),
           "reset": (0.45, 0.45, 0.45)}


def frustum_points(info: Any, depth_m: float) -> Any:
    """Ends of the eight edges of the pyramid that a pinhole camera sees down to a depth, pair by pair.

    Args: info: CameraInfo, whose K is used.  depth_m: > 0.
    Returns: list of 16 (x, y, z) in the optical frame [m].
    """
    fx, cx, fy, cy = info.K[0], info.K[2], info.K[4], info.K[5]
    corners = [((u - cx) / fx * depth_m, (v - cy) / fy * depth_m, depth_m)
               for u, v in ((-0.5, -0.5), (info.width - 0.5, -0.5), (info.width - 0.5, info.height - 0.5),
                            (-0.5, info.height - 0.5))]
    points = []
    for k, corner in enumerate(corners):
        points += [(0.0, 0.0, 0.0), corner, corner, corners[(k + 1) % 4]]
    return points


class RvizView:
    """The node. Raises ParameterError: the parameters of the controller are not fit."""

    def __init__(self) -> None:
        setup = ControllerSetup(teach_camera=None)
        servo, source = setup.servo, setup.servo.source
        self._depth_m = setup.sequence.config.z_star_m
        self._plot, self._plotted_s = ErrorPlot(servo.feature_names, servo.config.thresholds), 0.0
        self._phase = ""
        self._images, self._reference_ns = OrderedDict(), -1
        self._goal_view = rospy.Publisher("goal_view", Image, queue_size=1, latch=True)
        self._plots = rospy.Publisher("error_plot", Image, queue_size=1)
        self._frustum = rospy.Publisher("camera_frustum", Marker, queue_size=1, latch=True)
        self._goals = rospy.Publisher("servo/goal", VisualServoActionGoal, queue_size=10)
        self._shape = None
        self._server = InteractiveMarkerServer("buttons")
        for row, (name, colour) in enumerate(BUTTONS.items()):
            self._server.insert(_button(name, colour, row), lambda _feedback: None)
        self._server.applyChanges()
        # Not through the server's callback: that drops clicks of the first second of simulated time.
        rospy.Subscriber("buttons/feedback", InteractiveMarkerFeedback, self._pressed, queue_size=10)
        rospy.Subscriber("camera/camera_info", CameraInfo, self._on_info, queue_size=1)
        rospy.Subscriber("camera/image_raw", Image, self._on_image, queue_size=10, buff_size=1 << 24)
        if not source.from_elsewhere:
            rospy.Subscriber(source.topic, convert.message_class(source.message), self._on_features, queue_size=10)
        rospy.Subscriber("servo_state", ServoState, self._on_state, queue_size=10)

    # --- display ------------------------------------------------------------------------------------------

    def _on_info(self, info):
        shape = info.header.frame_id, info.width, info.height, tuple(info.K)
        if shape == self._shape:
            return
        self._shape = shape
        self._frustum.publish(Marker(
            header=Header(frame_id=info.header.frame_id), type=Marker.LINE_LIST, action=Marker.ADD, ns="camera_frustum",
            pose=_at(), scale=Vector3(x=0.003), color=ColorRGBA(0.95, 0.65, 0.1, 0.9),
            points=[Point(*point) for point in frustum_points(info, self._depth_m)]))

    def _on_image(self, image):
        self._images[convert.stamp_ns(image.header)] = image
        while len(self._images) > KEPT_IMAGES:
            self._images.popitem(last=False)

    def _on_features(self, features):
        """Show the image that is the reference of these features, once."""
        stamp_ns = features.reference_stamp_ns
        if stamp_ns != self._reference_ns and stamp_ns in self._images:
            self._reference_ns = stamp_ns
            self._goal_view.publish(self._images[stamp_ns])

    def _on_state(self, state):
        stamp_ns = convert.stamp_ns(state.header)
        self._plot.add(stamp_ns * 1e-9, state.e)
        # A new phase is shown at once: after the last one no state may come that would show how the servo ended.
        now_s, changed = time.monotonic(), state.phase != self._phase
        self._phase = state.phase
        if not self._plots.get_num_connections() or now_s - self._plotted_s < PLOT_S and not changed:
            return
        self._plotted_s = now_s
        self._plots.publish(convert.picture_message(self._plot.draw(), stamp_ns, state.header.frame_id))

    # --- buttons ----------------------------------------------------------------------------------------

    def _pressed(self, feedback):
        if feedback.event_type != InteractiveMarkerFeedback.BUTTON_CLICK or feedback.marker_name not in BUTTONS:
            return
        try:
            rospy.loginfo("rviz: %s", feedback.marker_name)
            self.press(feedback.marker_name)
        except (ParameterError, rospy.ROSException, rospy.ServiceException) as error:
            rospy.logerr("rviz: %s: %s", feedback.marker_name, error)

    def press(self, name: str) -> None:
        """Runs the action of the button of this name.

        Raises: ParameterError: the service refuses.  ROSException, ServiceException: it cannot be called.
        """
        if name == "stop":
            call_service("stop", Trigger)
        elif name == "reset":
            call_service("sim/reset", Empty)
        else:
            deadline_s = time.monotonic() + SERVICE_TIMEOUT_S
            while not self._goals.get_num_connections() and time.monotonic() < deadline_s:
                time.sleep(0.01)
            self._goals.publish(convert.goal_message("experiment" if name == "run again" else "taught"))
        if name != "stop":
            call_service("sim/unpause", Empty)  # the experiment leaves the simulator paused when it has ended


def _at(x=0.0, y=0.0, z=0.0):
    """Pose that is not turned."""
    return Pose(Point(x, y, z), Quaternion(w=1.0))


def _button(name, colour, row):
    """Interactive marker: a coloured block with its name beside it."""
    x, y, z = FIRST_BUTTON_M
    block = Marker(type=Marker.CUBE, pose=_at(), scale=Vector3(BUTTON_M, BUTTON_M, BUTTON_M),
                   color=ColorRGBA(*colour, 1.0))
    words = Marker(type=Marker.TEXT_VIEW_FACING, text=name, pose=_at(z=0.85 * BUTTON_M),
                   scale=Vector3(z=0.6 * BUTTON_M), color=ColorRGBA(0.1, 0.1, 0.1, 1.0))
    control = InteractiveMarkerControl(name="press", interaction_mode=InteractiveMarkerControl.BUTTON,
                                       always_visible=True, markers=[block, words])
    return InteractiveMarker(header=Header(frame_id="world"), pose=_at(x, y, z + row * BUTTON_WAY_M), name=name,
                             scale=2.0 * BUTTON_M, controls=[control])


def main() -> int:
    """Entry of node rviz_view. Returns the exit code: 0 after a shutdown, 2 for bad parameters."""
    rospy.init_node("rviz_view")
    try:
        RvizView()
    except ParameterError as error:
        rospy.logfatal("rviz_view: bad parameters:\n%s", error)
        return EXIT_PARAMETERS
    rospy.spin()
    return EXIT_STOPPED
