# SPDX-License-Identifier: Apache-2.0
"""A sampler that `reflectree doctor --exec 'python3 examples/doctor/client.py'` judges: GGX (alpha 0.3, no Fresnel)
by half vectors, on a pipe, line by line. docs/doctor.md has the protocol; put your own three functions in."""
import math
import random
import sys

ALPHA = 0.3
FAULTY = "--faulty" in sys.argv  # leaves the Jacobian out, to see it found


def unit(v):
    length = math.sqrt(sum(x * x for x in v))
    return [x / length for x in v]


def distribution(cos_h):
    s = 1 - cos_h * cos_h + (ALPHA * cos_h) ** 2
    return ALPHA * ALPHA / (math.pi * s * s)


def eval_f(wo, wi):
    """sr^-1, without cosine, one number per channel."""
    if wo[2] <= 0 or wi[2] <= 0:
        return [0.0]
    wide = [math.sqrt(ALPHA**2 + (1 - ALPHA**2) * w[2] ** 2) for w in (wo, wi)]
    h = unit([a + b for a, b in zip(wo, wi)])
    return [distribution(h[2]) * 0.5 / (wo[2] * wide[1] + wi[2] * wide[0])]


def pdf(wo, wi):
    """Per solid angle."""
    if wo[2] <= 0 or wi[2] <= 0:
        return 0.0
    h = unit([a + b for a, b in zip(wo, wi)])
    jacobian = 1 if FAULTY else 1 / (4 * sum(a * b for a, b in zip(wo, h)))
    return distribution(h[2]) * h[2] * jacobian


def sample(wo, rng):
    """Direction, pdf and weights f cos / pdf; zeros where there is none."""
    u, phi = rng.random(), 2 * math.pi * rng.random()
    tan = ALPHA * math.sqrt(u / (1 - u))
    h = unit([tan * math.cos(phi), tan * math.sin(phi), 1])
    d = sum(a * b for a, b in zip(wo, h))
    wi = unit([2 * d * b - a for a, b in zip(wo, h)])
    p = pdf(wo, wi) if d > 0 else 0
    if p <= 0:
        return [0.0] * 5
    return [*wi, p, *(f * wi[2] / p for f in eval_f(wo, wi))]


print("reflectree-doctor 1 name=ggx.py channels=1 eval=f sample=weight format=text", flush=True)
for request in sys.stdin:
    word, *numbers = request.split()
    if word == "quit":
        break
    rows = [[float(x) for x in sys.stdin.readline().split()] for _ in range(int(numbers[0]))]
    if word == "sample":
        rng = random.Random(int(numbers[1]))
        answers = [sample(row, rng) for row in rows]
    else:
        answers = [eval_f(row[:3], row[3:]) if word == "eval" else [pdf(row[:3], row[3:])] for row in rows]
    print("\n".join(" ".join(map(repr, answer)) for answer in answers), flush=True)
