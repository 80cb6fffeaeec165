"""T80 to T84: features made of all grey levels. Brute force over every pixel of small pictures, held against the
product's H, b and cost, and against derivatives that are exact."""
import functools

import numpy as np
from equations import equation, formula, same
from scipy.interpolate import BSpline
from scipy.ndimage import map_coordinates
from textured_plane import TexturedPlane, camera_info, correlate, exponential, interaction, kernels, symmetric

import aras_visual_servo_camera as camera

WIDTH, HEIGHT, BORDER = 56, 44, 4
INSIDE = np.s_[BORDER:-BORDER, BORDER:-BORDER]
#: A displacement of the camera that moves the image by about two pixels [m, rad].
MOTION = np.array([0.02, -0.015, 0.025, 0.01, -0.02, 0.03])
SINGLE = 2e-5  # what sums of single precision leave in the product, which has these


@functools.lru_cache(maxsize=None)
def scene():
    return TexturedPlane(camera_info(WIDTH, HEIGHT), (0.25, -0.4, 1.6), shortest_m=0.15)


@functools.lru_cache(maxsize=None)
def pictures():
    """What the camera sees after the motion, and at the goal."""
    return scene().image(exponential(MOTION)), scene().image()


@functools.lru_cache(maxsize=None)
def pixels(gradient_of="current"):
    """(I, I*, L_I): smoothed greys of every pixel, (h, w), and their rows (h, w, 6), without the rim."""
    now, star = (image.astype(float) for image in pictures())
    gauss, _ = kernels(1.0)
    L = interaction(now if gradient_of == "current" else star, 1.0, scene().x, scene().y, scene().jacobian,
                    scene().plane)
    return *(correlate(image, gauss, gauss)[INSIDE] for image in (now, star)), L[INSIDE]


@functools.lru_cache(maxsize=None)
def found(mapping, at_goal=False, illumination="constant", switch_px=100.0, **settings):
    """(H, b, cost) of the product."""
    config = {"mapping": mapping, "interaction": "current", "border_px": BORDER, "illumination": illumination,
              "switch_px": switch_px}
    if settings:
        config[mapping] = settings
    made = camera.PhotometricExtractor(scene().info, config)
    made.set_reference(pictures()[1], plane=scene().plane)
    features = made.process(pictures()[1 if at_goal else 0])
    return symmetric(features.H), np.array(features.b), features.cost


def alike(answer, H, b, cost, tolerance=SINGLE):
    """The product's answer is these equations; the columns of H differ in size by their units."""
    size = np.sqrt(np.diag(H))
    same(answer[0] / np.outer(size, size), H / np.outer(size, size), tolerance)
    same(answer[1] / size, b / size, tolerance)
    same(answer[2], cost, tolerance)


# --- T80: sums with weights that stay ---------------------------------------------------------------------------------


@formula("T80")
def sums(A, I):
    """s = A I"""
    return A @ I


@formula("T80")
def L_of_sums(A, L_I):
    """L_s = A L_I"""
    return A @ L_I


@formula("T80")
def error_of_sums(A, I, I_star):
    """e = A (I - I*)"""
    return A @ (I - I_star)


def held(A, answer, illumination="constant", tolerance=SINGLE):
    """Hold the product's answer to that of these weights, (features, h w)."""
    I, I_star, L_I = (part.reshape(A.shape[1], -1).squeeze() for part in pixels())
    e, L_s = error_of_sums(A, I, I_star), L_of_sums(A, L_I)
    same(e, sums(A, I) - sums(A, I_star))
    if light := {"constant": 0, "offset": 1, "gain_and_offset": 2}[illumination]:
        C = A @ np.column_stack([np.ones_like(I_star), I_star][:light])
        e, L_s = (column - C @ np.linalg.lstsq(C, column, rcond=None)[0] for column in (e, L_s))
    alike(answer, L_s.T @ L_s, L_s.T @ e, 0.5 * e @ e, tolerance)


@equation("T80")
def test_sums_have_the_interaction_matrix_and_the_error_that_are_mapped_by_the_same_weights():
    count = 30
    for light in ("constant", "offset", "gain_and_offset"):
        held(waves(count), found("dct", illumination=light, coefficients=count), light)


@equation("T80")
def test_orthogonal_weights_change_nothing():
    every = pixels()[0].size
    held(waves(every), found("none"))
    alike(found("dct", coefficients=every), *found("none"))


