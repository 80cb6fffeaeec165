"""Calls a service of another node and says why it was refused."""

from typing import Any
import rospy

from aras_visual_servo import ParameterError

#: Wall time within which a service must be offered [s].
SERVICE_TIMEOUT_S = 5.0


def call_service(name: str, kind: Any, *arguments: Any) -> Any:
    """Answer of the service `name`, a class `kind`, to a request of these fields.

    Raises:
        ParameterError: it answers `success: false`; with its message.
        rospy.ROSException: nobody offers it within SERVICE_TIMEOUT_S.  rospy.ServiceException: it fails.
    """
    rospy.wait_for_service(name, SERVICE_TIMEOUT_S)
    answer = rospy.ServiceProxy(name, kind)(*arguments)
    if getattr(answer, "success", True) is False:
        raise ParameterError(f"{name}: {getattr(answer, 'message', '') or getattr(answer, 'status_message', '')}")
    return answer
