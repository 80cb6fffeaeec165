"""Law `photometric`: servoing on the grey levels of the whole image, by the method of Levenberg and Marquardt
(docs/theory.md T33 to T35, T46)."""

from dataclasses import dataclass

import numpy as np

from ..config.settings import setting
from ..ground.errors import DegenerateFeature, NotFiniteError, ParameterError
from .base import MAX_CONDITION, Law, LawSetup, register_law, sampled_gains

_UPPER = np.triu_indices(6)


@dataclass(frozen=True)
class PhotometricSettings:
    """Settings of law `photometric`. Its interaction matrix is chosen in the camera's section `vision.photometric`."""

    damping: float = setting(
        0.01, at_least=0,
        help="Damping mu of (T46) at the first image; it falls as the image approaches the goal image.")
    rest_m_per_s: float = setting(
        0.0005, unit="m/s", above=0, help="Not converged while the law commands more speed than this.")
    rest_rad_per_s: float = setting(
        0.001, unit="rad/s", above=0,
        help="Not converged while the law commands a faster turn than this.")


@register_law("photometric", settings=PhotometricSettings)
class Photometric(Law):
    """v = -lambda (H + mu diag(H))^-1 b, with H = L^T L, (6, 6), and b = L^T (I - I*), (6,) (T46).

    The camera package adds H and b up over the pixels, so that no image comes here. The interaction matrix L rests on
    the image gradient of the goal's image, of the current image, or of both; `vision.photometric.interaction` chooses.

    mu = damping rms^2 / rms_0^2 falls with the squared difference of the images, so that near the goal the steps are
    those of Gauss and Newton. The rms of I - I* cannot show that the goal is reached, because the noise of the image
    keeps it above zero. Therefore the law also calls itself settled only when its twist is small.

    References: T46, and E. Malis, "Improving vision-based control using efficient second-order minimization
    techniques", ICRA 2004.
    """

    works_on, foresees = ("photometric",), False

    def _prepare(self):
        if self._setup.interaction != LawSetup.interaction:
            raise ParameterError(f"interaction: found '{self._setup.interaction}', allowed no such key with law "
                                 f"'{self.name}': choose its matrix with vision.photometric.interaction")
        self._first_rms = self._step = None

    def _reset(self, reference):
        """The camera keeps the reference image; s_star is the rms of its difference from itself, 0."""
        self._first_rms = None

    def _twist(self, look, s, e):
        features = look.view.features
        if len(features.H) != len(_UPPER[0]) or len(features.b) != 6:
            raise DegenerateFeature(f"photometric: found {len(features.H)} numbers in H and {len(features.b)} in b, "
                                    f"allowed {len(_UPPER[0])} and 6")
        H, b = np.zeros((6, 6)), np.array(features.b)
        H[_UPPER] = features.H
        H += np.triu(H, 1).T
        if not np.isfinite(H.sum() + b.sum()):
            raise NotFiniteError("photometric: H or b is not finite")
        self._condition = float(features.condition)
        if not self._condition < MAX_CONDITION:
            raise DegenerateFeature("photometric: condition number of the interaction matrix is "
                                    f"{self._condition:.3g}, allowed < {MAX_CONDITION:g}")
        if self._first_rms is None:
            self._first_rms = s[0]
        mu = self.settings.damping * min(1.0, (s[0] / self._first_rms) ** 2) if self._first_rms > 0.0 else 0.0
        try:
            step = np.linalg.solve(H + mu * np.diag(np.diag(H)), b)
        except np.linalg.LinAlgError as error:
            raise DegenerateFeature(f"photometric: {error}") from error
        self._step = step
        return -sampled_gains(self.gains_per_s, look.dt_s)[0] * step

    def _pose(self, look):
        """H^-1 b, as far as the luminance is linear."""
        return self._step

    def _settled(self, twist):
        return bool(np.linalg.norm(twist[:3]) < self.settings.rest_m_per_s
                    and np.linalg.norm(twist[3:]) < self.settings.rest_rad_per_s)
