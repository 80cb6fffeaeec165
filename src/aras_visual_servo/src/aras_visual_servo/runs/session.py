"""Decisions of the controller node, without ROS: reject or answer an image, stop, watch for missing input.

The node adds messages, clocks and threads.
Times: `stamp_ns`, `now_ns` are ROS time (simulated with a simulator), `wall_s` is a monotonic wall clock.
"""

from typing import Any, Optional, Sequence, Tuple, Union

import numpy as np

from .sequence import ExperimentSequence
from ..ground.errors import ArasError, ParameterError
from ..ground.types import Command, JointPositions, Observation, Reference, ServoRecord, Status

#: When ROS time stands still and no features come for this wall time, that is reported [s].
STANDSTILL_S = 2.0


class Session:
    """Feeds images to one sequence, and keeps the state of the goal that it works on.

    Args:
        sequence: `ExperimentSequence`, with its servo and arm.
        input_timeout_s: features older than this are refused; the arm is stopped when none come for this long.
        time_limit_s: after this time a goal that gets no features ends, unless it brings its own limit.
    Attributes:
        active: a goal is being worked on.
        frame: index of the last answered image, -1 before the first.
        last_ns: stamp of the last answered image, -1 before the first.
        seen: the last answered `Observation`, or None.
        stale: input is missing, and that was reported.
        unseen: a goal is active, and no image was answered since it began.
    """

    def __init__(self, sequence: ExperimentSequence, input_timeout_s: float, time_limit_s: float) -> None:
        self._sequence = sequence
        self._input_timeout_s, self._input_timeout_ns = input_timeout_s, round(input_timeout_s * 1e9)
        self._time_limit_ns = self._goal_limit_ns = round(time_limit_s * 1e9)
        self._fresh_ns, self._fresh_wall_s = 0, 0.0
        self.active = self.stale = self._begun = False
        self._forget()

    def _forget(self):
        self.last_ns, self.frame, self.seen = -1, -1, None

    @property
    def unseen(self) -> bool:
        """See the class."""
        return self.active and self._begun

    # --- one image, one answer ----------------------------------------------------------------------------------

    def answer(self, stamp_ns: int, features: Any, q: JointPositions, now_ns: int, wall_s: float,
               refusal: str = "") -> Tuple[Command, ServoRecord]:
        """Answers one image.

        Args:
            features: of the image.  q: (n,) joint positions of the same stamp [m or rad], None if there is none.
            refusal: reason of the caller to reject the image; "" without one.
        Returns:
            (Command, ServoRecord), in every case. While a goal is active, the command for a refused image stops the
            arm.
        """
        if self.unseen and stamp_ns <= self.last_ns:
            self._forget()  # time went back before the goal began, and nothing else has shown it
        refusal = refusal or self._refusal(stamp_ns, q, now_ns)
        if refusal:
            if self.active:
                return self.hold(stamp_ns, refusal)
            return Command(stamp_ns), ServoRecord(stamp_ns, Status.IDLE, f"refused: {refusal}")
        self.last_ns, self.stale, self._begun = stamp_ns, False, False
        self.frame += 1
        self._fresh_ns, self._fresh_wall_s = stamp_ns, wall_s
        self.seen = Observation(stamp_ns, features, q, self.frame)
        return self._sequence.step(self.seen)

    def _refusal(self, stamp_ns, q, now_ns):
        if stamp_ns <= self.last_ns:
            return f"features of {stamp_ns * 1e-9:.3f} s came after those of {self.last_ns * 1e-9:.3f} s"
        if q is None:
            return f"no joint state has the stamp of the image, {stamp_ns * 1e-9:.6f} s"
        if now_ns - stamp_ns > self._input_timeout_ns:
            return f"features are {(now_ns - stamp_ns) * 1e-9:.3f} s old, allowed {self._input_timeout_s:g} s"
        return ""

    def hold(self, stamp_ns: int, reason: str) -> Tuple[Command, ServoRecord]:
        """Answers with zero velocity and STALE_INPUT; the goal goes on with the next good image."""
        _, record = self._sequence.servo.stale(stamp_ns, reason)
        record.status, record.status_text, record.phase = Status.STALE_INPUT, reason, self._sequence.phase
        return self.standstill(stamp_ns), record

    def standstill(self, stamp_ns: int) -> Command:
        """Command of zero velocity for every joint: the set-points stay."""
        return Command(stamp_ns, velocity=dict.fromkeys(self._sequence.kinematics.joint_names, 0.0))

    # --- goals --------------------------------------------------------------------------------------------------

    def begin(self, reference: Union[str, Reference], law: str, gains_per_s: Sequence[float],
              thresholds: Sequence[float], time_limit_s: float, now_ns: int, wall_s: float) -> None:
        """Begins a goal with the next image.

        Args:
            reference: "taught" or "experiment".  The other arguments are those of VisualServo.action.
        Raises:
            ParameterError: listing every fault of the goal; nothing is active then.
        """
        self.active = False
        faults = []
        if reference not in ("taught", "experiment"):
            faults.append(f"reference: found '{reference}', allowed taught | experiment")
        if reference == "taught" and self._sequence.servo.reference is None:
            faults.append("reference: nothing was taught yet")
        try:
            self._sequence.servo.configure(law, gains_per_s, thresholds, time_limit_s)
        except ArasError as error:
            faults.extend(getattr(error, "faults", [str(error)]))
        if faults:
            raise ParameterError(faults)
        self._sequence.start(servo_only=reference == "taught")
        self._goal_limit_ns = round(time_limit_s * 1e9) or self._time_limit_ns
        self._fresh_ns, self._fresh_wall_s = now_ns, wall_s
        self.active, self.stale, self._begun = True, False, True

    def teach(self, z_star_m: Optional[float] = None) -> int:
        """Makes the view of the last answered image the goal.

        Args: z_star_m: depth of the target in it [m]; None: the experiment's.
        Returns: stamp of that image [ns].
        Raises: ParameterError: a goal is active, there is no image yet, or the view is not fit to be a reference; and
            what the sequence's `teach_camera` raises.
        """
        if self.active:
            raise ParameterError("teach: a goal is active, stop it first")
        if self.seen is None:
            raise ParameterError("teach: no image has come yet")
        self._sequence.teach(self.seen.stamp_ns, self.seen.features, self.seen.q, z_star_m)
        return self.seen.stamp_ns

    def end(self, now_ns: int, reason: str, status: Status = Status.STOPPED) -> Tuple[Command, Optional[ServoRecord]]:
        """Ends the goal now, between two images.

        Returns:
            (Command, ServoRecord); the command stops the arm. Without a goal: (command of zero velocity, None).
        """
        if not self.active:
            return self.standstill(now_ns), None
        try:
            command, record = self._sequence.stop(now_ns, reason)
        except Exception as error:  # the arm must stop, whatever is broken
            command, reason = self.standstill(now_ns), f"{reason} ({error})"
            record = ServoRecord(now_ns, status, phase="done")
        record.status, record.status_text = status, reason
        self.active = False
        return command, record

    def restart_time(self) -> None:
        """Time went back: the simulator was reset. Stamps start anew."""
        self._forget()

    def outcome(self, record: ServoRecord) -> Tuple[bool, Status, str, np.ndarray, float]:
        """How the goal ended: (converged, status, reason, e, duration_s), from the record that ended it."""
        result = self._sequence.result
        e, duration_s = (record.e, 0.0) if result is None else (result.e, result.duration_s)
        if result is not None and result.status != Status.STOPPED:
            return result.converged, result.status, result.reason, e, duration_s
        return False, record.status, record.status_text, np.asarray(e), duration_s

    # --- watchdog -----------------------------------------------------------------------------------------------

    def watch(self, now_ns: int, wall_s: float) -> Optional[Tuple[Optional[Command], Optional[ServoRecord]]]:
        """Looks for missing input; to be called a few times in input_timeout_s.

        Returns:
            None if all is well, else (command or None, record). The goal is over when `active` has become False.
        """
        if not self.active:
            return None
        age_ns = now_ns - self._fresh_ns
        if age_ns > self._input_timeout_ns:
            reason = f"no features for {age_ns * 1e-9:.3f} s, allowed {self._input_timeout_s:g} s"
            if age_ns > self._goal_limit_ns:
                return self.end(now_ns, reason + "; the time limit is over", Status.TIMED_OUT)
            self.stale = True
            return self.hold(now_ns, reason)
        if self.last_ns >= 0 and wall_s - self._fresh_wall_s > STANDSTILL_S:
            # The simulator is paused or waits, so nothing moves. A command now would pass for the answer to an image
            # that did not come, so none is sent.
            self._fresh_wall_s, self.stale = wall_s, True
            text = f"no features for {STANDSTILL_S:g} s of wall time, and ROS time stands still"
            return None, self.hold(now_ns, text)[1]
        return None
