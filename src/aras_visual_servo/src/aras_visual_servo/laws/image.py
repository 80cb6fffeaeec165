"""Law `ibvs`: image-based visual servoing on any features (docs/theory.md T20, T21)."""

from typing import Any

import numpy as np

from .base import Law, register_law, sampled_gains


@register_law("ibvs")
class ImageBased(Law):
    """v = -L^+ Lambda e for any features (T20, T21).

    `interaction` says whether L is that of the goal, that of the current view, or the mean of both. With L of the
    goal the features do not go straight to their goal, but runs that end with |e| = 0 at a wrong pose are rarer
    (docs/theory.md, T20).
    """

    works_on = None

    def _prepare(self):
        self.needs_plane = self._setup.interaction != "desired"
        self._L_star: Any = None
        self._inverse: Any = None

    def _reset(self, reference):
        self._L_star = self._inverse = None
        if self._setup.interaction == "current":
            return
        self._L_star = self.goal_matrix(*self.taught_view(reference))
        if self._setup.interaction == "desired":
            self._inverse = self.invert(self._L_star)

    def _twist(self, look, s, e):
        inverse = self._inverse
        if inverse is None:
            L = self.features.matrix(look.view)
            inverse = self.invert(L if self._L_star is None else 0.5 * (L + self._L_star))
        return -(inverse @ self._wanted(e, look.dt_s))

    def _wanted(self, e, dt_s):
        """The rate at which the errors are to fall, -e_dot, (k,), in the units of the features per second."""
        gains = sampled_gains(self.gains_per_s, dt_s)
        return np.array([gain * error for gain, error in zip(gains, e)])
