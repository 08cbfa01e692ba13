# SPDX-License-Identifier: Apache-2.0
"""A sampler of any function in five lines, and what it is good for."""

# %%
import numpy as np

import reflectree as rt

# %% [markdown]
# `f(wo, wi)` is given arrays of shape (n, 3) and returns sr⁻¹, without the cosine. `wo` points to the viewer, `wi` to
# the light.

# %%
sampler = rt.Sampler(lambda wo, wi: 0.3 / (wo[:, 2] + wi[:, 2]))
print(sampler)

# %% [markdown]
# 100 000 directions for one viewer. Their density is exactly proportional to f cos θ.

# %%
wo = rt.direction(0.8, 0.0)
drawn = sampler.sample(wo, n=100_000, rng=1)

# %% [markdown]
# The reflected radiance under a light that fills the upper half of the sky, cos θ > 0.5.

# %%
light = drawn.wi[:, 2] > 0.5
print(f"reflected radiance {np.mean(drawn.weight * light):.3f}")

# %% [markdown]
# Both densities, per solid angle, at directions of your own.

# %%
wi = rt.direction(np.linspace(0, 1.5, 4), np.pi)
print("exact   ", sampler.pdf(wo, wi))
print("one-shot", sampler.pdf(wo, wi, mode="one-shot"))
