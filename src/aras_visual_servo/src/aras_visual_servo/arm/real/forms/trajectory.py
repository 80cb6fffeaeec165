"""Trajectories: ros_control's JointTrajectoryController, one point a little ahead, replaced by the next message."""

from .base import Form, Message, register_form


@register_form("trajectory")
class Trajectory(Form):
    """trajectory_msgs/JointTrajectory with one point `ahead_s` from now; at rest the point is the set-point itself."""

    def messages(self, point):
        ahead_s = self._settings.ahead_s
        velocity = [0.0 if point.resting else float(v) for v in point.velocity]
        position = [float(q) + v * ahead_s for q, v in zip(point.position, velocity)]
        # A stamp of 0 tells the driver to begin at once: its clock may differ from ours.
        fields = {"header": 0, "joint_names": list(point.joint_names),
                  "points": [{"positions": position, "velocities": velocity, "time_from_start_s": ahead_s}]}
        return [Message(f"{self._settings.controller}/command", "trajectory_msgs/JointTrajectory", fields)]
