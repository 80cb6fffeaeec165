"""Velocities: ros_control's JointVelocityController, or JointGroupVelocityController for all joints."""

from .base import Form, register_form


@register_form("velocity")
class Velocity(Form):
    """One number per joint [m/s or rad/s]."""

    def messages(self, point):
        return self._numbers(point.joint_names, point.velocity)
