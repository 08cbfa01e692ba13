# SPDX-License-Identifier: Apache-2.0
"""Mitsuba 3's BSDFs before the doctor (pip install mitsuba numpy; LLVM 16 or later):

    reflectree doctor --exec "python3 examples/doctor/mitsuba_client.py '{\"type\": \"roughconductor\", \"alpha\": 0.1}'"
    reflectree doctor --exec "python3 examples/doctor/mitsuba_client.py '<bsdf type=\"principled\"/>' llvm_ad_mono"

The first argument is the BSDF: its dictionary as JSON, its XML, or the name of a file with either. The second is the
variant, llvm_ad_rgb if there is none; a spectral one is asked at four wavelengths. In Mitsuba the known direction is wi
and the sampled one wo; here they have our names. eval has the cosine. Only the front side is examined."""
import json
import os
import sys
import xml.etree.ElementTree as ElementTree

import drjit as dr
import mitsuba as mi
import numpy as np

WAVELENGTHS = (450, 520, 590, 660)  # nm


def load(text):
    if text.lstrip().startswith("<"):
        root = ElementTree.fromstring(text)
        root.attrib.setdefault("version", "3.0.0")
        return mi.load_string(ElementTree.tostring(root, encoding="unicode"))
    return mi.load_dict(json.loads(text))


def open_bsdf(arguments):
    """The BSDF, or the end of the program with a sentence."""
    if len(arguments) not in (1, 2):
        sys.exit("mitsuba_client.py: give a BSDF as JSON, as XML or as a file, and perhaps a variant")
    text, variant = arguments[0], (arguments[1:] or ["llvm_ad_rgb"])[0]
    if not variant.startswith(("llvm_", "cuda_")) or "polarized" in variant:
        sys.exit(f"mitsuba_client.py: the variant '{variant}' cannot be used: give one that works on arrays and is not "
                 "polarized, such as llvm_ad_rgb, llvm_ad_mono, llvm_ad_spectral")
    try:
        mi.set_variant(variant)
        if os.path.isfile(text):
            with open(text, encoding="utf-8") as file:
                text = file.read()
        found = load(text)
    except Exception as error:  # whatever Mitsuba, JSON or XML have to say
        sys.exit(f"mitsuba_client.py: the BSDF cannot be loaded: {error}")
    if not isinstance(found, mi.BSDF):
        sys.exit(f"mitsuba_client.py: this is no BSDF but a {type(found).__name__}")
    for k in range(found.component_count()):
        for flag, what in ((mi.BSDFFlags.Delta, "a delta lobe, whose directions have no density"),
                           (mi.BSDFFlags.Delta1D, "a lobe in one dimension, whose directions have no density"),
                           (mi.BSDFFlags.Transmission, "transmission, and the doctor looks at reflection alone")):
            if mi.has_flag(found.flags(k), flag) and mi.has_flag(found.flags(k), mi.BSDFFlags.FrontSide):
                sys.exit(f"mitsuba_client.py: the BSDF has {what}")
    if mi.has_flag(found.flags(), mi.BSDFFlags.SpatiallyVarying):
        print("mitsuba_client.py: the BSDF varies over the surface: examined at uv = (0.5, 0.5)", file=sys.stderr)
    return found


def vectors(rows):
    return mi.Vector3f(*(mi.Float(np.ascontiguousarray(rows[:, k], dtype=np.float32)) for k in range(3)))


def at(known):
    si = dr.zeros(mi.SurfaceInteraction3f, dr.width(known))
    si.wi = known
    si.n, si.sh_frame = mi.Normal3f(0, 0, 1), mi.Frame3f(mi.Vector3f(0, 0, 1))
    si.uv = mi.Point2f(0.5, 0.5)
    si.wavelengths = list(WAVELENGTHS) if mi.is_spectral else []
    return si


def columns(*arrays):
    n = max(dr.width(a) for a in arrays)
    return np.stack([np.broadcast_to(np.array(a, dtype=np.float64).reshape(-1), n) for a in arrays], axis=1)


def evaluate(bsdf, rows):
    return columns(*bsdf.eval(mi.BSDFContext(), at(vectors(rows[:, :3])), vectors(rows[:, 3:])))


def density(bsdf, rows):
    return columns(bsdf.pdf(mi.BSDFContext(), at(vectors(rows[:, :3])), vectors(rows[:, 3:])))


def sample(bsdf, rows, seed):
    u = [mi.Float(x) for x in np.random.default_rng(seed).random((3, len(rows)), dtype=np.float32)]
    drawn, weight = bsdf.sample(mi.BSDFContext(), at(vectors(rows)), u[0], mi.Point2f(u[1], u[2]))
    out = columns(drawn.wo.x, drawn.wo.y, drawn.wo.z, drawn.pdf, *weight)
    # In Mitsuba a weight of 0 says that sampling failed, and then the rest may be anything: NaN means nothing there.
    out[np.all(out[:, 4:] == 0, axis=1) & ~np.all(np.isfinite(out), axis=1)] = 0
    return out


def main(arguments):
    bsdf = open_bsdf(arguments)
    stdin, stdout = sys.stdin.buffer, sys.stdout.buffer
    name = "mitsuba-" + bsdf.class_name()
    stdout.write(f"reflectree-doctor 1 name={name} channels={len(mi.Spectrum())} eval=f_cos sample=weight "
                 "format=binary\n".encode())
    stdout.flush()
    for line in iter(stdin.readline, b""):
        word, *numbers = line.decode().split()
        if word == "quit":
            break
        n, width = int(numbers[0]), 3 if word == "sample" else 6
        rows = np.frombuffer(stdin.read(n * width * 8), dtype="<f8").reshape(n, width)
        answer = sample(bsdf, rows, int(numbers[1])) if word == "sample" else {
            "eval": evaluate, "pdf": density}[word](bsdf, rows)
        stdout.write(np.ascontiguousarray(answer, dtype="<f8").tobytes())
        stdout.flush()


if __name__ == "__main__":
    main(sys.argv[1:])
