"""Decides when an arm must rest: joint states that stop, a dead-man's switch that is let go, clocks that jump."""

from typing import Iterable, NamedTuple, Optional, Sequence

from aras_visual_servo import RealSettings


class Unfit(NamedTuple):
    """Why the arm must rest.

    Attributes: reason: in words.  ends: the goal ends with it; otherwise it goes on when the reason is gone.
        jumped: the clock did; everything that was heard before has no age any more.
    """

    reason: str
    ends: bool
    jumped: bool = False


class Watchdog:
    """Looks at every command period. Times are ROS time [ns].

    Args: settings: `RealSettings`.  joint_names: of the joints that have to be heard.
    Attributes: held: the dead-man's switch was held when it was heard last.
    """

    def __init__(self, settings: RealSettings, joint_names: Sequence[str]) -> None:
        self._settings, self._names = settings, tuple(joint_names)
        self._joint_timeout_ns = round(settings.joint_timeout_s * 1e9)
        self._deadman_timeout_ns = round(settings.deadman_timeout_s * 1e9)
        self._jump_ns = round(settings.clock_jump_s * 1e9)
        self.clear()

    def clear(self) -> None:
        """Forget all: nothing has come yet."""
        self.held = False
        self._joints_ns, self._deadman_ns, self._looked_ns = {}, None, None

    def joints(self, names: Iterable[str], stamp_ns: int, now_ns: int) -> None:
        """A joint state of these joints and this stamp came now. An old one that comes late is an old one."""
        self._joints_ns.update(dict.fromkeys(names, min(stamp_ns, now_ns)))

    def deadman(self, held: bool, now_ns: int) -> None:
        """Notes a message of the dead-man's switch."""
        self.held, self._deadman_ns = bool(held), now_ns

    def look(self, now_ns: int) -> Optional[Unfit]:
        """`Unfit`, or None if the arm may move. To be called every command period."""
        settings, before_ns, self._looked_ns = self._settings, self._looked_ns, now_ns
        if before_ns is not None and not 0 <= now_ns - before_ns <= self._jump_ns:
            step_s = 1e-9 * (now_ns - before_ns)
            self._joints_ns, self._deadman_ns = {}, None  # earlier messages have no age in the new time
            return Unfit(f"the clock jumped by {step_s:.3f} s, allowed 0 to {settings.clock_jump_s:g} s", True,
                         True)
        return self.state(now_ns)

    def state(self, now_ns: int) -> Optional[Unfit]:
        """As `look`, without looking for a jump of the clock."""
        settings = self._settings
        if settings.deadman:
            if self._deadman_ns is None:
                return Unfit("nothing came on the topic `deadman`", True)
            if not self.held:
                return Unfit("the dead-man's switch was let go", True)
            if now_ns - self._deadman_ns > self._deadman_timeout_ns:
                return Unfit(f"nothing on the topic `deadman` for {1e-9 * (now_ns - self._deadman_ns):.3f} s, allowed "
                             f"{settings.deadman_timeout_s:g} s", True)
        missing = [name for name in self._names if name not in self._joints_ns]
        if missing:
            return Unfit(f"no joint state{self._of(missing)} has come", False)
        old = [name for name, heard_ns in self._joints_ns.items() if now_ns - heard_ns > self._joint_timeout_ns]
        if old:
            age_s = 1e-9 * (now_ns - min(self._joints_ns.values()))
            return Unfit(f"no joint state{self._of(old)} for {age_s:.3f} s, allowed {settings.joint_timeout_s:g} s",
                         False)
        return None

    def _of(self, names):
        """" of A, B", or "" where these are all joints."""
        return "" if len(names) == len(self._names) else f" of {', '.join(names)}"
