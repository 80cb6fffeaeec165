"""Link between controller and real arm: matches its inputs by time, and limits its commands.

    link = ArmLink(kinematics, settings, input_timeout_s)
    link.joints(stamp_ns, q, now_ns)              # every joint state
    link.image(stamp_ns, features, now_ns)        # the features of every image
    link.deadman(True, now_ns)                    # every message of the dead-man's switch
    for sight in link.sights(now_ns): ...         # images whose joint positions are known now, or that are refused
        link.take(command, now_ns)                # the answer of the session to it
    tick = link.tick(now_ns)                      # every command period: the command, and the reason for a rest

No ROS, no threads. All times are ROS time [ns]; with a real arm that is wall time.
"""

import collections
from typing import Any, Callable, List, NamedTuple, Optional

import numpy as np

from aras_visual_servo import Command, DegenerateFeature, RealSettings, SetPoint
from .joint_history import JointHistory, Latency
from .motion_guard import MotionGuard
from .watchdog import Unfit, Watchdog

#: A set-point that lags behind a trajectory catches up with this part of the way in a second [1/s].
CATCH_UP_PER_S = 10.0
#: After its goal has ended the arm is told for so long to rest. Then nothing is sent, so that others may drive it [s].
RELEASE_S = 0.5
#: A tick that comes later than this many periods integrates only over so many.
MOST_PERIODS = 3.0


class Timing(NamedTuple):
    """How one image and its joint positions fit together in time, all in s.

    Attributes:
        image_age_s: from the exposure to the answer.  gap_s: between the joint states used.
        extrapolation_s: of the joint positions.  predicted_s: how far the features were predicted.
    """

    image_age_s: float
    gap_s: float = 0.0
    extrapolation_s: float = 0.0
    predicted_s: float = 0.0


class Sight(NamedTuple):
    """One image with the joint positions of its time.

    Attributes:
        stamp_ns: of the image.  features: of it.  q: (n,) joint positions then; None if they are not known.
        refusal: why the image cannot be used; "" if it can.  timing: `Timing`.
    """

    stamp_ns: int
    features: Any
    q: Optional[np.ndarray]
    refusal: str
    timing: Timing


class Tick(NamedTuple):
    """Result of one command period.

    Attributes:
        point: `SetPoint` to send, None when nothing is to be sent.  unfit: `Unfit` while the arm must rest, or None.
        slowed: cause of a slower or stopped motion; "" without one.
        blocked: whether a joint limit or the workspace stopped it, also while it then stands as commanded.
    """

    point: Optional[SetPoint]
    unfit: Optional[Unfit]
    slowed: str = ""
    blocked: bool = False


