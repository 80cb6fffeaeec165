"""The services of a controller manager, and the words that the programs print."""
import typing

import rospy
from controller_manager_msgs.msg import ControllerState
from controller_manager_msgs.srv import (ListControllers, ListControllerTypes, LoadController,
                                         ReloadControllerLibraries, SwitchController, SwitchControllerRequest,
                                         UnloadController)

STRICT = SwitchControllerRequest.STRICT


class ManagerGoneError(Exception):
    """There is no controller manager, or it went away."""


class Manager:
    """One controller manager.

    Args:
        namespace: of its robot, "" for this node's own.
        timeout_s: wall time until its services must be there; None: for ever.
    Raises: ManagerGoneError: they never came.
    """

    def __init__(self, namespace: str = "", timeout_s: typing.Optional[float] = None) -> None:
        self._place = (namespace.rstrip("/") + "/" if namespace else "") + "controller_manager/"
        try:
            for name in ("load_controller", "switch_controller", "unload_controller"):
                rospy.wait_for_service(self._place + name, timeout_s)
        except rospy.ROSException as error:
            raise ManagerGoneError("there is no controller manager: %s" % error) from error

    def _call(self, name: str, kind: typing.Any, *request: typing.Any) -> typing.Any:
        try:
            return rospy.ServiceProxy(self._place + name, kind)(*request)
        except (rospy.ServiceException, rospy.ROSException) as error:
            raise ManagerGoneError("%s%s: %s" % (self._place, name, error)) from error

    def load(self, name: str) -> bool:
        return self._call("load_controller", LoadController, name).ok

    def unload(self, name: str) -> bool:
        return self._call("unload_controller", UnloadController, name).ok

    def switch(self, start: typing.Sequence[str], stop: typing.Sequence[str], strictness: int = STRICT) -> bool:
        return self._call("switch_controller", SwitchController, start, stop, strictness, False, 0.0).ok

    def listed(self) -> typing.List[ControllerState]:
        return self._call("list_controllers", ListControllers).controller

    def types(self) -> typing.List[typing.Tuple[str, str]]:
        response = self._call("list_controller_types", ListControllerTypes)
        return list(zip(response.types, response.base_classes))

    def reload(self) -> bool:
        return self._call("reload_controller_libraries", ReloadControllerLibraries, True).ok
