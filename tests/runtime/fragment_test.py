#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The fragment shader of examples/shader: what it draws with the sampler, in both modes, is what it draws with uniform
directions, block by block of the picture.

    fragment_test.py REFLECTREE EXAMPLE_FOLDER SCRATCH [--twin]

--twin plants a weight that is 5 % too high, which must be seen.
"""

import pathlib
import subprocess
import sys

try:
    import moderngl
    import numpy as np
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(0)

SIZE, BLOCK, SAMPLES, FRAMES = 48, 8, 48, 4


def blocks(sphere, words, mode):
    """Mean luminance of each block and its variance."""
    mean = variance = 0
    for picture in sphere.pictures(words, mode, SIZE, SAMPLES, FRAMES):
        assert np.isfinite(picture).all()
        luminance = picture[..., :3].astype("f8") @ [0.2126, 0.7152, 0.0722]
        spread = (picture[..., 3] - luminance**2) / SAMPLES

        def folded(x):
            return x.reshape(SIZE // BLOCK, BLOCK, SIZE // BLOCK, BLOCK).mean(axis=(1, 3)) / FRAMES

        mean, variance = mean + folded(luminance), variance + folded(spread) / (BLOCK**2 * FRAMES)
    return mean, variance


def replaced(text, part, other):
    assert text.count(part) == 1, part
    return text.replace(part, other)


def main(program, example, scratch, *options):
    sys.path.insert(0, example)
    import sphere  # pylint: disable=import-error,import-outside-toplevel
    try:
        moderngl.create_standalone_context(backend="egl", require=430).release()
    except Exception as error:  # whatever the driver says
        print(f"skipped: no OpenGL 4.3 without a window (Debian: libegl1 libgl1-mesa-dri): {error}")
        return 0
    scratch = pathlib.Path(scratch)
    scratch.mkdir(parents=True, exist_ok=True)
    saved, words = scratch / "phong.rfl", scratch / "phong.glsl"
    subprocess.run([program, "-q", "build", "phong:kd=0.2/0.05/0.02,ks=0.6/0.5/0.4,n=60", "-o", saved], check=True)
    subprocess.run([program, "-q", "export", saved, "--glsl", words], check=True)
    right = sphere.shader_text

    def soft(*of):
        """Close to the sphere and with a faint sun: the bright one is noise that uniform directions bring."""
        text = replaced(right(*of), "vec3(12.0, 10.0, 7.0)", "vec3(0.6, 0.5, 0.4)")
        return replaced(text, "vec3(0.5 * at.x, 0.5 * at.y - 0.16,", "vec3(0.2 * at.x, 0.2 * at.y - 0.143,")

    sphere.shader_text = soft
    reference, reference_variance = blocks(sphere, words, "uniform")
    if "--twin" in options:
        sphere.shader_text = lambda *of: replaced(soft(*of), "weight = d.scale * f(", "weight = 1.05 * d.scale * f(")
    failed = False
    for mode in ("one-shot", "exact"):
        mean, variance = blocks(sphere, words, mode)
        z = (mean - reference) / np.sqrt(variance + reference_variance)
        whole = (mean - reference).sum() / np.sqrt((variance + reference_variance).sum())
        print(f"{mode}: largest |z| {abs(z).max():.2f}, root mean square {np.sqrt((z**2).mean()):.2f}, "
              f"of the whole {whole:.2f}; "
              f"variance {variance.mean() / reference_variance.mean():.3f} of uniform directions'")
        # 36 blocks: |z| > 4.5 comes by chance once in 4000 runs, 1.6 in the mean square root once in 10^7, |z| > 4 of the
        # whole once in 16 000.
        failed |= abs(z).max() > 4.5 or (z**2).mean() > 1.6**2 or abs(whole) > 4
    if "--twin" in options:
        print("rejected" if failed else "the planted fault was NOT noticed")
        return 0 if failed else 1
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
