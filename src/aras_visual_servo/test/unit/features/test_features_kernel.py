"""Kernel projections: exact integrals of projected outlines, their matrix against central differences."""

import numpy as np
import pytest
from toy_plant import OUTLINE, picture
from views import assert_same, differences, plane_of, tilted_pose

from aras_visual_servo import DegenerateFeature, Features, FeatureSet, View

P, Q, X0, Y0 = 1.5, 2.0, -0.9, -0.7
# Of X^-3.5 along an edge that is a fifth of its distance from the corner: rounding.
NODES, WEIGHTS = np.polynomial.legendre.leggauss(20)
NODES, WEIGHTS = 0.5 * (NODES + 1.0), 0.5 * WEIGHTS


def integrals(xy, exponent, origin):
    """[exponent, origin, six integrals] of an outline, by Green's theorem in y."""
    way = np.roll(xy, -1, axis=0) - xy
    points = xy[:, None, :] + NODES[None, :, None] * way[:, None, :]
    X, y, dx = points[..., 0] - origin, points[..., 1], way[:, 0][:, None] * WEIGHTS
    area = np.sum(y * dx)
    return [exponent, origin] + [float(np.sign(area) * np.sum(X ** -(exponent - 1 + k) * y ** (j + 1) * dx) / (j + 1))
                                 for k in range(3) for j in range(2)]


def view(X_WC, plane=None):
    xy = picture(X_WC, outline=OUTLINE)
    return View(Features(valid=True, kernel_x=integrals(xy, P, X0), kernel_y=integrals(xy[:, ::-1], Q, Y0)), plane)


@pytest.mark.parametrize("seed", [1, 2, 3, 4])
@pytest.mark.parametrize("name", ["kx", "ky"])
def test_matrix_of_each_projection_is_the_derivative(name, seed):
    X, one = tilted_pose(seed), FeatureSet([name])
    wanted = differences(lambda X: one.values(view(X)), X)
    assert_same(one.matrix(view(X, plane_of(X))), wanted)


def test_the_projection_is_the_integral_without_the_others():
    v = view(tilted_pose(1))
    assert FeatureSet(["kx", "ky"]).values(v) == (v.features.kernel_x[4], v.features.kernel_y[4])


def test_a_view_without_projections_is_degenerate_and_says_what_to_set():
    with pytest.raises(DegenerateFeature, match="vision.kernel"):
        FeatureSet(["kx"]).values(View(Features(valid=True)))
