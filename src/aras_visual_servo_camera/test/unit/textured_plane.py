"""Exact pictures of a textured plane, and the photometric normal equations by brute force: for tests only."""

import numpy as np

REACH = 3.0  # standard deviations of a Gaussian that its kernel reaches
LENS = (-0.3306, 0.117, 0.001, -0.002, 0.0)  # the published lens, and some tangential distortion


def camera_info(width=160, height=120, lens=(0.0,) * 5):
    return {"width": width, "height": height, "K": [0.6 * width, 0.0, 0.49 * width, 0.0, 0.62 * width, 0.52 * height,
                                                    0.0, 0.0, 1.0], "D": list(lens), "distortion_model": "plumb_bob"}


def exponential(twist):
    """exp of a twist [v; w], (4, 4)."""
    v, w = np.array(twist[:3], float), np.array(twist[3:], float)
    angle, W = np.linalg.norm(w), np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])
    a, b, c = (1.0, 0.5, 1 / 6) if angle < 1e-8 else (
        np.sin(angle) / angle, (1 - np.cos(angle)) / angle**2, (angle - np.sin(angle)) / angle**3)
    X = np.eye(4)
    X[:3, :3] = np.eye(3) + a * W + b * W @ W
    X[:3, 3] = (np.eye(3) + b * W + c * W @ W) @ v
    return X


class TexturedPlane:
    """A plane in front of the reference camera with an analytic texture, seen without sampling errors.

    Args: info: camera_info.  plane: (A, B, C) in the reference camera [1/m].  waves: number of them.
    shortest_m, longest_m: their wavelengths.  seed.
    """

    def __init__(self, info, plane=(0.0, 0.0, 1.6), waves=30, shortest_m=0.03, longest_m=0.4, seed=1):
        self.info, self.plane = info, np.array(plane)
        random = np.random.default_rng(seed)
        length = np.exp(random.uniform(np.log(shortest_m), np.log(longest_m), waves))
        way = random.uniform(0.0, 2.0 * np.pi, waves)
        self._k = 2.0 * np.pi / length * np.stack([np.cos(way), np.sin(way)])
        self._phase, self._size = random.uniform(0.0, 2.0 * np.pi, waves), np.sqrt(length)
        self._size *= 40.0 / np.sqrt(0.5 * np.sum(self._size**2))  # 40 grey levels rms
        self.x, self.y, self.jacobian = rays(info)

    def grey(self, X_CgC=np.eye(4)):
        """(h, w) grey levels as floats, the camera at X_CgC in the reference camera."""
        R, p = X_CgC[:3, :3], X_CgC[:3, 3]
        way = np.stack([self.x, self.y, np.ones_like(self.x)], -1) @ R.T
        depth = (1.0 - self.plane @ p) / (way @ self.plane)
        P = p + depth[..., None] * way
        wave = np.cos(P[..., :2] @ self._k + self._phase)
        return 128.0 + wave @ self._size

    def image(self, X_CgC=np.eye(4)):
        """(h, w) uint8."""
        return np.clip(np.rint(self.grey(X_CgC)), 0, 255).astype(np.uint8)


def rays(info):
    """(x, y, J) of each pixel: normalised coordinates (h, w), and d(x, y)/d(u, v) (h, w, 2, 2), by Newton's method."""
    u, v = np.meshgrid(np.arange(info["width"], dtype=float), np.arange(info["height"], dtype=float))
    fx, fy, cx, cy = info["K"][0], info["K"][4], info["K"][2], info["K"][5]
    k1, k2, p1, p2, k3 = info["D"]
    x, y = (u - cx) / fx, (v - cy) / fy
    wanted = np.stack([x, y], -1)
    for _ in range(30):
        r2 = x * x + y * y
        s, ds = 1 + r2 * (k1 + r2 * (k2 + r2 * k3)), k1 + r2 * (2 * k2 + r2 * 3 * k3)
        at = np.stack([x * s + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
                       y * s + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y], -1)
        J = np.stack([s + 2 * x * x * ds + 2 * p1 * y + 6 * p2 * x, 2 * x * y * ds + 2 * p1 * x + 2 * p2 * y,
                      2 * x * y * ds + 2 * p1 * x + 2 * p2 * y, s + 2 * y * y * ds + 6 * p1 * y + 2 * p2 * x],
                     -1).reshape(x.shape + (2, 2))
        step = np.linalg.solve(J, (wanted - at)[..., None])[..., 0]
        x, y = x + step[..., 0], y + step[..., 1]
    return x, y, np.linalg.inv(J) / np.array([fx, fy])


def kernels(sigma):
    """(gauss, derivative): taps of the Gaussian and of its derivative, exact for a constant and for a ramp."""
    i = np.arange(-int(np.ceil(REACH * sigma)), int(np.ceil(REACH * sigma)) + 1)
    weight = np.exp(-0.5 * (i / sigma) ** 2)
    return weight / weight.sum(), i * weight / (i * i * weight).sum()


def correlate(image, along_v, along_u):
    """Separable correlation, the rim repeated."""
    half = len(along_u) // 2
    wide = np.pad(image, half, mode="edge")
    rows = sum(weight * wide[:, i:i + image.shape[1]] for i, weight in enumerate(along_u))
    return sum(weight * rows[i:i + image.shape[0]] for i, weight in enumerate(along_v))


def interaction(image, sigma, x, y, jacobian, plane):
    """L, (h, w, 6), of an image of floats: -(grad I)^T L_x, point by point."""
    gauss, derivative = kernels(sigma)
    gradient_uv = np.stack([correlate(image, gauss, derivative), correlate(image, derivative, gauss)], -1)
    gradient = np.einsum("...ij,...i->...j", np.linalg.inv(jacobian), gradient_uv)
    zeta, one, zero = plane[0] * x + plane[1] * y + plane[2], np.ones_like(x), np.zeros_like(x)
    L_x = np.stack([np.stack([-zeta, zero, x * zeta, x * y, -(one + x * x), y], -1),
                    np.stack([zero, -zeta, y * zeta, one + y * y, -x * y, -x], -1)], -2)
    return -np.einsum("...i,...ij->...j", gradient, L_x)


def symmetric(upper):
    """(6, 6) of its upper triangle."""
    H = np.zeros((6, 6))
    H[np.triu_indices(6)] = upper
    return H + np.triu(H, 1).T
