# SPDX-License-Identifier: Apache-2.0
"""My own BRDF: from a formula with its parameters, and from the array of a gonioreflectometer."""

# %%
import pickle

import numpy as np

import reflectree as rt


class Dusty:
    """A formula with parameters: lunar dust (Lommel and Seeliger) with an opposition lobe. A class can be pickled,
    and so can its samplers: a lambda cannot."""

    def __init__(self, albedo, surge):
        self.albedo, self.surge = albedo, surge

    def __call__(self, wo, wi):
        phase = np.arccos(np.clip((wo * wi).sum(axis=1), -1, 1))
        return self.albedo / (4 * np.pi) / (wo[:, 2] + wi[:, 2]) * (1 + self.surge * np.exp(-phase / 0.1))


dust = rt.Sampler(Dusty(0.2, 1.5))
wo = rt.direction(0.7, 0.0)
drawn = dust.sample(wo, 50_000, rng=1)
again = pickle.loads(pickle.dumps(dust))
assert np.array_equal(again.sample(wo, 50_000, rng=1).wi, drawn.wi)
print(f"share within 0.1 radians of the viewer: {np.mean(drawn.wi @ wo > np.cos(0.1)):.3f}")


# %% [markdown]
# A gonioreflectometer's array: values at (θ_o, θ_i, φ), radians. This instrument puts φ = 0 where a mirror reflects,
# and reports values with the cosine. Both must be said: there is no default for either.

# %%
THETA = np.linspace(0, 1.5, 16)
PHI = np.linspace(0, np.pi, 19)
o, i, p = np.meshgrid(THETA, THETA, PHI, indexing="ij")
measured = (0.1 + 0.8 * np.exp(-((o - i) ** 2 + (np.minimum(o, i) * p) ** 2) / 0.08)) * np.cos(i)


def interpolated(theta_o, theta_i, phi):
    """Trilinear; beyond the last angle the last value holds."""
    total, places = 0.0, []
    for x, nodes in ((theta_o, THETA), (theta_i, THETA), (phi, PHI)):
        at = np.clip((x - nodes[0]) / (nodes[1] - nodes[0]), 0, len(nodes) - 1 - 1e-9)
        places.append((at.astype(int), at - at.astype(int)))
    for corner in range(8):
        weight, index = 1.0, []
        for axis, (k, t) in enumerate(places):
            upper = corner >> axis & 1
            weight = weight * (t if upper else 1 - t)
            index.append(k + upper)
        total = total + weight * measured[tuple(index)]
    return total


table = rt.Sampler(rt.function_of_angles(interpolated, azimuth="forward", cosine=True))
wo, mirror = rt.from_angles(0.6, 0.6, 0.0, azimuth="forward")
print(f"f at the mirror direction {table.eval(wo, mirror):.3f}, its density {table.pdf(wo, mirror):.3f} per steradian")
print(f"albedo {table.albedo(wo):.4f}, mean weight {table.sample_one_shot(wo, n=100_000, rng=1).weight.mean():.4f}")