# --- T81: principal components ----------------------------------------------------------------------------------------


@formula("T81")
def of_views(X):
    """X X^T v = l v"""
    l, v = np.linalg.eigh(X @ X.T)
    return l, v


@formula("T81")
def component(X, v, l):
    """X^T v / sqrt(l)"""
    return X.T @ v / np.sqrt(l)


@functools.lru_cache(maxsize=None)
def views(count, spread, seed):
    """(count, h w) the goal's image, seen from displaced cameras, less the mean; drawn as in the product."""
    fx, fy, cx, cy = (scene().info["K"][k] for k in (0, 4, 2, 5))
    rays = np.stack([scene().x, scene().y, np.ones_like(scene().x)], -1)[INSIDE]
    random, drawn = np.random.RandomState(seed), []
    for _ in range(count):
        numbers = 2.0 * random.randint(0, 2**32, 6, dtype=np.uint32) / 4294967295.0 - 1.0
        p, turn = spread / scene().plane[2] * numbers[:3], spread * numbers[3:]
        way = rays @ exponential([0.0, 0.0, 0.0, *turn])[:3, :3].T
        P = p + ((1.0 - scene().plane @ p) / (way @ scene().plane))[..., None] * way
        place = np.array([fy * P[..., 1] / P[..., 2] + cy, fx * P[..., 0] / P[..., 2] + cx]) - BORDER
        # Between pixels by straight lines, at 32nds of a pixel, as OpenCV does.
        drawn.append(map_coordinates(pixels()[1], np.rint(32.0 * place) / 32.0, order=1, mode="mirror").ravel())
    return np.array(drawn) - np.mean(drawn, axis=0)


@equation("T81")
def test_components_are_the_first_eigenvectors_of_the_covariance_of_drawn_views():
    X = views(30, 0.2, 5)
    l, v = of_views(X)
    A = np.array([component(X, v[:, k], l[k]) for k in np.argsort(l)[:-11:-1]])
    same(A @ A.T, np.eye(10))
    same(A @ X.T @ X, np.sort(l)[:-11:-1, None] * A)
    assert np.linalg.norm(X @ A[-1]) > np.linalg.norm(X - X @ A.T @ A, 2)  # no direction that is left has more
    held(A, found("pca", components=10, views=30, spread=0.2, seed=5), tolerance=1e-4)


# --- T82: cosine transform --------------------------------------------------------------------------------------------


@formula("T82")
def coefficient(c_v, I, c_u):
    """s = c_v^T I c_u"""
    return c_v.T @ I @ c_u


@formula("T82")
def cosine(k, i, n):
    """c_k(i) = sqrt(2/n) cos(pi k (i + 1/2) / n)"""
    return np.sqrt(2 / n) * np.cos(np.pi * k * (i + 1 / 2) / n)


@formula("T82")
def constant(n):
    """sqrt(1/n)"""
    return np.sqrt(1 / n)


def cosines(n):
    """(n, n), one a row."""
    return np.array([np.full(n, constant(n)), *(cosine(k, np.arange(n), n) for k in range(1, n))])


def zig_zag(width, height, count):
    """[(u, v)]: 0 0, 1 0, 0 1, 0 2, 1 1, 2 0, 3 0, ..."""
    order = sorted(np.ndindex(width, height), key=lambda uv: (sum(uv), uv[0] if sum(uv) % 2 == 0 else -uv[0]))
    return order[:count]


def waves(count):
    """(count, h w) weights of the lowest frequencies."""
    h, w = pixels()[0].shape
    along_v, along_u = cosines(h), cosines(w)
    return np.array([np.outer(along_v[v], along_u[u]).ravel() for u, v in zig_zag(w, h, count)])


@equation("T82")
def test_the_cosine_transform_is_a_rotation_and_the_product_has_its_first_coefficients():
    I, count = pixels()[0], 24  # ends within a diagonal
    along_v, along_u = (cosines(n) for n in I.shape)
    for table in (along_v, along_u):
        same(table @ table.T, np.eye(len(table)))
    s = [coefficient(along_v[v], I, along_u[u]) for u, v in zig_zag(*I.shape[::-1], count)]
    same(s, waves(count) @ I.ravel())
    held(waves(count), found("dct", coefficients=count))


# --- T83: mixture of Gaussians ----------------------------------------------------------------------------------------


