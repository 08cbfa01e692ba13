# SPDX-License-Identifier: Apache-2.0
"""Points that fill the square evenly stay even on the hemisphere: one-shot mode maps two uniforms to a direction."""

# %%
import numpy as np

import reflectree as rt

sampler = rt.Sampler("plastic:alpha=0.15")
wo = rt.direction(0.9, 0.0)


def light(wi):
    """A sky that is bright to one side."""
    return 1 + 0.8 * wi[:, 0:1]


def r2(n):
    """The additive sequence of the plastic number (Roberts 2018)."""
    return np.outer(np.arange(n), [0.7548776662466927, 0.5698402909980532]) % 1


# %% [markdown]
# The error under that light of points that are random, and of points that are even; a random shift of the even ones
# leaves them even, and makes the estimate unbiased.

# %%
exact = np.mean([np.mean(s.weight * light(s.wi), axis=0)
                 for s in (sampler.sample_one_shot(wo, (r2(200_000) + shift) % 1) for shift in (0, 0.3, 0.6))], axis=0)
rng = np.random.default_rng(1)
for n in (256, 1024, 4096):
    errors = {"random": [], "even": []}
    for _ in range(64):
        for name, u in (("random", rng.random((n, 2))), ("even", (r2(n) + rng.random(2)) % 1)):
            s = sampler.sample_one_shot(wo, u)
            errors[name].append(np.mean(s.weight * light(s.wi), axis=0) - exact)
    rms = {name: np.sqrt(np.mean(np.square(e))) for name, e in errors.items()}
    print(f"{n:5} points: error {rms['random']:.2e} random, {rms['even']:.2e} even, {rms['random'] / rms['even']:.1f} times")
