"""T33 to T39: luminance of the whole image, and points, shapes and objects in it. In the product this is C++, which its
own tests hold to brute force; here it is held to geometry."""
import functools

import numpy as np
import views
from equations import equation, formula, same
from scenes import moments_of, moved
from toy_plant import OUTLINE, picture
from views import plane_of, tilted_pose

#: Step of the differences over the image, and what they leave of values of the texture's size.
STEP, DIFFERENCES = 1e-5, 1e-6

# --- T33 to T35: luminance --------------------------------------------------------------------------------------------


def texture(X, Y):
    """Grey level of the target's plane at X, Y [m]."""
    return 100.0 + 40.0 * np.sin(9.0 * X + 4.0 * Y) + 30.0 * np.cos(13.0 * Y - 5.0 * X) * np.sin(7.0 * X)


def luminance(X_WC, x, y):
    """What the pixels with rays (x, y, 1) see of the plane z = 0, from X_WC."""
    rays = X_WC[:3, :3] @ np.array([x, y, np.ones_like(x)])
    far = -X_WC[2, 3] / rays[2]
    return texture(X_WC[0, 3] + far * rays[0], X_WC[1, 3] + far * rays[1])


GRID = tuple(part.ravel() for part in np.meshgrid(np.linspace(-0.4, 0.4, 12), np.linspace(-0.3, 0.3, 9)))
TILTED = tilted_pose(2)


@formula("T33")
def brightness_constancy(grad_I, x_dot):
    """I_dot = -(grad I)^T x_dot"""
    return -grad_I.T @ x_dot


@formula("T33")
def L_by_rule(grad_I, L_x):
    """L_I = -(grad I)^T L_x"""
    return -grad_I.T @ L_x


@formula("T33")
def along_gradient(gx, gy, x, y):
    """q = gx x + gy y"""
    return gx * x + gy * y


@formula("T33")
def L_I(gx, gy, x, y, q, Z):
    """L_I = [ gx/Z, gy/Z, -q/Z, -gy - y q, gx + x q, x gy - y gx ]"""
    return np.array([gx / Z, gy / Z, -q / Z, -gy - y * q, gx + x * q, x * gy - y * gx])


@formula("T33")
def grad_xy(duv_dxy, grad_uv):
    """grad_xy I = (d(u, v)/d(x, y))^T grad_uv I"""
    return duv_dxy.T @ grad_uv


@formula("T33")
def normal_equations(L, I, I_star):
    """e = I - I*
    H = L^T L
    b = L^T e"""
    e = I - I_star
    H = L.T @ L
    b = L.T @ e
    return e, H, b


def gradient(X_WC, x, y):
    return [(luminance(X_WC, x + STEP, y) - luminance(X_WC, x - STEP, y)) / (2 * STEP),
            (luminance(X_WC, x, y + STEP) - luminance(X_WC, x, y - STEP)) / (2 * STEP)]


@functools.lru_cache(maxsize=None)
def of_pixels():
    """gx, gy, Z, differences of the luminance over the camera's motion, (n, 6), and L_x of the points, (n, 2, 6)."""
    x, y = GRID
    gx, gy = gradient(TILTED, x, y)
    A, B, C = plane_of(TILTED)
    Z, zero = 1.0 / (A * x + B * y + C), np.zeros_like(x)
    L_x = np.array([[-1 / Z, zero, x / Z, x * y, -(1 + x**2), y], [zero, -1 / Z, y / Z, 1 + y**2, -x * y, -x]])
    return gx, gy, Z, views.differences(lambda X: luminance(X, x, y), TILTED), np.moveaxis(L_x, 2, 0)


@equation("T33")
def test_rows_of_pixels_are_the_derivatives_of_their_luminance():
    gx, gy, Z, slopes, points = of_pixels()
    x, y = GRID
    found = L_I(gx, gy, x, y, along_gradient(gx, gy, x, y), Z).T
    same(found, slopes, DIFFERENCES)
    V = np.array([0.3, -0.2, 0.1, 0.5, -0.4, 0.7])
    for k in range(0, len(x), 10):
        grad = np.array([gx[k], gy[k]])
        same(L_by_rule(grad, points[k]), found[k])
        same(brightness_constancy(grad, points[k] @ V), slopes[k] @ V, 1e-5)


