"""Joint vectors by name and back, the same for an arm and for a free camera."""

from collections.abc import Mapping

import numpy as np

from ..ground.errors import ParameterError


class JointVectors:
    """What joint vectors of a robot with `joint_names` can do."""

    def vector(self, q):
        """Joint vector, never shared with the caller, from an array in the order of joint_names or a mapping by name.

        A mapping may hold more joints than the chain has. Raises ParameterError when one is missing.
        """
        if isinstance(q, np.ndarray) or not isinstance(q, Mapping):  # to ask for an array first is faster
            return np.array(q, dtype=float)
        try:
            return np.array([q[name] for name in self.joint_names], dtype=float)
        except KeyError:
            missing = [name for name in self.joint_names if name not in q]
            raise ParameterError(f"joints: found {sorted(q)}, missing {missing}") from None

    def by_name(self, vector):
        """{name: value} of a joint vector."""
        return dict(zip(self.joint_names, vector.tolist()))
