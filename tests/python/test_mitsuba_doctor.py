# SPDX-License-Identifier: Apache-2.0
"""The doctor's client of Mitsuba 3, examples/doctor/mitsuba_client.py."""

import os
import subprocess
import sys

import numpy as np
import pytest
from mitsuba_parts import direction, dr, mi, needs_llvm, nothing_left, variant  # noqa: F401, fixtures among them


def client(*arguments, requests=b""):
    path = os.path.join(os.path.dirname(__file__), "..", "..", "examples", "doctor", "mitsuba_client.py")
    return subprocess.run([sys.executable, path, *arguments], input=requests, capture_output=True, timeout=300, check=False)


@needs_llvm
@pytest.mark.parametrize("given", ['{"type": "roughconductor", "alpha": 0.3}',
                                   '<bsdf type="roughconductor"><float name="alpha" value="0.3"/></bsdf>'])
@pytest.mark.parametrize("name, channels", [("llvm_ad_rgb", 3), ("llvm_ad_mono", 1), ("llvm_ad_spectral", 4)])
def test_the_doctors_client_answers(tmp_path, given, name, channels):
    pairs = np.array([[*direction(40, 0), *direction(50, 200)], [*direction(0, 0), *direction(30, 10)]])
    requests = (b"eval 2\n" + pairs.tobytes() + b"pdf 2\n" + pairs.tobytes() + b"sample 2 7\n" +
                pairs[:, :3].tobytes() + b"quit\n")
    (tmp_path / "bsdf").write_text(given)
    done = client(str(tmp_path / "bsdf"), name, requests=requests)
    assert done.returncode == 0, done.stderr
    assert client(given, name, requests=requests).stdout == done.stdout
    greeting, rest = done.stdout.split(b"\n", 1)
    assert greeting.split()[3] == f"channels={channels}".encode()
    answers = np.frombuffer(rest, "<f8")
    values, densities, draws = np.split(answers, [2 * channels, 2 * channels + 2])
    variant(name)
    bsdf = mi.load_dict({"type": "roughconductor", "alpha": 0.3})
    si = dr.zeros(mi.SurfaceInteraction3f, 2)
    si.wi, wo = mi.Vector3f(pairs[:, :3].T), mi.Vector3f(pairs[:, 3:].T)  # known, sampled
    if mi.is_spectral:
        si.wavelengths = [450, 520, 590, 660]
    expected, density = bsdf.eval_pdf(mi.BSDFContext(), si, wo)
    assert np.allclose(values.reshape(2, channels), np.array(expected).T.reshape(2, -1), rtol=1e-5)
    assert np.allclose(densities, np.array(density), rtol=1e-5)
    assert np.allclose(np.linalg.norm(draws.reshape(2, -1)[:, :3], axis=1), 1, atol=1e-5)


@needs_llvm
@pytest.mark.parametrize("arguments, sentence", [
    (['{"type": "dielectric"}'], b"delta lobe"),
    (['{"type": "roughdielectric"}'], b"transmission"),
    (['{"type": "nothing"}'], b"cannot be loaded"),
    (["{"], b"cannot be loaded"),
    (["<bsdf"], b"cannot be loaded"),
    (['{"type": "sphere"}'], b"no BSDF but a Shape"),
    (['{"type": "diffuse"}', "scalar_rgb"], b"one that works on arrays"),
    ([], b"give a BSDF"),
])
def test_the_doctors_client_refuses(arguments, sentence):
    done = client(*arguments)
    assert done.returncode == 1 and sentence in done.stderr, done.stderr
    assert not done.stdout and b"Traceback" not in done.stderr
