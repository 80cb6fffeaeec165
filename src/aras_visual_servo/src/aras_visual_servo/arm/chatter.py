"""Tells a joint that chatters: it is told to go fast one way at one image and fast the other way at the next.

That happens next to a singularity, for example of a stretched elbow: the twist asks for a motion that the joint cannot
give on either side, and it jumps from one side to the other. The camera then hardly moves, while nothing is at a limit.
"""

#: A velocity counts as fast from this part of the joint's limit on.
FAST_PART = 0.1
#: Every reversal from fast to fast adds REVERSAL to a joint's count, and every other image takes 1 away; the joint
#: chatters from CHATTERS on. The count does not grow above MOST, so that the joint is trusted again soon.
REVERSAL, CHATTERS, MOST = 2, 6, 9


class Chatter:
    """Watches the velocities that the joints of one arm are told."""

    def __init__(self, names, limit):
        """Args: names: of the joints.  limit: (n,) of their velocity, may be infinite [m/s, rad/s]."""
        self._names = names
        self._fast = [FAST_PART * most if most < float("inf") else FAST_PART for most in limit.tolist()]
        self.clear()

    def clear(self):
        """The joints were told to stand still."""
        self._last, self._counts = [0.0] * len(self._names), [0] * len(self._names)

    def joint(self, q_dot):
        """Name of a joint that chatters, or None. Call it once for each image. Args: q_dot: (n,) told."""
        last, counts, found = self._last, self._counts, None
        self._last = q_dot.tolist()
        for i, (old, new, fast) in enumerate(zip(last, self._last, self._fast)):
            if old * new < 0.0 and abs(old) > fast and abs(new) > fast:
                counts[i] = min(MOST, counts[i] + REVERSAL)
            elif counts[i]:
                counts[i] -= 1
            if counts[i] >= CHATTERS:
                found = self._names[i]
        return found