@formula("T83")
def mixture(I, g, u, lambda_g):
    """s(g) = sum_u I(u) exp(-|g - u|^2 / (2 lambda_g^2))"""
    return np.sum(I * np.exp(-np.sum((g - u) ** 2, axis=-1) / (2 * lambda_g**2)))


@formula("T83")
def size_of_sums(p, lambda_g):
    """p / (2 pi lambda_g^2)"""
    return p / (2 * np.pi * lambda_g**2)


def of_mixture(columns, lambda_g):
    """(places, columns) of images (columns, h, w)."""
    p, size = int(lambda_g), columns.shape[1:]
    u = np.stack(np.mgrid[:size[0], :size[1]], -1).astype(float)
    rows, cols = ((n - 1 - (n // p - 1) * p) // 2 + p * np.arange(n // p) for n in size)  # about the middle
    return size_of_sums(p, lambda_g) * np.array([
        [mixture(one, np.array([a, b]), u, lambda_g) for one in columns] for a in rows for b in cols])


@equation("T83")
def test_the_mixture_is_the_sum_of_a_gaussian_at_every_pixel():
    (I, I_star, L_I), lambda_g = pixels(), 6.5
    s = of_mixture(np.array([*np.moveaxis(L_I, -1, 0), I - I_star]), lambda_g)
    L, e = s[:, :6], s[:, 6]
    # The product leaves out what is beyond four standard deviations.
    alike(found("mixture", extension_px=lambda_g, final_extension_px=lambda_g), L.T @ L, L.T @ e, 0.5 * e @ e, 2e-4)


@equation("T83")
def test_squares_of_the_sums_are_those_of_the_smoothed_image():
    # A Gaussian of 3 px, 1 high, smoothed by one of 4 px is one of 5 px, (3/5)^2 high.
    v, u = np.mgrid[-25.0:26.0, -25.0:26.0]
    spot = np.exp(-(u**2 + v**2) / 18.0)
    same(np.sum(of_mixture(spot[None], 4.0) ** 2), (9.0 / 25.0) ** 2 * np.pi * 25.0, 1e-3)


@equation("T83")
def test_the_extension_is_halved_as_long_as_the_step_is_small():
    for switch_px, last in ((0.01, 8.0), (100.0, 3.0)):
        answer = found("mixture", switch_px=switch_px, extension_px=8.0, final_extension_px=3.0)
        alike(answer, *found("mixture", extension_px=last, final_extension_px=last))


# --- T84: mutual information ------------------------------------------------------------------------------------------

BINS = 8


@formula("T84")
def width_of(bins):
    """255 / (bins - 1)"""
    return 255 / (bins - 1)


@formula("T84")
def information(p_ij, p_i, p_j):
    """MI = sum_ij p_ij log(p_ij / (p_i p_j))"""
    return np.sum(p_ij * np.log(p_ij / (p_i * p_j)))


@formula("T84")
def pairs(phi, phi_star):
    """p_ij = 1/N sum phi_i(I) phi_j(I*)"""
    N = len(phi)
    return 1 / N * (phi.T @ phi_star)


@formula("T84")
def logarithm(p_ij, p_i):
    """log(p_ij / p_i)"""
    return np.log(p_ij / p_i)


@formula("T84")
def slope(phi_slope_i, phi_star_j, p_ij, p_i, L_I):
    """dMI = 1/N sum over pixels, i, j of phi_i'(I) phi_j(I*) log(p_ij / p_i) L_I"""
    N = len(L_I)
    return 1 / N * ((phi_slope_i * phi_star_j) @ logarithm(p_ij, p_i) @ L_I)


@formula("T84")
def D(phi_slope, phi, L_I):
    """D_ij = 1/N sum phi_i' phi_j L_I"""
    N = len(L_I)
    return 1 / N * np.einsum("ni,njk->ijk", phi_slope, phi[:, :, None] * L_I[:, None])


@formula("T84")
def mixed(phi_slope_i, phi_slope_j, p_ij, p_i, L_I, D_ij, D_ji):
    """1/N sum phi_i' phi_j' log(p_ij / p_i) L_I^T L_I + sum_ij D_ij^T D_ji / p_ij"""
    N = len(L_I)
    weight = (phi_slope_i * phi_slope_j) @ logarithm(p_ij, p_i)
    return 1 / N * (L_I.T @ (weight[:, None] * L_I)) + D_ij.T @ (D_ji / p_ij[:, None])


@formula("T84")
def b_of(dMI, dMI_star):
    """b = -dMI + dMI*"""
    return -dMI + dMI_star


def splines(grey, width):
    """(phi, phi'), (n, BINS + 2) both: of each grey, over the bins."""
    bump = BSpline.basis_element(np.arange(-2.0, 3.0), extrapolate=False)
    place = grey.ravel()[:, None] / width - np.arange(-1, BINS + 1)
    return np.nan_to_num(bump(place)), np.nan_to_num(bump.derivative()(place)) / width


def filled(p):
    """(i, j) of the pairs of greys that occur."""
    return np.nonzero(p > 1e-12)


def information_of(I, I_star, width):
    p = pairs(splines(I, width)[0], splines(I_star, width)[0])
    i, j = filled(p)
    return information(p[i, j], p.sum(axis=1)[i], p.sum(axis=0)[j])


def slope_of(I, I_star, L_I, width):
    (phi, phi_slope), (phi_star, _) = splines(I, width), splines(I_star, width)
    p = pairs(phi, phi_star)
    i, j = filled(p)
    return slope(phi_slope[:, i], phi_star[:, j], p[i, j], p.sum(axis=1)[i], L_I.reshape(-1, 6))


def mixed_at_goal(I, L_I, width):
    (phi, phi_slope), L = splines(I, width), L_I.reshape(-1, 6)
    p, changes = pairs(phi, phi), D(phi_slope, phi, L)
    i, j = filled(p)
    return mixed(phi_slope[:, i], phi_slope[:, j], p[i, j], p.sum(axis=1)[i], L, changes[i, j], changes[j, i])


@equation("T84")
def test_information_is_what_the_entropies_lack_and_the_logarithm_what_one_grey_leaves_open():
    def entropy(p):
        return -np.sum(p * np.log2(p)) * np.log(2.0)

    p = np.array([[0.30, 0.05, 0.02], [0.01, 0.20, 0.04], [0.08, 0.10, 0.20]])
    p_i, p_j = p.sum(axis=1), p.sum(axis=0)
    same(information(p, p_i[:, None], p_j), entropy(p_i) + entropy(p_j) - entropy(p))
    same(np.sum(p * logarithm(p, p_i[:, None])), entropy(p_i) - entropy(p))
    phi, _ = splines(pixels()[0], 255.0 / (BINS - 1))
    same(pairs(phi, phi).sum(), 1.0)


@functools.lru_cache(maxsize=None)
def answers():
    """Derivatives of the information of moved greys by differences; they depend on no formula."""
    width, h = 255.0 / (BINS - 1), 1e-4

    def MI(I, I_star):
        p = splines(I, width)[0].T @ splines(I_star, width)[0] / I.size
        i, j = filled(p)
        return np.sum(p[i, j] * (np.log(p[i, j]) - np.log(p.sum(axis=1)[i]) - np.log(p.sum(axis=0)[j])))

    I, I_star, L = pixels()
    first = [(MI(I + h * L @ axis, I_star) - MI(I - h * L @ axis, I_star)) / (2.0 * h) for axis in np.eye(6)]
    L = pixels("desired")[2]
    second = [[sum(s * t * MI(I_star + s * h * L @ a, I_star + t * h * L @ b) for s in (1, -1) for t in (1, -1))
               / (4.0 * h * h) for a in np.eye(6)] for b in np.eye(6)]
    return np.array(first), np.array(second)


@equation("T84")
def test_slope_and_mixed_derivative_are_those_of_the_information_of_moved_greys():
    width = width_of(BINS)
    first, second = answers()
    same(slope_of(*pixels(), width), first, 1e-5)
    same(mixed_at_goal(*pixels("desired")[1:], width), second, 1e-4)


@equation("T84")
def test_the_product_has_this_information_slope_and_hessian():
    width, (I, I_star, L), star = width_of(BINS), pixels(), pixels("desired")[2]
    scale = I.size * width**2
    dMI_star = slope_of(I_star, I_star, star, width)
    H = scale * mixed_at_goal(I_star, star, width)
    cost = scale * (information_of(I_star, I_star, width) - information_of(I, I_star, width))
    alike(found("mutual_information", bins=BINS), H, scale * b_of(slope_of(I, I_star, L, width), dMI_star), cost)
    assert np.abs(b_of(dMI_star, dMI_star)).max() <= 1e-9 * np.abs(dMI_star).max()
    same(found("mutual_information", True, bins=BINS)[1] + 1.0, np.ones(6))  # nothing at the goal
