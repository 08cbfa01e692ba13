# SPDX-License-Identifier: Apache-2.0
"""What a small picture shows, as twelve numbers, and whether two agree."""
import math


def quadrants(channels, errors=None):
    """Means over the four quadrants of R, G and B: (mean, standard error) each. `channels`: three lists of rows."""
    found = []
    for c, rows in enumerate(channels):
        h, w = len(rows), len(rows[0])
        for ys in (range(h // 2), range(h // 2, h)):
            for xs in (range(w // 2), range(w // 2, w)):
                n = len(ys) * len(xs)
                mean = sum(rows[y][x] for y in ys for x in xs) / n
                error = math.sqrt(sum(errors[c][y][x] ** 2 for y in ys for x in xs)) / n if errors else 0
                found.append((mean, error))
    return found


def worst(ours, theirs, slack):
    """The largest difference beyond `slack` in standard errors of both, or in slacks where there is no noise;
    agreement is below 4.5 (12 numbers of a hundred rows each)."""
    largest = 0.
    scale = max(abs(m) for m, _ in theirs)
    for (a, ea), (b, eb) in zip(ours, theirs):
        beyond = abs(a - b) - slack * max(abs(b), .05 * scale) - 1e-6
        if beyond > 0 or not math.isfinite(a):
            noise = max(math.hypot(ea, eb), slack * abs(b) / 4.5, 1e-7)
            largest = max(largest, beyond / noise if math.isfinite(a) else math.inf)
    return largest


LIMIT = 4.5
