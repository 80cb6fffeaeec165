"""Reads ROS parameters: sections of the scenario, and the few parameters that belong to a node itself."""

from typing import Any, Callable, Dict, Optional, Sequence

import rospy

from aras_visual_servo import ArasError, ExperimentSequence, ParameterError, RobotSettings, Servo, kinematics_of, read

CONTROLLER_PARAMETERS = ("command_interface", "feedback_rate_hz", "taught_reference", "scenario", "servo", "experiment",
                         "robot", "real", "actionlib_status_frequency")

_TYPES = {bool: "true or false", int: "a whole number", float: "a number", str: "text"}


class Parameters:
    """Reads parameters and collects every fault, so that one message lists them all.

    >>> parameters = Parameters()
    >>> servo = parameters.section("servo")
    >>> interface = parameters.value("~command_interface", "joint_command", allowed=("joint_command", "float64"))
    >>> parameters.check()
    """

    def __init__(self) -> None:
        self.faults = []

    def section(self, name: str, required: bool = True) -> Dict[str, Any]:
        """A section of the scenario: private parameter `~name`, else `scenario/name` in the node's namespace.

        Returns: dict; {} if it is no mapping, or if it is missing and required, which are faults.
        """
        keys = ("~" + name, "scenario/" + name)
        found = next((key for key in keys if rospy.has_param(key)), None)
        if found is None:
            if required:
                self.faults.append(f"{name}: missing, allowed {' or '.join(map(rospy.resolve_name, keys))}")
            return {}
        value = rospy.get_param(found)
        if isinstance(value, dict):
            return value
        self.faults.append(f"{name}: found {value!r} at {rospy.resolve_name(found)}, allowed a mapping of keys")
        return {}

    def searched(self, name: str) -> Any:
        """Text of a parameter in this node's namespace or one above; "" if it is missing, which is a fault."""
        key = rospy.search_param(name)
        value = rospy.get_param(key) if key else None
        if not isinstance(value, str) or not value.strip():
            self.faults.append(f"{name}: found {'nothing' if value is None else repr(value)}, allowed a text; searched "
                               f"in the namespace of {rospy.get_name()} and those above it")
            return ""
        return value

    def value(self, key: str, default: Any, minimum: Optional[float] = None, allowed: Sequence[str] = ()) -> Any:
        """Value of a parameter, which has to have the type of its default.

        Args: minimum: of a number.  allowed: texts, unless it is empty.
        """
        value, kind = rospy.get_param(key, default), type(default)
        if kind is float and isinstance(value, int) and not isinstance(value, bool):
            value = float(value)
        if not isinstance(value, kind) or (kind is not bool and isinstance(value, bool)):
            fault = _TYPES[kind]
        elif minimum is not None and not value >= minimum:
            fault = f">= {minimum}"
        elif allowed and value not in allowed:
            fault = " | ".join(allowed)
        else:
            return value
        self.faults.append(f"{key}: found {value!r}, allowed {fault}")
        return default

    def build(self, factory: Callable[..., Any], *arguments: Any) -> Any:
        """The result of factory(*arguments), or None if it raises an ArasError, whose faults are then added."""
        try:
            return factory(*arguments)
        except ArasError as error:
            self.faults.extend(getattr(error, "faults", None) or [str(error)])
            return None

    def known(self, names: Sequence[str], prefix: str = "~") -> None:
        """Add a fault for every private parameter that is not one of `names`."""
        tree = rospy.get_param(prefix, {})
        for key in sorted(set(tree if isinstance(tree, dict) else {}) - set(names)):
            self.faults.append(f"{rospy.resolve_name(prefix + key)}: unknown, known are {', '.join(sorted(names))}")

    def check(self) -> None:
        """Raises ParameterError with every fault found so far, if there is any."""
        if self.faults:
            raise ParameterError(self.faults)


class ControllerSetup:
    """Reads the controller node's parameters and makes the objects of the core from them.

    Args: teach_camera: function that makes an image the camera's reference, see `ExperimentSequence`.
    Raises: ParameterError: lists every fault.

    Attributes:
        kinematics, servo, sequence: the objects of the core.
        feedback_rate_hz: rate of the action's feedback in wall time [1/s].
        controllers: joint -> name of its ros_control controller; {} unless the command interface is float64.
    """

    def __init__(self, teach_camera: Optional[Callable[..., Any]]) -> None:
        parameters = Parameters()
        robot, servo = parameters.section("robot"), parameters.section("servo")
        experiment = parameters.section("experiment")
        urdf = parameters.searched("robot_description")
        interface = parameters.value("~command_interface", "joint_command", allowed=("joint_command", "float64"))
        self.feedback_rate_hz = parameters.value("~feedback_rate_hz", 10.0, minimum=0.1)
        parameters.known(CONTROLLER_PARAMETERS)
        if robot:
            read(RobotSettings, robot, "robot", faults=parameters.faults)
        self.kinematics = self.servo = self.sequence = None
        self.controllers = {}
        if not parameters.faults:
            self.kinematics = parameters.build(kinematics_of, urdf, robot)
        if self.kinematics is not None:
            self.servo = parameters.build(Servo, self.kinematics, servo)
            self.sequence = parameters.build(ExperimentSequence, self.kinematics, self.servo, experiment, teach_camera)
            if interface == "float64":
                self.controllers = _controllers(parameters, self.kinematics.joint_names)
        parameters.check()


def _controllers(parameters, joint_names):
    """Dict of joint -> name of its controller, from the ros_control parameters in the node's namespace.

    A joint without a controller is a fault.
    """
    tree = rospy.get_param(rospy.get_namespace(), {})
    found = {value["joint"]: name for name, value in sorted(tree.items())
             if isinstance(value, dict) and "joint" in value and str(value.get("type", "")).endswith("Controller")}
    missing = [name for name in joint_names if name not in found]
    if missing:
        parameters.faults.append(f"command_interface: float64 needs a controller for {', '.join(missing)}")
    return {joint: found[joint] for joint in joint_names if joint in found}