@equation("T33")
def test_a_lens_carries_the_gradient_over():
    def lens(x, y):
        radial = 1.0 - 0.33 * (x * x + y * y)
        return np.array([195.0 * radial * x + 159.5, 190.0 * radial * y + 119.5])

    def image(u, v):
        return np.sin(0.02 * u) * np.cos(0.03 * v)

    x, y, steps = 0.3, -0.2, STEP * np.eye(2)
    duv = np.column_stack([(lens(x + dx, y + dy) - lens(x - dx, y - dy)) / (2 * STEP) for dx, dy in steps])
    u, v = lens(x, y)
    grad_uv = np.array([(image(u + du, v + dv) - image(u - du, v - dv)) / (2 * STEP) for du, dv in steps])
    expected = [(image(*lens(x + dx, y + dy)) - image(*lens(x - dx, y - dy))) / (2 * STEP) for dx, dy in steps]
    same(grad_xy(duv, grad_uv), expected, DIFFERENCES)


@equation("T33")
def test_the_normal_equations_are_those_of_least_squares():
    x, y = GRID
    I, I_star = luminance(moved(TILTED, [0.01, 0, 0, 0, 0, 0.01]), x, y), luminance(TILTED, x, y)
    e, H, b = normal_equations(of_pixels()[3], I, I_star)
    same(e, I - I_star)
    for xi in np.random.default_rng(4).normal(size=(3, 6)):
        # |e + L xi|^2 = |e|^2 + 2 b . xi + xi . H xi
        same(e @ e + 2.0 * b @ xi + xi @ H @ xi, np.sum((e + of_pixels()[3] @ xi) ** 2))
        same(xi @ H @ xi, np.sum((of_pixels()[3] @ xi) ** 2))


@formula("T34")
def by_both(L, L_star, xi):
    """e = (L + L*)/2 xi"""
    return (L + L_star) / 2 @ xi


@functools.lru_cache(maxsize=None)
def displaced(size):
    """e, L, L*, xi of a parallel camera that was moved sideways and turned about its axis: the depth stays."""
    here = np.diag([1.0, -1.0, -1.0, 1.0])
    here[2, 3] = 0.6
    xi, (x, y) = size * np.array([0.012, -0.009, 0.0, 0.0, 0.0, 0.04]), GRID
    there, rows = moved(here, xi), []
    for X in (there, here):
        gx, gy = gradient(X, x, y)
        q, zero = gx * x + gy * y, np.zeros_like(x)
        rows.append(np.array([gx / 0.6, gy / 0.6, -q / 0.6, -gy - y * q, gx + x * q, x * gy - y * gx + zero]).T)
    return luminance(there, x, y) - luminance(here, x, y), *rows, xi


@equation("T34")
def test_the_mean_of_both_is_right_to_second_order():
    left = {}
    for size in (0.4, 0.2):
        e, L, L_star, xi = displaced(size)
        left["mean", size] = np.linalg.norm(e - by_both(L, L_star, xi))
        left["reference", size] = np.linalg.norm(e - by_both(L_star, L_star, xi))
    assert 7.5 < left["mean", 0.4] / left["mean", 0.2] < 8.5, left
    assert 3.5 < left["reference", 0.4] / left["reference", 0.2] < 4.5, left


@formula("T35")
def lit(g, I_star, o):
    """I ~ g I* + o"""
    return g * I_star + o


@formula("T35")
def without_light(H, H_ic, H_cc, H_ci):
    """H <- H - H_ic H_cc^-1 H_ci"""
    return H - H_ic @ np.linalg.inv(H_cc) @ H_ci


@formula("T35")
def b_without_light(b, H_ic, H_cc, b_c):
    """b <- b - H_ic H_cc^-1 b_c"""
    return b - H_ic @ np.linalg.inv(H_cc) @ b_c


