"""Pairs the features and the joint state of the same instant, by their stamps; never the latest of each. No ROS."""

import collections


class StampPairer:
    """Matches each features message with the joint state of exactly the same stamp.

    Features are handed out in the order in which they came. They wait until the joint state of their stamp has come.
    When a later joint state comes first, there is none of that stamp, and the features are handed out with None; so are
    the oldest where too many wait.

    Args:
        capacity: joint states kept, and features that may wait; 400 are 4 s at 100 Hz.
    """

    def __init__(self, capacity=400):
        self._joints = collections.OrderedDict()
        self._capacity = capacity
        self._waiting = collections.deque()
        self._newest_ns = -1
        self.restarts = 0

    def clear(self):
        """Forget everything: time starts anew."""
        self._joints.clear()
        self._waiting.clear()
        self._newest_ns = -1

    def add_features(self, stamp_ns, features):
        """Returns the pairs now complete, as add_joints does."""
        self._waiting.append((stamp_ns, features))
        return self._complete()

    def add_joints(self, stamp_ns, joints):
        """Take one joint state.

        A stamp before the newest one means that time was reset: everything older is forgotten and `restarts` counts.
        Returns:
            list of (stamp_ns, features, joints or None), oldest first.
        """
        if stamp_ns < self._newest_ns:
            self.clear()
            self.restarts += 1
        self._newest_ns = stamp_ns
        self._joints[stamp_ns] = joints
        if len(self._joints) > self._capacity:
            self._joints.popitem(last=False)
        return self._complete() if self._waiting else ()

    def _complete(self):
        pairs = []
        while self._waiting:
            stamp_ns, features = self._waiting[0]
            joints = self._joints.get(stamp_ns)
            if joints is None and self._newest_ns <= stamp_ns and len(self._waiting) <= self._capacity:
                break
            self._waiting.popleft()
            pairs.append((stamp_ns, features, joints))
        return pairs
