# SPDX-License-Identifier: Apache-2.0
"""Klems matrices and Zemax tables as BSDFs of Mitsuba, which reads neither: values by Dr.Jit from the files as the
independent readers of tests/formats read them, directions by a cosine lobe. Import after a variant of Dr.Jit is set.

They are registered as "reflectree", the name of our own BSDF, with its parameter `material`: a scene is rendered as it
is by both programs."""

import math
import os
import pathlib
import sys

import drjit as dr
import mitsuba as mi

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tests" / "formats"))
import klems_reference  # noqa: E402
import zemax_reference  # noqa: E402

TURN = 0.0  # degrees of azimuth by which tables are turned: a fault


def azimuth(w):
    """In [0, 360) degrees."""
    phi = dr.rad2deg(dr.atan2(w.y, w.x))
    return dr.select(phi < 0, phi + 360, phi)


def turned(w, degrees):
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return mi.Vector3f(c * w.x - s * w.y, s * w.x + c * w.y, w.z)


class Klems:
    def __init__(self, path, side):
        self.rings, values, self.columns = klems_reference.read(path, "Visible", side)
        self.values = mi.Float(values)
        self.mirror = -1 if side == "front" else 1  # the front is seen through the layer

    def patch(self, w):
        theta, phi = dr.rad2deg(dr.acos(dr.minimum(w.z, 1))), azimuth(w)
        found, first, begin = mi.UInt32(0), 0, 0
        for end, count in self.rings:
            number = mi.UInt32(dr.round(phi * (count / 360))) % count + first
            found = dr.select(theta >= begin, number, found)
            first, begin = first + count, end
        return found, first

    def __call__(self, known, drawn, active):
        incident, count = self.patch(mi.Vector3f(-self.mirror * known.x, -known.y, known.z))
        exiting, _ = self.patch(mi.Vector3f(self.mirror * drawn.x, drawn.y, drawn.z))
        at = exiting * count + incident if self.columns else incident * count + exiting
        return dr.maximum(dr.gather(mi.Float, self.values, at, active), 0)


class Zemax:
    def __init__(self, path):
        self.angles, self.mirrored, values = zemax_reference.read(path)
        zemax_reference.hold(self.angles, values)
        self.values = mi.Float(values)

    @staticmethod
    def locate(nodes, x):
        """[(index, weight)] of the nodes beside x."""
        if len(nodes) == 1:
            return [(mi.UInt32(0), mi.Float(1))]
        low, start, width = mi.UInt32(0), mi.Float(nodes[0]), mi.Float(nodes[1] - nodes[0])
        for i in range(1, len(nodes) - 1):
            beyond = x >= nodes[i]
            low, start = dr.select(beyond, i, low), dr.select(beyond, nodes[i], start)
            width = dr.select(beyond, nodes[i + 1] - nodes[i], width)
        t = dr.clip((x - start) / width, 0, 1)
        return [(low, 1 - t), (low + 1, t)]

    def __call__(self, known, drawn, active):
        rotations, incidences, azimuths, radials = self.angles
        # About the mirror direction: towards the normal, and aside of it.
        sine = dr.sqrt(dr.maximum(1 - known.z * known.z, 1e-20))
        c, s = known.x / sine, known.y / sine
        mirror, towards = mi.Vector3f(-known.x, -known.y, known.z), mi.Vector3f(known.z * c, known.z * s, sine)
        x, y, z = dr.dot(drawn, towards), dr.dot(drawn, dr.cross(mirror, towards)), dr.dot(drawn, mirror)
        about = azimuth(mi.Vector2f(x, y))
        if self.mirrored:
            about = dr.minimum(about, 360 - about)
        rotation = 90 - azimuth(known)
        rotation = dr.select(rotation < 0, rotation + 360, rotation)
        sums = mi.Float(0)
        for r, w1 in self.locate(rotations, rotation):
            for i, w2 in self.locate(incidences, dr.rad2deg(dr.acos(dr.minimum(known.z, 1)))):
                for a, w3 in self.locate(azimuths, about):
                    for p, w4 in self.locate(radials, dr.rad2deg(dr.atan2(dr.sqrt(x * x + y * y), z))):
                        at = ((r * len(incidences) + i) * len(azimuths) + a) * len(radials) + p
                        sums += w1 * w2 * w3 * w4 * dr.gather(mi.Float, self.values, at, active)
        return dr.maximum(sums, 0)


class TableBSDF(mi.BSDF):
    def __init__(self, props):
        mi.BSDF.__init__(self, props)
        path, _, member = props["material"].partition("#")
        self.value = Zemax(path) if os.path.splitext(path)[1] == ".bsdf" else Klems(path, member)
        self.m_components = [mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide | mi.BSDFFlags.Anisotropic]
        self.m_flags = self.m_components[0]

    def eval(self, ctx, si, wo, active=True):
        active &= (si.wi.z > 0) & (wo.z > 0)
        return dr.select(active, self.value(turned(si.wi, TURN), turned(wo, TURN), active) * wo.z, 0) & active

    def pdf(self, ctx, si, wo, active=True):
        return dr.select(active & (si.wi.z > 0) & (wo.z > 0), wo.z / dr.pi, 0)

    def eval_pdf(self, ctx, si, wo, active=True):
        return self.eval(ctx, si, wo, active), self.pdf(ctx, si, wo, active)

    def sample(self, ctx, si, sample1, sample2, active=True):
        drawn = dr.zeros(mi.BSDFSample3f)
        drawn.wo = mi.warp.square_to_cosine_hemisphere(sample2)
        drawn.pdf, drawn.eta = self.pdf(ctx, si, drawn.wo, active), 1
        drawn.sampled_type, drawn.sampled_component = +mi.BSDFFlags.GlossyReflection, 0
        active &= drawn.pdf > 0
        return drawn, dr.select(active, self.eval(ctx, si, drawn.wo, active) / drawn.pdf, 0)

    def to_string(self):
        return "TableBSDF[]"


mi.register_bsdf("reflectree", TableBSDF)