@formula("T35")
def pixel_of_level(k, u, v):
    """(2^k u, 2^k v)"""
    return 2**k * u, 2**k * v


@formula("T35")
def newton_step(H, b):
    """-H^-1 b"""
    return -np.linalg.inv(H) @ b


@formula("T35")
def moved_px(scale, step, mean_of_squares):
    """scale sqrt(step^T mean(L_x^T L_x) step)"""
    return scale * np.sqrt(step @ mean_of_squares @ step)


@equation("T35")
def test_unknown_light_is_eliminated():
    x, y = GRID
    L, I_star = of_pixels()[3], luminance(TILTED, x, y)
    e = lit(1.2, I_star, -7.0) + L @ [0.002, -0.001, 0.003, 0.002, 0.001, -0.002] - I_star
    columns = np.column_stack([I_star, np.ones_like(x)])
    H_ic, H_cc = L.T @ columns, columns.T @ columns
    H = without_light(L.T @ L, H_ic, H_cc, H_ic.T)
    b = b_without_light(L.T @ e, H_ic, H_cc, columns.T @ e)
    everything = np.linalg.lstsq(np.column_stack([L, columns]), -e, rcond=None)[0]
    same(newton_step(H, b), everything[:6], 1e-8)
    same(everything[6:], [-0.2, 7.0], 1e-8)  # what the light did, undone


@equation("T35")
def test_a_level_of_the_pyramid_has_every_other_pixel_of_the_finer_one():
    u, v = np.meshgrid(np.arange(64), np.arange(48))
    for k in range(4):
        there = pixel_of_level(k, *np.meshgrid(np.arange(u.shape[1]), np.arange(u.shape[0])))
        same(np.array(there) + 1.0, np.array([u, v]) + 1.0)
        u, v = u[::2, ::2], v[::2, ::2]


@equation("T35")
def test_a_step_moves_the_image_by_so_many_pixels():
    _, _, Z, _, points = of_pixels()
    step, (x, y) = 1e-6 * np.array([0.3, -0.2, 0.1, 0.5, -0.4, 0.7]), GRID
    seen = TILTED @ np.array([x * Z, y * Z, Z, np.ones_like(Z)])
    after = np.linalg.inv(moved(TILTED, step)) @ seen
    expected = 195.0 * np.sqrt(np.mean((after[0] / after[2] - x) ** 2 + (after[1] / after[2] - y) ** 2))
    same(moved_px(195.0, step, np.mean([L.T @ L for L in points], axis=0)), expected, 1e-5)  # of second order


# --- T36, T37: points -------------------------------------------------------------------------------------------------


def clipped(polygon, axis, bound, sign):
    """The part of a convex polygon where sign * coordinate <= sign * bound."""
    kept = []
    for a, b in zip(polygon, np.roll(polygon, -1, axis=0)):
        inside_a, inside_b = sign * a[axis] <= sign * bound, sign * b[axis] <= sign * bound
        if inside_a:
            kept.append(a)
        if inside_a != inside_b:
            kept.append(a + (bound - a[axis]) / (b[axis] - a[axis]) * (b - a))
    return np.array(kept).reshape(-1, 2)


def coverage(polygon, u, v):
    """Part of the pixel (u, v) that a convex polygon covers."""
    for axis, centre in ((0, u), (1, v)):
        for sign in (1.0, -1.0):
            polygon = clipped(polygon, axis, centre + 0.5 * sign, sign)
            if len(polygon) < 3:
                return 0.0
    x, y = polygon.T
    return 0.5 * abs(x @ np.roll(y, -1) - y @ np.roll(x, -1))


QUADRANGLE = np.array([[10.3, 12.7], [52.1, 8.4], [58.6, 49.2], [14.9, 41.5]])


