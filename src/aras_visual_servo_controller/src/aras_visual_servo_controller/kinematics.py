"""Kinematics of the chain from the robot base to the camera. Skeleton: the C++ module `_kinematics` follows."""


class Kinematics:
    """Chain base_link -> tip_link of a URDF.

    Attributes: joint_names: tuple, SORTED BY NAME, the order of every joint vector. lower, upper, velocity: (n,) limits
    [m or rad; m/s or rad/s], +-inf where there is none.
    """

    def __init__(self, urdf_xml: str, base_link: str, tip_link: str):
        """Raises ModelError."""

    def vector(self, q):
        """(n,) array in joint_names order, from an array in that order or from a mapping by name."""

    def pose(self, q):
        """X_BC, (4, 4)."""

    def jacobian(self, q):
        """J_BC_C, (6, n): twist of C in B, expressed in C, [v; w]."""
