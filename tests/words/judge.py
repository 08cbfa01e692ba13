# SPDX-License-Identifier: Apache-2.0
"""What a small picture shows, as eighteen numbers, and whether two agree."""
import math


def parts(width, height):
    """Four quadrants, and of two checkerboards, of single pixels and of two by two, the one colour."""
    all_pixels = [(x, y) for y in range(height) for x in range(width)]
    return [[p for p in all_pixels if (p[0] >= width // 2) == right and (p[1] >= height // 2) == below]
            for below in (False, True) for right in (False, True)] + [
                [(x, y) for x, y in all_pixels if (x // n + y // n) % 2] for n in (1, 2)]


def numbers_of(channels, errors=None):
    """Means over the parts of R, of G and of B: (mean, standard error) each. `channels`: three lists of rows."""
    found = []
    for c, rows in enumerate(channels):
        for part in parts(len(rows[0]), len(rows)):
            mean = sum(rows[y][x] for x, y in part) / len(part)
            error = math.sqrt(sum(errors[c][y][x] ** 2 for x, y in part)) / len(part) if errors else 0
            found.append((mean, error))
    return found


def means(numbers):
    """Of R, G and B, from the quadrants."""
    return [sum(m for m, _ in numbers[6 * c:6 * c + 4]) / 4 for c in range(3)]


def worst(ours, theirs, slack):
    """The largest difference beyond `slack` in standard errors of both, or in slacks where there is no noise;
    agreement is below 4.5 (18 numbers of some hundred rows each)."""
    largest = 0.
    scale = max(abs(m) for m, _ in theirs)
    for (a, ea), (b, eb) in zip(ours, theirs):
        beyond = abs(a - b) - slack * max(abs(b), .05 * scale) - 1e-6
        if beyond > 0 or not math.isfinite(a):
            noise = max(math.hypot(ea, eb), slack * abs(b) / 4.5, 1e-7)
            largest = max(largest, beyond / noise if math.isfinite(a) else math.inf)
    return largest


LIMIT = 4.5