@functools.lru_cache(maxsize=None)
def windows():
    """For each edge: (along v, direction of the object, [(position across, first pixel, weights from there on)])."""
    made = []
    middle = QUADRANGLE.mean(axis=0)
    for a, b in zip(QUADRANGLE, np.roll(QUADRANGLE, -1, axis=0)):
        axis = 0 if abs(b - a)[0] >= abs(b - a)[1] else 1  # of the position; the weights go along the other one
        low, high = sorted((a[axis], b[axis]))
        lines = []
        for position in range(int(np.ceil(low)) + 4, int(high) - 3):
            part = (position - a[axis]) / (b[axis] - a[axis])
            at = a[1 - axis] + part * (b[1 - axis] - a[1 - axis])
            beyond = 1 if middle[1 - axis] < at else -1  # the object lies before, or after the edge
            first = round(at) - 3 * beyond
            pixels = [first + beyond * k for k in range(7)]
            weights = [coverage(QUADRANGLE, *((position, p) if axis == 0 else (p, position))) for p in pixels]
            lines.append((position, first, beyond, np.array(weights)))
        made.append((axis, lines))
    return made


@formula("T36")
def edge_at(v0, w):
    """v0 - 1/2 + sum w"""
    return v0 - 1 / 2 + np.sum(w)


def line_through(points):
    """(middle, direction) by total least squares."""
    middle = points.mean(axis=0)
    return middle, np.linalg.svd(points - middle)[2][0]


@equation("T36")
def test_sums_of_coverage_are_points_of_the_edges_and_the_edges_meet_in_the_corners():
    edges = []
    for axis, lines in windows():
        points = []
        for position, first, beyond, weights in lines:
            at = beyond * edge_at(beyond * first, weights)  # counted against the axis, the axis points the other way
            points.append((position, at) if axis == 0 else (at, position))
        edges.append(line_through(np.array(points)))
    for k, corner in enumerate(QUADRANGLE):
        (p, d), (q, e) = edges[k - 1], edges[k]
        t = np.linalg.solve(np.column_stack([d, -e]), q - p)[0]
        same(p + t * d, corner, 1e-9)


PIXEL = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])


def beyond_line(normal, bound):
    """The part of a pixel about the origin where normal . point >= bound."""
    turn = np.array([normal, [-normal[1], normal[0]]])
    return clipped(PIXEL @ turn.T, 0, bound, -1.0) @ turn


def area_and_centroid(polygon):
    """Area and centroid of a convex polygon."""
    a, b = polygon, np.roll(polygon, -1, axis=0)
    twice = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return 0.5 * twice.sum(), ((a + b) * twice[:, None]).sum(axis=0) / (3.0 * twice.sum())


@formula("T63")
def triangle(k, p):
    """X = sqrt(2 k p) / 3, Y = X / k"""
    X = np.sqrt(2 * k * p) / 3
    return X, X / k


@formula("T63")
def trapezoid(k, p):
    """X = p/2 + k^2/(24 p), Y = 1/2 - k/(12 p)"""
    return p / 2 + k**2 / (24 * p), 1 / 2 - k / (12 * p)


@formula("T63")
def covered(p, w, X, Y):
    """(p / w) (1/2 - X, 1/2 - Y)"""
    return p / w * (1 / 2 - X), p / w * (1 / 2 - Y)


@formula("T63")
def extent(w):
    """(w/12 + w^3/12) / 2"""
    return (w / 12 + w**3 / 12) / 2


@equation("T63")
def test_the_covered_part_of_a_pixel_has_the_centroid_of_the_pixel_cut_by_the_edge():
    for angle in np.linspace(0.02, np.pi / 4, 7):
        normal = np.array([np.cos(angle), np.sin(angle)])
        for bound in np.linspace(-0.65, 0.65, 23):
            polygon = beyond_line(normal, bound)
            if len(polygon) < 3:
                continue
            w, centroid = area_and_centroid(polygon)
            k, p = np.tan(angle), min(w, 1.0 - w)
            if p > 1e-3:
                same(covered(p, w, *(triangle(k, p) if 2.0 * p < k else trapezoid(k, p))), centroid, 1e-9)


