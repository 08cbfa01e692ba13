# SPDX-License-Identifier: Apache-2.0
"""Measured files: what is inside, a sampler of it, kept for the next run.

An RGL or Zemax .bsdf, a MERL .binary, Klems matrices in XML. Without one it makes do with a table that is computed.
"""

# %%
import pathlib
import tempfile

import numpy as np

import reflectree as rt

FILE = None  # the path of yours

if FILE:
    print("members:", rt.members(FILE) or "none, the file is one material")
    f = rt.load(FILE)
else:
    f = rt.material("baked_glossy")
print(f)

# %% [markdown]
# A sampler is built once and kept. Its file holds the tables and the name of the material, which is found again.

# %%
with tempfile.TemporaryDirectory() as folder:
    kept = pathlib.Path(folder) / "material.rfl"
    rt.Sampler(f).save(kept)
    sampler = rt.load_sampler(kept)
    print(f"{kept.stat().st_size / 1024:.0f} KiB on disk")

# %% [markdown]
# The albedo of each colour is the mean weight.

# %%
for theta in np.radians([0, 30, 60, 80]):
    wo = rt.direction(theta, 0.0)
    red, green, blue = sampler.sample_one_shot(wo, n=100_000, rng=1).weight.mean(axis=0)
    print(f"theta_o {np.degrees(theta):2.0f}: albedo {red:.3f} {green:.3f} {blue:.3f}")
