# SPDX-License-Identifier: Apache-2.0
"""Renders scenes with Mitsuba's scalar_rgb: a line of JSON each, paths, samples and seeds in, pixels out.

For words.py and others, which run it in an environment that has Mitsuba. "path": a scene without an integrator
gets a path tracer."""
import json
import sys

import mitsuba as mi

mi.set_variant("scalar_rgb")
mi.set_log_level(mi.LogLevel.Error)
import numpy  # noqa: E402  comes with the environment

print(json.dumps({"ready": mi.__version__}), flush=True)
for line in sys.stdin:
    request = json.loads(line)
    try:
        scene = mi.load_file(request["scene"], parallel=False)
        how = scene.integrator() or (mi.load_dict({"type": "path"}) if request.get("path") else None)
        pictures = [numpy.array(mi.render(scene, spp=request["spp"], seed=s, integrator=how)) for s in request["seeds"]]
        pictures = [p if p.shape[2] > 1 else numpy.repeat(p, 3, axis=2) for p in pictures]
        answer = {"pictures": [[p[:, :, c].tolist() for c in range(3)] for p in pictures]}
    except Exception as error:  # whatever it is, the caller is told
        answer = {"error": str(error).strip().split("\n")[-1]}
    print(json.dumps(answer), flush=True)