@equation("T63")
def test_parts_of_pixels_extend_by_a_sixteenth_in_the_mean():
    w = (np.arange(10000) + 0.5) / 10000
    second = [np.mean([v * (1.0 / 12.0), v * (v * v / 12.0)]) for v in w]  # along the edge, across it: v wide
    same(np.mean(extent(w)), np.mean(second), 1e-12)
    same(np.mean(extent(w)), np.mean(w) / 16.0, 1e-6)


@formula("T37")
def laid_over(a, r, b):
    """p = a r + b"""
    return a * r + b


@formula("T37")
def best_a(p, r):
    """a = sum p conj(r) / sum |r|^2"""
    return np.sum(p * np.conj(r)) / np.sum(np.abs(r) ** 2)


@formula("T37")
def residual(p, r):
    """sqrt(1 - |sum p conj(r)|^2 / (sum |p|^2 sum |r|^2))"""
    return np.sqrt(1 - np.abs(np.sum(p * np.conj(r))) ** 2 / (np.sum(np.abs(p) ** 2) * np.sum(np.abs(r) ** 2)))


@equation("T37")
def test_the_fit_of_a_pattern_is_least_squares_and_its_residual_what_is_left():
    r = np.array([0.1 + 0.2j, -0.3 + 0.1j, 0.2 - 0.4j, 0.5 + 0.1j])
    p = laid_over(1.3 * np.exp(0.7j), r, 0.2 - 0.1j)
    same(p, 1.3 * np.array([np.cos(0.7) + 1j * np.sin(0.7)]) * r + (0.2 - 0.1j))
    for noise in (0.0, 0.1):
        seen = p + noise * np.array([1.0, -0.5j, 0.3 + 1j, -1.0 + 0.2j])
        (a, b), *_ = np.linalg.lstsq(np.column_stack([r, np.ones(4)]), seen, rcond=None)
        about = seen - seen.mean(), r - r.mean()
        same(best_a(*about), a)
        left = np.linalg.norm(seen - a * r - b) / np.linalg.norm(about[0])
        same(residual(*about) + 1.0, left + 1.0, 1e-7)  # the root of what rounding leaves


# --- T38, T39: shapes and objects -------------------------------------------------------------------------------------


@formula("T38")
def c21_c30(mu30, mu21, mu12, mu03):
    """c21 = (mu30 + mu12) + i (mu21 + mu03)
    c30 = (mu30 - 3 mu12) + i (3 mu21 - mu03)"""
    return (mu30 + mu12) + 1j * (mu21 + mu03), (mu30 - 3 * mu12) + 1j * (3 * mu21 - mu03)


@formula("T38")
def spread(mu20, mu11, mu02, m00):
    """4 pi sqrt(mu20 mu02 - mu11^2) / m00^2"""
    return 4 * np.pi * np.sqrt(mu20 * mu02 - mu11**2) / m00**2


def shape(xy):
    """The three numbers of a polygon; the affine map is done to its corners."""
    m, mu = moments_of(xy, 3)
    part = spread(mu[2, 0], mu[1, 1], mu[0, 2], m[0, 0])
    second = np.array([[mu[2, 0], mu[1, 1]], [mu[1, 1], mu[0, 2]]]) / m[0, 0]
    m, mu = moments_of(xy @ np.linalg.inv(np.linalg.cholesky(second)).T, 3)
    same([mu[2, 0], mu[0, 2]], [m[0, 0]] * 2, 1e-8)
    c21, c30 = c21_c30(mu[3, 0], mu[2, 1], mu[1, 2], mu[0, 3])
    return np.array([part, abs(c21) / m[0, 0], abs(c30) / m[0, 0]])


L_SHAPE = np.array([[-0.06, -0.06], [-0.02, -0.06], [-0.02, 0.02], [0.04, 0.02], [0.04, 0.06], [-0.06, 0.06]])


@equation("T38")
def test_scale_rotation_and_shear_leave_the_three_numbers():
    there = shape(OUTLINE)
    assert there.min() > 0.01  # none vanishes
    for affine in ([[0.3, 0.0], [0.0, 0.3]], [[0.8, -0.6], [0.6, 0.8]], [[1.0, 0.7], [0.0, 1.0]],
                   [[0.2, 1.1], [-0.9, 0.4]]):
        same(shape(OUTLINE @ np.array(affine).T), there, 1e-8)


