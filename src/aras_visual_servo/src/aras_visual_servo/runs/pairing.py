"""Pairs the features and the joint state of the same instant, by their stamps; never the latest of each. No ROS."""

import collections
from typing import Any, List, Sequence, Tuple

SETTLED_PAIRS = 3  # after the joint states went back, no features of the time before are on their way any more


class StampPairer:
    """Matches each features message with the joint state of exactly the same stamp.

    Features are handed out in the order in which they came. They wait until the joint state of their stamp has come.
    When a later joint state comes first, there is none of that stamp, and the features are handed out with None; so are
    the oldest where too many wait.

    A stamp before the newest one of its kind means that time was reset. Features and joint states come on two
    connections, and either may be the first to show it: what is here then is forgotten. The other kind may go on for a
    while with messages of the time before, until it goes back too, or until some pairs show that it will not.

    Args:
        capacity: joint states kept, and features that may wait; 400 are 4 s at 100 Hz.
    Attributes:
        restarts: how often it was seen that time was reset.
    """

    def __init__(self, capacity: int = 400) -> None:
        self._joints = collections.OrderedDict()
        self._capacity = capacity
        self._waiting = collections.deque()
        self.restarts = 0
        self.clear()

    def clear(self) -> None:
        """Forgets everything: time starts anew."""
        self._joints.clear()
        self._waiting.clear()
        self._newest_joints_ns = self._newest_features_ns = -1
        self._ahead = None   # "features" or "joints": the kind that has shown a reset, while the other may not have
        self._since_ns = -1  # the stamp that showed it
        self._met = 0        # pairs since then

    def _restart(self, ahead, stamp_ns):
        self.clear()
        self.restarts += 1
        self._ahead, self._since_ns = ahead, stamp_ns

    def add_features(self, stamp_ns: int, features: Any) -> List[Tuple[int, Any, Any]]:
        """Takes one features message. Returns: list of (stamp_ns, features, joints or None) now complete, oldest first.
        """
        if self._ahead == "joints" and stamp_ns <= max(self._newest_features_ns, self._since_ns):
            self._ahead = None
            if stamp_ns <= self._newest_features_ns:  # features received since the joint states went back are older
                self._waiting.clear()
                self.restarts += 1
        elif stamp_ns < self._newest_features_ns:
            self._restart("features", stamp_ns)
        self._newest_features_ns = stamp_ns
        self._waiting.append((stamp_ns, features))
        return self._complete()

    def add_joints(self, stamp_ns: int, joints: Any) -> Sequence[Tuple[int, Any, Any]]:
        """Takes one joint state. Returns the same as add_features."""
        if stamp_ns < self._newest_joints_ns:
            if self._ahead == "features":
                self._joints.clear()  # of the time before
                self._ahead = None
            else:
                self._restart("joints", stamp_ns)
        self._newest_joints_ns = stamp_ns
        self._joints[stamp_ns] = joints
        if len(self._joints) > self._capacity:
            self._joints.popitem(last=False)
        return self._complete() if self._waiting else ()

    def _complete(self):
        pairs = []
        while self._waiting:
            stamp_ns, features = self._waiting[0]
            joints = self._joints.get(stamp_ns)
            may_come = self._newest_joints_ns <= stamp_ns or self._ahead == "features"
            if joints is None and may_come and len(self._waiting) <= self._capacity:
                break
            if joints is not None:
                self._met += 1
                if self._ahead == "features" or self._met >= SETTLED_PAIRS:
                    self._ahead = None
            self._waiting.popleft()
            pairs.append((stamp_ns, features, joints))
        return pairs
