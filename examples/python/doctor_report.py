# SPDX-License-Identifier: Apache-2.0
"""Reading a doctor's report: somebody's GGX sampler has a mistake in it, and the doctor says which."""

# %% [markdown]
# The three functions of a sampler as they stand in many renderers. `sample` draws a normal of the microfacets and
# mirrors `wo` at it. Its density must be carried over from normals to directions: divide by 4 (wo·wh). Here that has
# been forgotten.

# %%
import numpy as np

import reflectree as rt

ALPHA = 0.3


def half(wo, wi):
    wh = wo + wi
    return wh / np.linalg.norm(wh, axis=1, keepdims=True)


def distribution(cos_h):
    return ALPHA**2 / (np.pi * (cos_h**2 * (ALPHA**2 - 1) + 1) ** 2)


def f(wo, wi):
    """sr^-1, without the cosine."""
    wide_o, wide_i = (np.sqrt(ALPHA**2 + (1 - ALPHA**2) * w[:, 2] ** 2) for w in (wo, wi))
    return distribution(half(wo, wi)[:, 2]) * 0.5 / (wo[:, 2] * wide_i + wi[:, 2] * wide_o)


def wrong_pdf(wo, wi):
    cos_h = half(wo, wi)[:, 2]
    return distribution(cos_h) * cos_h


def sampler_with(pdf):
    def sample(wo, rng):
        u, phi = rng.random(len(wo)), 2 * np.pi * rng.random(len(wo))
        tan = ALPHA * np.sqrt(u / (1 - u))
        wh = np.stack([tan * np.cos(phi), tan * np.sin(phi), np.ones(len(wo))], axis=1)
        wh /= np.linalg.norm(wh, axis=1, keepdims=True)
        cosine = np.einsum("ij,ij->i", wo, wh)
        wi = 2 * cosine[:, None] * wh - wo
        good = (cosine > 0) & (wi[:, 2] > 0)  # the others are lost draws: all zeros
        wi[~good] = 0
        density, weight = np.zeros(len(wo)), np.zeros(len(wo))
        density[good] = pdf(wo[good], wi[good])
        weight[good] = f(wo[good], wi[good]) * wi[good, 2] / density[good]
        return wi, density, weight

    return sample


# %% [markdown]
# The diagnosis is false where a fault was found. Read the findings first, and of them the first: the others often
# follow from it. Each has a sentence, the check that saw it, a key for programs, and a pair of directions at which it
# shows.

# %%
diagnosis = rt.doctor(eval=f, sample=sampler_with(wrong_pdf), pdf=wrong_pdf, name="a GGX of somebody", effort="quick")
print("healthy" if diagnosis else "not healthy")
for finding in diagnosis.findings:
    print(finding)
    print(rt.causes()[finding.cause])

# %% [markdown]
# The pair can be typed into one's own code: here is what was computed there, and what it should have been.

# %%
evidence = diagnosis.faults[0].evidence
found = wrong_pdf(evidence.wo[None], evidence.wi[None])[0]
print(f"{evidence.quantity} is {found:.6g}, expected {evidence.expected:.6g}")

# %% [markdown]
# With the Jacobian the sampler is healthy. What is left are figures: how much weights vary, what the worst one is,
# how many draws are lost. They say whether a right sampler is a good one.

# %%


def right_pdf(wo, wi):
    return wrong_pdf(wo, wi) / (4 * np.einsum("ij,ij->i", wo, half(wo, wi)))


mended = rt.doctor(eval=f, sample=sampler_with(right_pdf), pdf=right_pdf, name="mended", effort="quick")
print(repr(mended))
worst = max(x.value for x in mended.figures if x.name == "relative_variance")
ours = rt.doctor(rt.Sampler(f), sampler="one-shot", effort="quick")
best = max(x.value for x in ours.figures if x.name == "relative_variance")
print(f"relative variance at the worst viewer: {worst:.2g}, of our one-shot mode {best:.2g}")