@equation("T38")
def test_known_shapes_have_known_numbers():
    # Any triangle is an affine image of the equilateral one with corners sqrt(8) from its middle: its second-order
    # moments equal its area, 6 sqrt(3). The mean of z^3 is a tenth of the product of its corners: 8 sqrt(8) / 10.
    triangle = shape(np.array([[0.1, 0.0], [0.5, 0.2], [0.2, 0.7]]))
    same(triangle + [0.0, 1.0, 0.0], [4.0 * np.pi / (6.0 * np.sqrt(3.0)), 1.0, 0.8 * np.sqrt(8.0)], 1e-7)
    angle = np.linspace(0.0, 2.0 * np.pi, 2000, endpoint=False)
    same(shape(np.column_stack([0.2 * np.cos(angle), 0.1 * np.sin(angle)])) + 1.0, [2.0, 1.0, 1.0], 1e-5)  # 1 / n^2
    same(shape(np.array([[0.0, 0.0], [0.3, 0.0], [0.3, 0.1], [0.0, 0.1]])) + 1.0, [1.0 + np.pi / 3.0, 1.0, 1.0])
    # The third-order moments of an isosceles right triangle with legs of 1, by integration.
    same(c21_c30(1 / 270, -1 / 540, -1 / 540, 1 / 270), [(1 + 1j) / 540, (5 - 5j) / 540])


def farthest(outline, away_m):
    """Largest distance of the three numbers from those seen parallel, tilted by 30 degrees about any axis."""
    m, _ = moments_of(outline, 1)
    outline = outline - np.array([m[1, 0], m[0, 1]]) / m[0, 0]
    most = 0.0
    for azimuth in np.linspace(0.0, 2.0 * np.pi, 36, endpoint=False):
        tilt = np.radians(30.0) * np.array([np.cos(azimuth), np.sin(azimuth)])
        X = moved(np.diag([1.0, -1.0, -1.0, 1.0]), [0, 0, 0, *tilt, 0])
        X[:3, 3] = -away_m * X[:3, 2]
        most = max(most, np.linalg.norm(shape(picture(X, None, outline)) - shape(outline)))
    return most


@equation("T38")
def test_a_perspective_changes_them_as_the_text_says():
    assert 0.05 < farthest(L_SHAPE, 0.8) < 0.06
    large = np.array([[-0.08, -0.05], [0.12, -0.05], [0.12, 0.01], [-0.02, 0.01], [-0.02, 0.09], [-0.08, 0.09]])
    assert abs(farthest(large, 0.4) - 0.32) < 0.005


@formula("T39")
def within_reach(distance, nearest_other):
    """within half the distance to any other object"""
    return distance < 1 / 2 * nearest_other


@formula("T39")
def area_alike(now, before):
    """of half to double its area"""
    return 1 / 2 * before <= now <= 2 * before


@equation("T39")
def test_two_objects_that_keep_within_reach_are_never_taken_for_each_other():
    # They come straight at each other: the worst that they can do.
    apart = 10.0
    for way in (4.9, 4.999, 5.001, 5.1):
        nearest_is_itself = abs(way) < abs(apart - way)
        assert within_reach(way, apart) == nearest_is_itself, way


@equation("T39")
def test_areas_that_are_alike_are_so_both_ways_round():
    for ratio in (0.4, 0.497, 0.4999, 0.5001, 0.503, 1.0, 1.99, 1.9999, 2.0001, 2.01, 3.0):
        assert area_alike(ratio, 1.0) == area_alike(1.0, ratio), ratio
        assert area_alike(ratio, 1.0) == (abs(np.log2(ratio)) < 1.0), ratio


def test_coverage_adds_up_to_the_area():
    small = 0.2 * QUADRANGLE
    total = sum(coverage(small, u, v) for u in range(0, 14) for v in range(0, 12))
    same(total, moments_of(small, 1)[0][0, 0])
