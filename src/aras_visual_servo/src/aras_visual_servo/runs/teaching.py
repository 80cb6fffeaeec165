"""Teaches one view from several images: what noise leaves in the goal, no servo can tell from an error later.

The first image is the reference of the camera. Where it is noisy, the features of the images that follow are averaged
with its own while the arm rests. Images without noise need two, the second of which shows that there is none.
"""

import numpy as np

#: Averaging ends when the standard error of the mean is below this part of every threshold: of the features and of the
#: pose that they stand for. Where they stand for none, the place of the target is asked for to PLACE_M [m].
PART, PLACE_M = 0.1, 2e-6
#: The scatter of fewer images than FEW is small by chance; they are enough where it is as small as VANISHING of that.
FEW, VANISHING = 10, 0.1


class Teaching:
    """The view that is being taught.

    Attributes:
        reference: `Reference` by the images so far.  done: more images are not needed.
    """

    def __init__(self, servo, stamp_ns, features, q, z_star_m, most):
        """Begin with the image of this stamp. Args: as of `Servo.as_reference`. most: images at most, >= 1."""
        self._servo, self._stamp_ns, self._most, self._tried = servo, stamp_ns, most, 1
        self.reference = servo.as_reference(features, q, z_star_m)
        self._views, self._q = [self.reference.view], [self._vector(q)]
        self.done = most == 1 or self.reference.view is None or servo.follows

    def _vector(self, q):
        return np.array(self._servo.joint_vector(q))

    def add(self, features, q):
        """One more image of the view. It counts if its features are relative to the first one."""
        self._tried += 1
        told = getattr(features, "reference_stamp_ns", -1)
        if not self._servo.why_lost(features) and features.has_reference and told in (-1, self._stamp_ns):
            self._views.append(self._servo.source.kept(features))
            self._q.append(self._vector(q))
        if self._tried >= self._most or len(self._views) > 1 and self._sure():
            self.done = True
            if len(self._views) > 1:
                self.reference = self._servo.averaged(self.reference, self._views, np.mean(self._q, axis=0))

    def _sure(self):
        config, root = self._servo.config, len(self._views) ** 0.5 * (1.0 if len(self._views) >= FEW else VANISHING)
        values, poses = self._servo.goal_errors(self._views)
        if not (np.std(values, axis=0) / root < PART * np.array(config.thresholds)).all():
            return False
        if poses is None:
            places = [(view.xn, view.yn, view.an) for view in self._views]
            return bool((np.std(places, axis=0) / root < PLACE_M).all())
        unsure = np.std(poses, axis=0) / root
        stop = config.stop
        return bool((unsure[:3] < PART * stop.position_m).all() and (unsure[3:] < PART * stop.rotation_rad).all())
