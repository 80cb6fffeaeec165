"""The last stages: the Jacobian of the arm, and joint velocities within all limits."""

from typing import Optional

from ..arm.motion import ArmMotion
from ..laws.base import Law
from ..laws.look import Arm
from .feature_filter import FeatureFilter
from .stage import Stage, Tick
from .time_limit import Hindrance


class JointPlace(Stage):
    """Computes the Jacobian at the joint positions, and its inverse."""

    def __init__(self, arm: ArmMotion) -> None:
        self._arm = arm

    def apply(self, tick: Tick) -> Tick:
        """Returns the tick with Jacobian, inverse and manipulability."""
        tick.jacobian, tick.inverse = self._arm.at(tick.q)
        tick.manipulability = tick.inverse.manipulability
        return tick


class JointVelocity(Stage):
    """Turns the twist into joint velocities that the arm may do."""

    def __init__(self, arm: ArmMotion, law: Law, tracker: Optional[FeatureFilter], hindrance: Hindrance) -> None:
        """Args: law: chooses the joint velocities itself if it `moves_joints`.  tracker: filters the features."""
        self._arm, self._law, self._tracker, self._hindrance = arm, law, tracker, hindrance

    @property
    def title(self) -> str:
        """What a fault calls the last stage: most of what can fail is the law's."""
        return f"law '{self._law.name}'"

    def apply(self, tick: Tick) -> Tick:
        """Returns the tick with the joint velocities, and the twist that they give the camera."""
        law, twist = self._law, tick.twist
        if law.moves_joints:
            arm = Arm(**self._arm.as_seen(tick.q, tick.X_BC, twist, tick.jacobian, tick.inverse, tick.dt_s))
            joints = law.joint_velocity(tick.view, arm, twist)
            motion = self._arm.told(joints.q_dot, tick.jacobian, joints.status, joints.text)
        else:
            motion = self._arm.joint_velocity(tick.q, twist, tick.jacobian, tick.inverse, tick.dt_s)
        if motion.status is not None:
            tick.status = motion.status
            self._hindrance.seen(tick.stamp_ns, motion.text)
        if self._tracker is not None:
            self._tracker.commanded(tick.stamp_ns, motion.twist)
        tick.q_dot, tick.twist, tick.applied = motion.q_dot, motion.twist, motion.twist
        tick.text = motion.text or tick.text
        return tick
