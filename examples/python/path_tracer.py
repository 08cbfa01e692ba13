# SPDX-License-Identifier: Apache-2.0
"""A path tracer in NumPy: a sphere on a floor under a sky, both covered by samplers of ours.

All paths of a picture go on together, one bounce at a time.
"""

# %%
import numpy as np

import reflectree as rt

WIDTH, SAMPLES = 48, 16
FILE = None  # "picture.ppm"
HEIGHT, BOUNCES = WIDTH * 2 // 3, 4
CENTRE, RADIUS = np.array([0, 0, 1.0]), 1.0
COVERS = [rt.Sampler("plastic:alpha=0.1"), rt.Sampler(lambda wo, wi: np.full(len(wo), 0.5 / np.pi))]  # sphere, floor


def sky(d):
    """A gradient, and a sun of 15 degrees."""
    sun = d @ np.array([0.48, -0.6, 0.64]) > np.cos(np.radians(7.5))
    return (0.3 + 0.5 * np.maximum(d[:, 2:], 0)) * [0.7, 0.85, 1.0] + 12.0 * sun[:, None] * [1, 0.9, 0.7]


def intersect(o, d):
    """The nearest hit of each ray: its distance (inf: none), normal and cover."""
    b = np.einsum("ij,ij->i", o - CENTRE, d)
    root = b**2 - (np.einsum("ij,ij->i", o - CENTRE, o - CENTRE) - RADIUS**2)
    sphere = np.where(root > 0, -b - np.sqrt(np.maximum(root, 0)), np.inf)
    sphere = np.where(sphere > 1e-6, sphere, np.inf)
    with np.errstate(divide="ignore", invalid="ignore"):
        floor = np.where(d[:, 2] < 0, -o[:, 2] / d[:, 2], np.inf)
    floor = np.where(floor > 1e-6, floor, np.inf)
    t = np.minimum(sphere, floor)
    p = o + np.where(np.isfinite(t), t, 0)[:, None] * d
    normal = np.where((sphere <= floor)[:, None], (p - CENTRE) / RADIUS, [0, 0, 1.0])
    return t, p, normal / np.linalg.norm(normal, axis=1, keepdims=True), np.where(sphere <= floor, 0, 1)


def frames(n):
    """Two tangents of each normal (Duff et al. 2017)."""
    sign = np.where(n[:, 2] < 0, -1.0, 1.0)
    a = -1 / (sign + n[:, 2])
    b = n[:, 0] * n[:, 1] * a
    s = np.stack([1 + sign * n[:, 0] ** 2 * a, sign * b, -sign * n[:, 0]], axis=1)
    return np.stack([s, np.stack([b, sign + n[:, 1] ** 2 * a, -n[:, 1]], axis=1), n], axis=1)


def radiance(o, d, rng):
    found, weight = np.zeros((len(o), 3)), np.ones((len(o), 3))
    alive = np.arange(len(o))
    for _ in range(BOUNCES + 1):
        t, p, n, cover = intersect(o, d)
        out = ~np.isfinite(t)
        found[alive[out]] += weight[alive[out]] * sky(d[out])
        alive, p, n, d, cover = alive[~out], p[~out], n[~out], d[~out], cover[~out]
        axes = frames(n)
        wo, wi = -np.einsum("nij,nj->ni", axes, d), np.zeros_like(d)
        wo /= np.linalg.norm(wo, axis=1, keepdims=True)
        valid = np.zeros(len(wo), bool)
        for k, sampler in enumerate(COVERS):
            mine = np.flatnonzero(cover == k)
            drawn = sampler.sample(wo[mine], rng=rng)
            wi[mine], valid[mine] = drawn.wi, drawn.valid
            weight[alive[mine]] *= drawn.weight.reshape(len(mine), -1)  # one number serves all three colours
        alive, o, d = alive[valid], (p + 1e-6 * n)[valid], np.einsum("nij,ni->nj", axes, wi)[valid]
        d /= np.linalg.norm(d, axis=1, keepdims=True)
    return found


# %%
rng = np.random.default_rng(1)
y, x = np.mgrid[0:HEIGHT, 0:WIDTH]
picture = np.zeros((HEIGHT * WIDTH, 3))
for _ in range(SAMPLES):
    u = (np.stack([x, y], axis=-1).reshape(-1, 2) + rng.random((HEIGHT * WIDTH, 2))) / WIDTH
    d = np.stack([u[:, 0] - 0.5, np.full(len(u), 1.2), HEIGHT / WIDTH / 2 - u[:, 1] - 0.1], axis=1)
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    picture += radiance(np.tile([0, -4.0, 1.4], (len(d), 1)), d, rng) / SAMPLES
print(f"{WIDTH} x {HEIGHT}, {SAMPLES} samples per pixel: mean {picture.mean():.3f}")
if FILE:
    bytes_ = (255 * np.clip(picture, 0, 1) ** (1 / 2.2)).astype(np.uint8)
    with open(FILE, "wb") as file:
        file.write(b"P6 %d %d 255\n" % (WIDTH, HEIGHT) + bytes_.tobytes())
