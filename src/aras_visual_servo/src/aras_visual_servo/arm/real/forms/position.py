"""Position set-points: ros_control's JointPositionController, or JointGroupPositionController for all joints."""

from .base import Form, register_form


@register_form("position")
class Position(Form):
    """One number per joint [m or rad]."""

    def messages(self, point):
        return self._numbers(point.joint_names, point.position)
