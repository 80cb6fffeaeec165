"""How small singular values are inverted: damping rules by name (docs/theory.md T40).

A rule gives each of the singular values sigma_1 >= ... >= sigma_m of the scaled Jacobian a damping lambda_i^2. The
inverse then has the gain sigma_i / (sigma_i^2 + lambda_i^2) in that direction; with lambda_i = 0 this is the plain
inverse.

References:
    C. W. Wampler, IEEE Trans. SMC 16(1), 1986 (`constant`).
    Y. Nakamura and H. Hanafusa, ASME J. Dyn. Syst. Meas. Control 108(3), 1986 (`nakamura_hanafusa`).
    A. A. Maciejewski and C. A. Klein, J. Robotic Systems 5(6), 1988 (`maciejewski_klein`: numerical filtering).
    S. Chiaverini, B. Siciliano, O. Egeland, IEEE Trans. Control Syst. Technol. 2(2), 1994 (`chiaverini`).
"""

from math import inf

#: A singular value below this is a rounding error, and no rule inverts it. The largest scaled entry is 20; 20 times
#: eps, with room for the errors of the SVD, is below this.
ROUNDING = 1e-12
#: Numerical filtering damps all directions a little: by this part of the damping of the weakest direction.
FILTER_PART = 0.05


def damped(sigmas, threshold, damping2):
    """By each direction's own singular value: (1 - (sigma / threshold)^2) damping^2 below the threshold, else 0."""
    return [0.0 if sigma >= threshold else (1.0 - (sigma / threshold) ** 2) * damping2 for sigma in sigmas]


def naive(sigmas, threshold, damping2):
    """The pseudo-inverse with a rank decision: directions below the threshold are not moved, others not damped."""
    return [0.0 if sigma >= threshold else inf for sigma in sigmas]


def plain(sigmas, threshold, damping2):
    """The pseudo-inverse without a rank decision: all above rounding is inverted, however fast the joints get."""
    return [0.0] * len(sigmas)


def constant(sigmas, threshold, damping2):
    """The same damping for all directions, also far from singularities."""
    return [damping2] * len(sigmas)


def nakamura_hanafusa(sigmas, threshold, damping2):
    """The same for all: (1 - w / w0)^2 damping^2 where the manipulability w = sigma_1 ... sigma_m is below w0.

    w0 is the w that the arm would have with its smallest singular value at the threshold. So this rule, like the
    others, begins to damp when the smallest singular value falls below the threshold.
    """
    return [(1.0 - min(1.0, sigmas[-1] / threshold)) ** 2 * damping2] * len(sigmas)


def maciejewski_klein(sigmas, threshold, damping2):
    """Numerical filtering: next to a singularity the weakest direction is damped in full, the others a little."""
    if sigmas[-1] >= threshold:
        return [0.0] * len(sigmas)
    return [FILTER_PART**2 * damping2] * (len(sigmas) - 1) + [(1.0 + FILTER_PART**2) * damping2]


def chiaverini(sigmas, threshold, damping2):
    """Numerical filtering that begins smoothly: its damping times 1 - (sigma_m / threshold)^2 below the threshold."""
    if sigmas[-1] >= threshold:
        return [0.0] * len(sigmas)
    part = 1.0 - (sigmas[-1] / threshold) ** 2
    return [part * lambda2 for lambda2 in maciejewski_klein(sigmas, threshold, damping2)]


RULES = {rule.__name__: rule for rule in
         (damped, naive, plain, constant, nakamura_hanafusa, maciejewski_klein, chiaverini)}
#: Values of servo/inverse/method: these rules, and the transpose of the Jacobian, which inverts nothing.
METHODS = (*RULES, "transpose")
