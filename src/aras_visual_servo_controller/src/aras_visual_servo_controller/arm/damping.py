"""How small singular values are inverted: damping rules by name (docs/theory.md T40).

A rule maps the singular values sigma_1 >= ... >= sigma_m of the scaled Jacobian to lambda_i^2, one each, and the joints
follow with the gains sigma_i / (sigma_i^2 + lambda_i^2); lambda_i = 0 is the plain inverse.

References:
    C. W. Wampler, IEEE Trans. SMC 16(1), 1986 (`constant`).
    Y. Nakamura and H. Hanafusa, ASME J. Dyn. Syst. Meas. Control 108(3), 1986 (`nakamura_hanafusa`).
    A. A. Maciejewski and C. A. Klein, J. Robotic Systems 5(6), 1988 (`maciejewski_klein`: numerical filtering).
    S. Chiaverini, B. Siciliano, O. Egeland, IEEE Trans. Control Syst. Technol. 2(2), 1994 (`chiaverini`).
"""

from math import inf

#: Below this a singular value is rounding (largest scaled entry 20, times eps, with room for the SVD): no rule inverts
#: it.
ROUNDING = 1e-12
#: Isotropic damping of the numerical filtering, as part of its damping of the weakest direction.
FILTER_PART = 0.05


def damped(sigmas, threshold, damping2):
    """Each direction by its own singular value: (1 - (sigma / threshold)^2) damping^2 below the threshold, else 0."""
    return [0.0 if sigma >= threshold else (1.0 - (sigma / threshold) ** 2) * damping2 for sigma in sigmas]


def naive(sigmas, threshold, damping2):
    """The pseudo-inverse with a rank decision: directions below the threshold are given up, others not damped."""
    return [0.0 if sigma >= threshold else inf for sigma in sigmas]


def plain(sigmas, threshold, damping2):
    """The pseudo-inverse without one: everything above rounding is inverted, whatever it costs."""
    return [0.0] * len(sigmas)


def constant(sigmas, threshold, damping2):
    """The same for all, everywhere."""
    return [damping2] * len(sigmas)


def nakamura_hanafusa(sigmas, threshold, damping2):
    """The same for all: (1 - w / w0)^2 damping^2 where the manipulability w = sigma_1 ... sigma_m is below w0.

    w0 is w with the smallest singular value at the threshold, so that all rules set in at the same place.
    """
    return [(1.0 - min(1.0, sigmas[-1] / threshold)) ** 2 * damping2] * len(sigmas)


def maciejewski_klein(sigmas, threshold, damping2):
    """Numerical filtering: next to a singularity the weakest direction is damped in full, the others a little."""
    if sigmas[-1] >= threshold:
        return [0.0] * len(sigmas)
    return [FILTER_PART**2 * damping2] * (len(sigmas) - 1) + [(1.0 + FILTER_PART**2) * damping2]


def chiaverini(sigmas, threshold, damping2):
    """Numerical filtering that sets in smoothly: all of it times 1 - (sigma_m / threshold)^2 below the threshold."""
    if sigmas[-1] >= threshold:
        return [0.0] * len(sigmas)
    part = 1.0 - (sigmas[-1] / threshold) ** 2
    return [part * lambda2 for lambda2 in maciejewski_klein(sigmas, threshold, damping2)]


RULES = {rule.__name__: rule for rule in
         (damped, naive, plain, constant, nakamura_hanafusa, maciejewski_klein, chiaverini)}
