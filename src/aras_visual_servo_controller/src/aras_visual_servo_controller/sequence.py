"""The experiment as a state machine: one `Observation` per image in, one `Command` per image out.

idle -> to_goal -> settle_goal -> teach -> to_start -> settle_start -> servo -> done      (start())
idle -> servo -> done                                                                    (start(servo_only=True))

Pure function of the observation stream: in process and over ROS give the same bytes. Skeleton: bodies follow.
"""

from dataclasses import dataclass
from typing import Callable, Mapping, Optional, Tuple

import numpy as np

from .types import Command, Observation, ServoRecord, Status

PHASES = ("idle", "to_goal", "settle_goal", "teach", "to_start", "settle_start", "servo", "done")


@dataclass
class SequenceResult:
    """How an experiment ended: the result of VisualServo.action."""

    converged: bool
    status: Status
    reason: str
    e: np.ndarray  # (4,) final feature error, NaN when never servoed
    duration_s: float  # simulated seconds of servoing


class ExperimentSequence:
    """Runs the scenario's experiment."""

    def __init__(self, kinematics, servo, config: Mapping, set_reference: Callable):
        """Set up.

        Args:
            kinematics: `Kinematics`.  servo: `Servo`.  config: the scenario's section `experiment` (dict; key `judge`
                is not read here).
            set_reference: called once, in phase teach, as set_reference(z_star_m, features) and must return, before it
                returns, the features of this same view normalised by the new reference (object with the fields of
                MomentFeatures, has_reference true). Over ROS: the service camera/set_reference; in process:
                MomentExtractor.set_reference. An exception it raises ends the experiment with status FAULT.
        """

    phase: str
    result: Optional[SequenceResult]  # None until done
    teach_stamp_ns: Optional[int]  # stamp of the image that was taught
    servo_stamp_ns: Optional[int]  # stamp of the first image servoed on

    def start(self, servo_only: bool = False) -> None:
        """Begin with the next step. servo_only: servo to the reference taught last."""

    def step(self, observation: Observation) -> Tuple[Command, ServoRecord]:
        """Answer to one image. Idle and done: an empty command (pure acknowledgement, set-points hold)."""

    def stop(self, stamp_ns: int, reason: str = "stopped") -> Tuple[Command, ServoRecord]:
        """End now with status STOPPED; the command returned stops the arm."""

    @property
    def done(self) -> bool:
        """True once `result` is there."""
