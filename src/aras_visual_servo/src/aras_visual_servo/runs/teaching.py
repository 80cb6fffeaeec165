"""Teaches one view from several images, because noise in the goal becomes a permanent error.

The first image is the reference of the camera. Where it is noisy, the features of the images that follow are averaged
with its own while the arm rests. Images without noise need two, the second of which shows that there is none.
"""

from math import degrees
from typing import Any, Optional, Tuple

import numpy as np

from ..ground.errors import ParameterError
from ..ground.types import JointPositions
from ..servo.servo import Servo
from ..spatial import inverse, size_of

#: Averaging ends when the standard error of the mean is below this part of every threshold: of the features and of the
#: pose that they stand for. Where they stand for none, the place of the target is asked for to PLACE_M [m].
PART, PLACE_M = 0.1, 2e-6
#: Default motion of the arm during teaching, as a part of the limits of the stop rule.
STILL = 0.25
#: The scatter of fewer images than FEW is small by chance; they are enough where it is as small as VANISHING of that.
FEW, VANISHING = 10, 0.1


class Teaching:
    """The view that is being taught.

    Attributes:
        reference: `Reference` by the images so far.  done: more images are not needed.
    """

    def __init__(self, servo: Servo, stamp_ns: int, features: Any, q: JointPositions, z_star_m: float,
                 most: int, still: Optional[Tuple[float, float]] = None) -> None:
        """Begins with the image of this stamp.

        Args: as of `Goal.taught_by`. most: images at most, >= 1.  still: by how much the camera may move meanwhile [m,
            rad]; None: a part of the limits of the stop rule.
        """
        self._servo, self._stamp_ns, self._most, self._tried = servo, stamp_ns, most, 1
        self.reference = servo.goal.taught_by(features, q, z_star_m)
        self._views, self._q = [self.reference.view], [self._vector(q)]
        self._first_q, self._moved, stop = self._q[0], (), servo.config.stop
        self._still = (STILL * stop.position_m, STILL * stop.rotation_rad) if still is None else still
        self.done = most == 1 or self.reference.view is None or servo.config.follows

    def _vector(self, q):
        return np.array(self._servo.goal.kinematics.vector(q))

    def add(self, features: Any, q: JointPositions) -> None:
        """One more image of the view. It counts if its features are relative to the first one.

        Images from which the camera has moved away by more than `still` do not count any more.
        Raises ParameterError: the camera moves too much for a mean that is known well enough.
        """
        self._tried += 1
        told = getattr(features, "reference_stamp_ns", -1)
        if not self._servo.why_lost(features) and features.has_reference and told in (-1, self._stamp_ns):
            self._views.append(self._servo.source.kept(features))
            self._q.append(self._vector(q))
            self._leave_moved()
        sure = len(self._views) > 1 and self._sure()
        if sure or self._tried >= self._most:
            self.done = True
            if self._moved and not sure:
                moved_m, turned_rad = self._moved
                raise ParameterError(f"the view to teach: the camera moves, by {1e3 * moved_m:.3g} mm and "
                                     f"{degrees(turned_rad):.3g} deg while it is taught, allowed "
                                     f"{1e3 * self._still[0]:.3g} mm and {degrees(self._still[1]):.3g} deg")
            if len(self._views) > 1:
                self.reference = self._servo.goal.averaged(self.reference, self._views, np.mean(self._q, axis=0))

    def _leave_moved(self):
        """Leaves out the oldest images until the camera was near enough to where it is now in all that are left."""
        pose, (still_m, still_rad) = self._servo.goal.kinematics.pose, self._still
        X = inverse(pose(self._q[-1]))
        while len(self._q) > 1:
            moved_m, turned_rad = size_of(X @ pose(self._q[0]))
            if moved_m <= still_m and turned_rad <= still_rad:
                return
            self._moved = size_of(X @ pose(self._first_q))
            del self._q[0], self._views[0]

    def _sure(self):
        if self._moved and len(self._views) < FEW:  # one of many short parts may scatter little by chance
            return False
        config, root = self._servo.config, len(self._views) ** 0.5 * (1.0 if len(self._views) >= FEW else VANISHING)
        values, poses = self._servo.goal.errors(self._views)
        if not (np.std(values, axis=0) / root < PART * np.array(config.thresholds)).all():
            return False
        if poses is None:
            places = [(view.xn, view.yn, view.an) for view in self._views]
            return bool((np.std(places, axis=0) / root < PLACE_M).all())
        unsure = np.std(poses, axis=0) / root
        stop = config.stop
        return bool((unsure[:3] < PART * stop.position_m).all() and (unsure[3:] < PART * stop.rotation_rad).all())
