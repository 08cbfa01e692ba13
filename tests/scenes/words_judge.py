# SPDX-License-Identifier: Apache-2.0
"""What a picture of words/ shows, as means over blocks with their standard errors; whether two agree; and what is stored of Mitsuba."""
import hashlib
import json
import math
import pathlib
import subprocess
import sys
import zlib

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "words"))

from pixels import read_exr  # noqa: E402

FOLDER, STORED = HERE / "words", HERE / "words.json"
BLOCKS = 4        # by 4, per channel
MEANS = .01       # how far a channel's mean may be off
LARGEST = 4.5     # of |z|, beyond
SLACK = .004      # of the value, for what docs/results/mitsuba.md says of both programs
FAINT = .05       # of the brightest channel: what is darker has no ratio of its own


def scenes():
    return sorted(FOLDER.glob("*.xml"))


def key(scene):
    """Numbers are of a scene as it is, with its parts and files."""
    h = hashlib.sha256()
    for path in [scene, *sorted(FOLDER.glob("*/*"))]:
        h.update(path.name.encode() + path.read_bytes())
    return f"{scene.stem} #{h.hexdigest()[:8]}"


def numbers_of(channels, errors=None):
    """(mean, standard error) of R, G and B over the blocks, which hold independent pixels."""
    found = []
    for c, rows in enumerate(channels):
        height, width = len(rows), len(rows[0])
        for j in range(BLOCKS):
            for i in range(BLOCKS):
                cells = [(y, x) for y in range(height * j // BLOCKS, height * (j + 1) // BLOCKS)
                         for x in range(width * i // BLOCKS, width * (i + 1) // BLOCKS)]
                error = math.sqrt(sum(errors[c][y][x] ** 2 for y, x in cells)) if errors else 0
                found.append((sum(rows[y][x] for y, x in cells) / len(cells), error / len(cells)))
    return found


def seed_of(scene):
    """Its own, so that what two scenes share is not seen through the same points."""
    return zlib.crc32(scene.stem.encode()) % 100_000


def render(program, scene, out, *more):
    """Ours, or the sentence that refuses it."""
    done = subprocess.run([program, "--seed", str(seed_of(scene)), "render", scene.name, "-o", out, *more], cwd=scene.parent,
                          stdin=subprocess.DEVNULL, capture_output=True, timeout=120, check=False)
    if done.returncode != 0:
        return None, done.stderr.decode()
    found = read_exr(pathlib.Path(out).read_bytes())
    return numbers_of([found[c] for c in "RGB"], [found["stderr." + c] for c in "RGB"]), ""


def means(numbers):
    n = len(numbers) // 3
    return [sum(m for m, _ in numbers[c * n:(c + 1) * n]) / n for c in range(3)]


def score(a, b, slack):
    """z of two (mean, standard error)."""
    beyond = max(0., abs(a[0] - b[0]) - slack * max(abs(a[0]), abs(b[0])) - 1e-6)
    return math.copysign(beyond / max(math.hypot(a[1], b[1]), 1e-4 * abs(b[0]), 1e-7), a[0] - b[0])


def differs(ours, theirs):
    """What does not agree, in words."""
    said = []
    a, b = means(ours), means(theirs)
    for name, x, y in zip("RGB", a, b):
        if y > FAINT * max(b) and not abs(x / y - 1) <= MEANS:
            said.append(f"the mean of {name} is {x:.5g}, not {y:.5g}")
    worst = max((abs(score(x, y, SLACK)) if math.isfinite(x[0]) else math.inf) for x, y in zip(ours, theirs))
    if not worst < LARGEST:
        said.append(f"a block is {worst:.1f} standard errors off")
    return said


def scores(ours, theirs):
    """z-scores of the blocks of one channel, where noise is what tells: other differences are far below it."""
    n = len(ours) // 3
    return [score(x, y, 0) for x, y in zip(ours[n:2 * n], theirs[n:2 * n]) if math.hypot(x[1], y[1]) > SLACK * y[0] > 0]


def load():
    return json.loads(STORED.read_text()) if STORED.exists() else {}


def store(found):
    def short(numbers):
        return [[float(f"{m:.5g}"), float(f"{e:.2g}")] for m, e in numbers]

    lines = [f"{json.dumps(k)}: {json.dumps(short(v))}" for k, v in found.items()]
    STORED.write_text("{\n" + ",\n".join(lines) + "\n}\n")
