"""What a servo run has to say beside its status: what holds the arm back, and a target that is not where it was."""

from math import atan2, degrees

#: Without a hindrance for this long the arm counts as free again [s].
FREE_S = 0.5
#: The target counts as displaced when the camera at the goal stands further from the taught place than so many times
#: what the stop rule allows.
DISPLACED = 4.0


class Hindrance:
    """Remembers since when, and by what, the arm is kept from the motion that the law asks for."""

    def __init__(self):
        self.clear()

    def clear(self):
        """Nothing has held the arm back yet."""
        self._text, self._since_ns, self._last_ns = "", 0, 0

    def seen(self, stamp_ns, text):
        """At this image the arm could not do the motion in full, for the reason of this text."""
        if not self._text or stamp_ns - self._last_ns > 1e9 * FREE_S:
            self._since_ns = stamp_ns
        self._text, self._last_ns = text, stamp_ns

    def words(self, stamp_ns):
        """For how long the arm has been held back until now, and by what; an empty text if it is not."""
        if not self._text or stamp_ns - self._last_ns > 1e9 * FREE_S:
            return ""
        return f"for the last {1e-9 * (stamp_ns - self._since_ns):.1f} s the arm could not do what was asked " \
               f"({self._text})"


def displaced_target(X_CgC, pose, stop):
    """How far the target is found from where it was taught, in words; an empty text if it is found there.

    A camera that sees a target at rest as it was taught stands where it was taught. The joints say where it stands, the
    image says how far it is from the view that was taught. What is left between the two is how far the target has been
    moved, or what the arm, its model or the camera's calibration err by: from here the two cannot be told apart.
    Args:
        X_CgC: (4, 4) pose of the camera by the joints, relative to the taught one.
        pose: (6,) displacement from the taught view by the image, small [m, rad]; None: not known.
        stop: `StopSettings`.
    """
    if pose is None:
        return ""
    (xx, xy, xz, x), (yx, yy, yz, y), (zx, zy, zz, z), _ = X_CgC.tolist()
    px, py, pz, wx, wy, wz = pose.tolist()
    distance_m = ((x - px) ** 2 + (y - py) ** 2 + (z - pz) ** 2) ** 0.5
    sines = 0.5 * (zy - yz) - wx, 0.5 * (xz - zx) - wy, 0.5 * (yx - xy) - wz
    angle_rad = atan2(sum([sine * sine for sine in sines]) ** 0.5, 0.5 * (xx + yy + zz - 1.0))
    if distance_m <= DISPLACED * stop.position_m and angle_rad <= DISPLACED * stop.rotation_rad:
        return ""
    return f"the target is found {1e3 * distance_m:.1f} mm and {degrees(angle_rad):.1f} deg from where it was taught"