class ArmLink:
    """Between the controller and the driver of a real arm.

    Args:
        kinematics: `Kinematics`.  settings: `RealSettings`.
        command_timeout_s: a velocity that no newer command replaces ends after this time.
    Attributes: image_latency, joint_latency: `Latency` of the received messages.
    """

    def __init__(self, kinematics: Any, settings: RealSettings, command_timeout_s: float) -> None:
        self._kinematics, self._settings = kinematics, settings
        self._command_timeout_ns = round(command_timeout_s * 1e9)
        self._image_delay_ns, self._jump_ns = round(settings.image_delay_s * 1e9), round(settings.clock_jump_s * 1e9)
        self._period_s = settings.command_period_s
        names = kinematics.joint_names
        self._history = JointHistory(names, settings.max_joint_gap_s, settings.max_extrapolation_s)
        self._watchdog, self._guard = Watchdog(settings, names), MotionGuard(kinematics, settings)
        self.image_latency, self.joint_latency = Latency(), Latency()
        self._zeros = np.zeros(len(kinematics.joint_names))
        self.clear()

    def clear(self) -> None:
        """Start anew, as after a jump of the clock; the dead-man's switch has to be heard again."""
        self._history.clear()
        self._watchdog.clear()
        self._waiting = collections.deque()
        self._sent = collections.deque()  # (time, set-point) of the last seconds
        self._tick_ns = None
        self.release()

    # --- inputs ---------------------------------------------------------------------------------------------

    def joints(self, stamp_ns: int, q: np.ndarray, now_ns: int) -> bool:
        """A joint state, (n,) [m, rad], with NaN for joints that the message does not name.

        A position that is not finite is not taken, so that the arm rests when no other comes for its joint; nor are
        those of the time before a clock was set back, which may come late.
        Returns: whether a position was taken.
        """
        if stamp_ns - now_ns > self._jump_ns:
            return False
        taken = self._history.add(stamp_ns, q)
        if taken:
            self.joint_latency.add(1e-9 * (now_ns - stamp_ns))
            self._watchdog.joints(taken, stamp_ns, now_ns)
        return bool(taken)

    def image(self, stamp_ns: int, features: Any, now_ns: int) -> None:
        """The features of an image, unless it is of the time before a clock was set back."""
        if stamp_ns - self._image_delay_ns - now_ns > self._jump_ns:
            return
        self.image_latency.add(1e-9 * (now_ns - stamp_ns + self._image_delay_ns))
        self._waiting.append((stamp_ns, features))

    def deadman(self, held: bool, now_ns: int) -> None:
        """A message of the dead-man's switch."""
        self._watchdog.deadman(held, now_ns)

    def unfit(self, now_ns: int) -> Optional[Unfit]:
        """`Unfit` if the arm must rest now, else None."""
        return self._watchdog.state(now_ns)

    def sights(self, now_ns: int) -> List["Sight"]:
        """The images that can be answered now, or never: list of `Sight`, oldest first."""
        found = []
        while self._waiting:
            stamp_ns, features = self._waiting[0]
            exposed_ns = stamp_ns - self._image_delay_ns
            then = self._history.at(exposed_ns)
            if then.wait and now_ns - exposed_ns <= self._command_timeout_ns:
                break
            self._waiting.popleft()
            timing = Timing(1e-9 * (now_ns - exposed_ns), then.gap_s, then.extrapolation_s)
            found.append(Sight(stamp_ns, features, then.q, then.refusal, timing))
        return found

    def predict(self, sight: "Sight", now_ns: int, plane_of: Callable[[np.ndarray], np.ndarray],
                predicted: Callable[..., Any]) -> Any:
        """The `Sight` as it will be when a command that is sent now acts.

        Args: plane_of: function of q, (n,), that gives the target's plane (3,) in the camera frame [1/m].
            predicted: function of features, plane and camera motion, as `prediction.predicted`.
        """
        ahead_s = sight.timing.image_age_s + self._settings.command_delay_s
        if sight.refusal or ahead_s <= 0.0:
            return sight
        if ahead_s > self._settings.max_prediction_s:
            return sight._replace(q=None, refusal=f"the image would have to be predicted over {ahead_s:.3f} s, allowed "
                                                  f"{self._settings.max_prediction_s:g} s")
        later = self._when_all_is_done(now_ns)
        pose = self._kinematics.pose
        X_C0C1 = np.linalg.inv(pose(sight.q)) @ pose(later)
        try:
            features = predicted(sight.features, plane_of(sight.q), X_C0C1)  # type: ignore[arg-type]
        except DegenerateFeature as error:
            return sight._replace(q=None, refusal=str(error))
        return sight._replace(features=features, q=later, timing=sight.timing._replace(predicted_s=ahead_s))

    def _when_all_is_done(self, now_ns):
        """(n,) where the joints will be when they have done everything that was sent until now."""
        newest_ns, newest = self._history.newest_ns, self._history.newest
        if self._out is None:
            return newest
        done = self._sent_at(newest_ns - round(self._settings.command_delay_s * 1e9))
        return self._kinematics.moved(newest, self._kinematics.way(done, self._out), 1.0)

    def _sent_at(self, time_ns):
        """(n,) set-point sent last before a time; the first one where that is not kept any more."""
        point = self._sent[0][1] if self._sent else self._out
        for sent_ns, sent in self._sent:
            if sent_ns >= time_ns:
                break
            point = sent
        return point

    # --- outputs ----------------------------------------------------------------------------------------------

    def take(self, command: Command, now_ns: int) -> None:
        """Take a `Command`. One that names no joint changes nothing; zero velocity for all without a position rests."""
        if not command.position and not command.velocity:
            return
        if self._out is None:
            if self._history.newest is None:
                return  # where the arm stands is not known: nothing can be sent
            self._out = self._target = np.array(self._history.newest)
        self._taken_ns, self._released_ns = now_ns, None
        by_name = self._kinematics.by_name
        self._velocity = self._kinematics.vector({**by_name(self._zeros), **command.velocity})
        self._follows = bool(command.position)
        if self._follows:
            self._target = self._kinematics.vector({**by_name(self._target), **command.position})

    def rest(self) -> None:
        """Stand still where the set-point is, until another command is taken."""
        self._velocity, self._out_velocity, self._follows = self._zeros, self._zeros, False
        if self._out is not None:
            self._target = self._out

    def end(self, now_ns: int) -> None:
        """The goal has ended: rest, and be silent RELEASE_S later."""
        self.rest()
        self._released_ns, self._limit = now_ns, ""

    def release(self) -> None:
        """Send nothing any more. The next command begins at the measured positions."""
        self._out = self._target = self._taken_ns = self._released_ns = None
        self._velocity = self._out_velocity = self._zeros
        self._follows, self._limit = False, ""

    def tick(self, now_ns: int) -> Tick:
        """One command period has passed: `Tick`."""
        unfit = self._watchdog.look(now_ns)
        before_ns, self._tick_ns = self._tick_ns, now_ns
        if self._out is None:
            return Tick(None, unfit)
        if self._released_ns is not None and not 0 <= 1e-9 * (now_ns - self._released_ns) <= RELEASE_S:
            self.release()
            return Tick(None, unfit)
        dt_s = 0.0 if before_ns is None else 1e-9 * (now_ns - before_ns)
        dt_s = min(max(0.0, dt_s), MOST_PERIODS * self._period_s)
        old = now_ns - self._taken_ns > self._command_timeout_ns and self._released_ns is None
        resting = unfit is not None or old or not (self._follows or self._velocity.any())
        if resting:
            self.rest()
        slowed = "the last command is too old" if old and unfit is None else ""
        drive, blocked = self._zeros, False
        if not resting and dt_s > 0.0:
            drive, slowed, blocked = self._move(dt_s)
            self._limit = slowed if blocked else ""
        elif resting and unfit is None and not old:
            slowed, blocked = self._limit, bool(self._limit)
        if not (np.isfinite(self._out).all() and np.isfinite(drive).all()):
            self.release()  # non-finite values must not be sent; the driver holds its set-point
            return Tick(None, Unfit("the set-point is not finite", True))
        self._sent.append((now_ns, self._out))
        while now_ns - self._sent[0][0] > 1e9:
            self._sent.popleft()
        point = SetPoint(now_ns, self._kinematics.joint_names, self._out, drive, resting, self._twist(drive))
        return Tick(point, unfit, slowed, blocked)

    def _twist(self, q_dot):
        """(6,) twist of the camera that joint velocities make, along the axes that `real.twist_frame` names."""
        q = self._out if self._history.newest is None else self._history.newest
        twist = self._kinematics.jacobian(q) @ q_dot
        if self._settings.twist_frame == "camera":
            return twist
        R_BC = self._kinematics.pose(q)[:3, :3]
        return np.concatenate([R_BC @ twist[:3], R_BC @ twist[3:]])

    def _move(self, dt_s):
        """Move the set-point by one period.

        Returns: ((n,) velocities for a velocity driver, cause of a slowdown, whether a limit stopped them).
        """
        moved, way = self._kinematics.moved, self._kinematics.way
        wanted, measured = self._velocity, self._history.newest
        if self._follows:
            self._target = moved(self._target, self._velocity, dt_s)
            wanted = wanted + CATCH_UP_PER_S * way(self._out, self._target)
        self._out_velocity, slowed, blocked = self._guard.velocity(self._out, self._out_velocity, wanted, dt_s)
        self._out = moved(self._out, self._out_velocity, dt_s)
        drive = self._out_velocity
        if self._follows and measured is not None:  # velocities alone would drift off the trajectory
            drive = drive + CATCH_UP_PER_S * way(measured, self._out)
        return self._guard.clipped(drive), slowed, blocked
