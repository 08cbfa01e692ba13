# SPDX-License-Identifier: Apache-2.0
"""Mitsuba 3's BSDFs before the doctor (pip install mitsuba numpy; LLVM 16 or later):

    reflectree doctor --exec 'python3 examples/doctor/mitsuba_client.py "{\"type\": \"roughconductor\", \"alpha\": 0.1}"'

The argument is the BSDF's dictionary as JSON; of a file, such as for `measured`, the path is taken as it is. In
Mitsuba the known direction is wi and the sampled one wo; here they have our names. eval has the cosine."""
import json
import sys

import drjit as dr
import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")
bsdf = mi.load_dict(json.loads(sys.argv[1]))
context = mi.BSDFContext()


def vectors(rows):
    return mi.Vector3f(*(mi.Float(np.ascontiguousarray(rows[:, k], dtype=np.float32)) for k in range(3)))


def at(known):
    si = dr.zeros(mi.SurfaceInteraction3f, dr.width(known))
    si.wi = known
    si.n, si.sh_frame = mi.Normal3f(0, 0, 1), mi.Frame3f(mi.Vector3f(0, 0, 1))
    si.uv, si.wavelengths = mi.Point2f(0.5, 0.5), []
    return si


def columns(*arrays):
    n = max(dr.width(a) for a in arrays)
    return np.stack([np.broadcast_to(np.array(a, dtype=np.float64).reshape(-1), n) for a in arrays], axis=1)


def evaluate(rows):
    value = bsdf.eval(context, at(vectors(rows[:, :3])), vectors(rows[:, 3:]))
    return columns(value.x, value.y, value.z)


def density(rows):
    return columns(bsdf.pdf(context, at(vectors(rows[:, :3])), vectors(rows[:, 3:])))


def sample(rows, seed):
    u = np.random.default_rng(seed).random((3, len(rows)), dtype=np.float32)
    drawn, weight = bsdf.sample(context, at(vectors(rows)), mi.Float(u[0]), mi.Point2f(mi.Float(u[1]), mi.Float(u[2])))
    out = columns(drawn.wo.x, drawn.wo.y, drawn.wo.z, drawn.pdf, weight.x, weight.y, weight.z)
    out[out[:, 3] == 0] = 0  # no sample
    return out


stdin, stdout = sys.stdin.buffer, sys.stdout.buffer
name = json.loads(sys.argv[1])["type"]
stdout.write(f"reflectree-doctor 1 name=mitsuba-{name} channels=3 eval=f_cos sample=weight format=binary\n".encode())
stdout.flush()
for line in iter(stdin.readline, b""):
    word, *numbers = line.decode().split()
    if word == "quit":
        break
    n, width = int(numbers[0]), 3 if word == "sample" else 6
    rows = np.frombuffer(stdin.read(n * width * 8), dtype="<f8").reshape(n, width)
    answer = sample(rows, int(numbers[1])) if word == "sample" else evaluate(rows) if word == "eval" else density(rows)
    stdout.write(np.ascontiguousarray(answer, dtype="<f8").tobytes())
    stdout.flush()
