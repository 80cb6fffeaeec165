"""The servo: one observation in, one joint command and one record out. No ROS, no wall time, no random numbers.

    servo = Servo(kinematics, scenario["servo"])
    servo.teach(features, q)                     # this view is the goal (features normalised by its own reference)
    servo.start(stamp_ns)                        # or start(stamp_ns, set_point=q_last_commanded)
    command, record = servo.step(Observation(stamp_ns, features, q), dt_s)
    ... until servo.finished

Skeleton: interface fixed, bodies follow.
"""

from typing import Mapping, Optional, Sequence, Tuple

from .types import Command, Observation, Reference, ServoRecord, Status


class Servo:
    """Drives the camera to the taught view."""

    def __init__(self, kinematics, config: Mapping):
        """Args: kinematics: `Kinematics`. config: the scenario's section `servo` (dict). Raises ParameterError."""

    reference: Optional[Reference]
    status: Status
    finished: bool  # CONVERGED, TIMED_OUT, STOPPED or FAULT: only start() moves again

    def configure(self, law: str = "", gains_per_s: Sequence[float] = (), thresholds: Sequence[float] = (),
                  time_limit_s: float = 0.0) -> None:
        """Override the scenario's values for the next start; empty or 0 keeps (goal of VisualServo.action)."""

    def teach(self, features, q) -> Reference:
        """This view is the goal. Raises ParameterError when the features are not fit to servo on."""

    def set_reference(self, reference: Reference) -> None:
        """Use a reference taught before (respawned controller)."""

    def start(self, stamp_ns: int, set_point=None) -> None:
        """Begin servoing; needs a reference."""

    def stop(self, stamp_ns: int, reason: str = "stopped") -> Tuple[Command, ServoRecord]:
        """End servoing: zero velocity, STOPPED."""

    def step(self, observation: Observation, dt_s: float) -> Tuple[Command, ServoRecord]:
        """Answer to one image; dt_s: time to the next one (the image period) [s]."""

    def stale(self, stamp_ns: int, reason: str) -> Tuple[Command, ServoRecord]:
        """Watchdog: no input for input_timeout_s. Zero velocity, STALE_INPUT; servoing resumes with the next step."""
