#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Values of measured RGL files beside Mitsuba 3's, at random pairs of directions.

    REFLECTREE_DATA=... bench/mitsuba/rgl_values.py [--reflectree build/bin/reflectree] [--pairs 3200]

Half of the pairs lie near the mirror direction. Mitsuba's values of f cos are cut at 0, as ours are. A value
differs where it is more than half a percent off; below 0.001 sr^-1, of 0.001. Mitsuba is the wheel of the
package index, put into a virtual environment (--venv) if it is not there. Exits with 1 where a value differs,
3 where Mitsuba cannot be had.
"""

import argparse
import os
import pathlib
import subprocess
import sys
import tempfile

from beside_mitsuba import mitsuba_python, stop

LIMIT, FLOOR = .005, 1e-3


def random_pairs(count, seed):
    import numpy as np
    random = np.random.default_rng(seed)

    def direction(n):
        z = .001 + .999 * random.random(n)
        phi, r = 2 * np.pi * random.random(n), np.sqrt(1 - z * z)
        return np.stack([r * np.cos(phi), r * np.sin(phi), z], axis=1)

    wo, wi = direction(2 * count), direction(2 * count)
    normal = np.concatenate([.4 * random.random((2 * count, 2)) - .2, np.ones((2 * count, 1))], axis=1)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    mirror = 2 * (wo * normal).sum(axis=1, keepdims=True) * normal - wo
    wi[::2] = mirror[::2]
    above = wi[:, 2] > 1e-3
    return wo[above][:count].astype("f4"), wi[above][:count].astype("f4")


def ours(program, file, wo, wi, folder):
    import numpy as np
    pairs, values = folder / "pairs.csv", folder / "values.npy"
    np.savetxt(pairs, np.concatenate([wo, wi], axis=1), fmt="%.9g", delimiter=",")
    subprocess.run([program, "-q", "eval", file, "--no-pdf", "--pairs", pairs, "-o", values], check=True)
    return np.load(values)[:, 9:12]


def theirs(file, wo, wi):
    import mitsuba as mi
    import numpy as np
    bsdf, context = mi.load_dict({"type": "measured", "filename": str(file)}), mi.BSDFContext()
    values = []
    for known, sampled in zip(wo.tolist(), wi.tolist()):
        at = mi.SurfaceInteraction3f()
        at.wi, at.sh_frame = known, mi.Frame3f([0, 0, 1])
        values.append(list(bsdf.eval(context, at, sampled)))
    return np.array(values)


def compare(o, program, folder):
    import mitsuba as mi
    import numpy as np
    mi.set_variant("scalar_rgb")
    failed = 0
    print("file  pairs  values that differ  worst  Mitsuba's values below 0")
    for seed, file in enumerate(sorted((o.data / "rgl").glob("*.bsdf"))):
        wo, wi = random_pairs(o.pairs, seed)
        reference = theirs(file, wo, wi)
        cut = np.maximum(reference, 0)
        error = np.abs(ours(program, file, wo, wi, folder) - cut) / np.maximum(cut, FLOOR)
        failed += (error > LIMIT).sum()
        print(f"{file.stem}  {len(wo)}  {(error > LIMIT).sum()}  {100 * error.max():.2g} %  "
              f"{100 * (reference < 0).mean():.2g} %", flush=True)
    return 1 if failed else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--reflectree", default="build/bin/reflectree", type=pathlib.Path)
    parser.add_argument("--data", default=os.environ.get("REFLECTREE_DATA"), type=pathlib.Path)
    parser.add_argument("--venv", default="build/mitsuba", type=pathlib.Path)
    parser.add_argument("--pairs", default=3200, type=int)
    o = parser.parse_args()
    if not o.data or not list((o.data / "rgl").glob("*.bsdf")):
        stop("no RGL files; set REFLECTREE_DATA or give --data", 2)
    try:
        import mitsuba  # noqa: F401
        import numpy  # noqa: F401
    except ImportError:
        python = mitsuba_python(o.venv.resolve())
        return subprocess.run([python, "-B", __file__, *sys.argv[1:]], check=False).returncode
    with tempfile.TemporaryDirectory() as folder:
        return compare(o, o.reflectree.resolve(), pathlib.Path(folder))


if __name__ == "__main__":
    sys.exit(main())
