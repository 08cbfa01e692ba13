# SPDX-License-Identifier: Apache-2.0
"""A BSDF of Mitsuba as a reflectance function of ours: its values, what cannot be served, and its identity.

Mitsuba calls the known direction wi and the sampled one wo, and its values contain the cosine; here ``wo`` is known.
"""

from __future__ import annotations

import hashlib
import re
from typing import Any, Callable, Dict, Iterator, List, Optional, Tuple, Union

import numpy as np

from ._arrays import Array
from ._brdf import Brdf, function
from ._conventions import direction
from ._error import Error
from ._mitsuba_textures import VariedTextures

PROBES = 256
Place = Union[float, Any]  # of the surface: one for all, or texture coordinates
# At which a spectral variant's values are sampled, in nm: two interactions of four wavelengths.
WAVELENGTHS = ((400.0, 486.0, 571.0, 657.0), (443.0, 529.0, 614.0, 700.0))


class Surface:
    """Where and with which wavelengths a BSDF is asked. With textures it is a family; inside of their varied()
    members are asked for by ``at``, values of the parameters."""

    def __init__(self, mi: Any, dr: Any, bsdf: Any, textures: Optional[VariedTextures] = None) -> None:
        self.mi, self.dr, self.bsdf, self.textures = mi, dr, bsdf, textures
        self.jit = dr.is_jit_v(mi.Float)
        self._context = mi.BSDFContext()

    def cosine_values(self, wo: Array, wi: Array, place: Place = 0.5, **at: Array) -> Array:
        """eval, with the cosine, channel by channel; ``place`` moves the point of the surface."""
        if at:
            assert self.textures
            place = self.textures.coordinates(at)
        if self.mi.is_spectral:
            return np.concatenate([self._ask(wo, wi, place, list(w)) for w in WAVELENGTHS], axis=1)
        return self._ask(wo, wi, place, [])

    def _ask(self, wo: Array, wi: Array, place: Place, wavelengths: List[float]) -> Array:
        if self.jit:
            values = self._eval(self._vector(wo), self._vector(wi), len(wo), place, wavelengths)
            self.dr.eval(values)
            columns = [np.asarray(values[c], dtype=np.float32) for c in range(len(values))]
            return np.stack([np.broadcast_to(c, len(wo)) for c in columns], axis=1)
        rows = [self._eval(self.mi.Vector3f(*map(float, o)), self.mi.Vector3f(*map(float, i)), 1, place, wavelengths)
                for o, i in zip(wo, wi)]
        return np.asarray([[float(v) for v in row] for row in rows], dtype=np.float32).reshape(len(wo), -1)

    def _vector(self, rows: Array) -> Any:
        return self.mi.Vector3f(*(self.mi.Float(np.ascontiguousarray(rows[:, k], dtype=np.float32)) for k in range(3)))

    def interactions(self, wo: Any, n: int, place: Place) -> Any:
        """Of viewers with places of the surface: one for all, or their texture coordinates."""
        mi, dr = self.mi, self.dr
        si = dr.zeros(mi.SurfaceInteraction3f, n) if self.jit else dr.zeros(mi.SurfaceInteraction3f)
        si.t, si.wi = 1, wo
        si.uv = mi.Point2f(place, 1 - place) if isinstance(place, float) else place
        si.p = mi.Point3f(si.uv.x - 0.5, 1 - 2 * si.uv.y, 0)
        si.n, si.sh_frame = mi.Normal3f(0, 0, 1), mi.Frame3f(mi.Vector3f(1, 0, 0), mi.Vector3f(0, 1, 0),
                                                           mi.Vector3f(0, 0, 1))
        si.dp_du, si.dp_dv = mi.Vector3f(1, 0, 0), mi.Vector3f(0, 1, 0)
        return si

    def _eval(self, wo: Any, wi: Any, n: int, place: Place, wavelengths: List[float]) -> Any:
        si = self.interactions(wo, n, place)
        if wavelengths:
            si.wavelengths = type(si.wavelengths)(wavelengths)
        return self.bsdf.eval(self._context, si, wi)


def name_of(bsdf: Any) -> str:
    """The class of a plug-in, of Mitsuba or of Python."""
    return type(bsdf).__name__ if type(bsdf).__name__ != "BSDF" else str(bsdf.class_name())


def complete(mi: Any, bsdf: Any) -> None:
    """Gives the class of a BSDF that somebody wrote in Python with eval alone the rest: Dr.Jit compiles the methods of
    every BSDF that exists, the nested ones too. They are right, a cosine hemisphere, should anybody call them."""
    cls = type(bsdf)
    if cls is mi.BSDF or not issubclass(cls, mi.BSDF):
        return

    def sample(self: Any, context: Any, si: Any, sample1: Any, sample2: Any, active: Any = True) -> Tuple[Any, Any]:
        drawn = mi.BSDFSample3f()
        drawn.wo = mi.warp.square_to_cosine_hemisphere(sample2)
        drawn.pdf, drawn.eta = mi.warp.square_to_cosine_hemisphere_pdf(drawn.wo), 1
        drawn.sampled_type, drawn.sampled_component = int(mi.BSDFFlags.GlossyReflection), 0
        usable = (drawn.pdf > 0) & (si.wi.z > 0)
        return drawn, self.eval(context, si, drawn.wo, active) / drawn.pdf & usable

    def pdf(self: Any, context: Any, si: Any, wo: Any, active: Any = True) -> Any:
        return mi.warp.square_to_cosine_hemisphere_pdf(wo)

    def eval_pdf(self: Any, context: Any, si: Any, wo: Any, active: Any = True) -> Tuple[Any, Any]:
        return self.eval(context, si, wo, active), self.pdf(context, si, wo, active)

    def to_string(self: Any) -> str:
        return f"{cls.__name__}[]"

    for method in (sample, pdf, eval_pdf, to_string):
        if not any(method.__name__ in vars(c) for c in cls.__mro__ if c not in mi.BSDF.__mro__):
            setattr(cls, method.__name__, method)


def brdf_of(surface: Surface) -> Brdf:
    """f of ours. Where values are negative, as interpolated measurements may be, their size is sampled."""

    def values(wo: Array, wi: Array) -> Array:
        f: Array = np.abs(surface.cosine_values(wo, wi)) / wi[:, 2:]
        return f

    return function(values, name="a BSDF of Mitsuba", dtype=np.float32)


def family_of(surface: Surface) -> Callable[..., Array]:
    """The same as a function of the parameters, too; quick inside of their varied()."""

    def values(wo: Array, wi: Array, **at: Array) -> Array:
        assert surface.textures
        surface.textures.check_named(at)
        with surface.textures.varied():
            f: Array = np.abs(surface.cosine_values(wo, wi, **at)) / wi[:, 2:]
        return f

    return values


def probes(n: int = PROBES) -> Tuple[Array, Array]:
    """Pairs of directions above the surface; half of them near the mirror direction."""
    rng = np.random.default_rng(20080204)
    wo = direction(np.arccos(rng.uniform(0.05, 1, n)), rng.uniform(0, 2 * np.pi, n))
    wi = direction(np.arccos(rng.uniform(0.05, 1, n)), rng.uniform(0, 2 * np.pi, n))
    near = wo * np.array([-1, -1, 1]) + 0.1 * (rng.random((n, 1)) * wi)
    near /= np.linalg.norm(near, axis=1, keepdims=True)
    wi[n // 2:] = near[n // 2:]
    return wo.astype(np.float32), wi.astype(np.float32)


def refuse_what_cannot_be_wrapped(surface: Surface) -> None:
    """Raises Error, with a sentence, for deltas, transmission, back sides and what varies over the surface."""
    mi, bsdf = surface.mi, surface.bsdf
    where = f"reflectree around {name_of(bsdf)}"
    flags, kinds = int(bsdf.flags()), mi.BSDFFlags
    if flags & int(kinds.Delta | kinds.Delta1D):
        raise Error("it has a mirror-like part (a delta), which has no values to sample", where,
                    "nest a rough BSDF, or blend the mirror with a reflectree by a blendbsdf")
    if flags & int(kinds.Transmission):
        raise Error("it transmits light, and samplers are of reflection", where, "nest a BSDF that reflects only")
    if flags & int(kinds.SpatiallyVarying) and not surface.textures:
        raise Error("its parameters vary over the surface, and a sampler serves one set of them", where,
                    "nest a BSDF without textures, or name the parameter of one or two of them, as in family alpha")
    wo, wi = probes()
    down = np.array([1, 1, -1], dtype=np.float32)
    if np.any(surface.cosine_values(wo, wi * down) != 0):
        raise Error("it transmits light, and samplers are of reflection", where, "nest a BSDF that reflects only")
    if np.any(surface.cosine_values(wo * down, wi * down) != 0):
        raise Error("it reflects from the back side, too", where,
                    "nest what is inside of it, and put a twosided around the reflectree")
    if surface.textures:
        return _refuse_what_else_varies(surface, surface.textures, wo, wi, where)
    values = surface.cosine_values(wo, wi)
    for place in (0.0, 0.3, 0.9):
        other = surface.cosine_values(wo, wi, place)
        if not np.allclose(other, values, rtol=1e-3, atol=1e-6 * float(np.max(np.abs(values), initial=0)),
                           equal_nan=True):
            raise Error("its values vary over the surface, and a sampler serves one set of parameters", where,
                        "nest a BSDF without textures and bumps, or name the parameter of one or two of them, as in "
                        "family alpha")


def _refuse_what_else_varies(surface: Surface, textures: VariedTextures, wo: Array, wi: Array, where: str) -> None:
    """Raises Error unless the values at places all over the surface are those of the members there."""
    mi = surface.mi
    u, v = np.random.default_rng(3).random((2, len(wo)), dtype=np.float32)
    place = mi.Point2f(mi.Float(u), mi.Float(v))
    si = surface.interactions(mi.Vector3f(0, 0, 1), len(wo), place)
    at = {name: np.broadcast_to(np.asarray(x, np.float32), len(wo))
          for name, x in zip(textures.ranges, textures.at(si, True))}
    values = surface.cosine_values(wo, wi, place)
    with textures.varied():
        textures.follows(at, surface.interactions(mi.Vector3f(0, 0, 1), len(wo), textures.coordinates(at)))
        members = surface.cosine_values(wo, wi, **at)
    largest = float(np.max(np.abs(values), initial=0))
    if not np.allclose(members, values, rtol=2e-3, atol=1e-6 * largest, equal_nan=True):
        raise Error("its values vary over the surface by more than " + " and ".join(textures.ranges), where,
                    "nest a BSDF that has no other textures and no bumps")


def identity_of(surface: Surface, options: str) -> str:
    """A name for the sampler of this BSDF: its class, its text, its parameters, some values, the options. Of a family,
    inside of varied(): whatever its textures hold."""
    digest = hashlib.sha256()

    def add(data: Any) -> None:
        data = data if isinstance(data, bytes) else str(data).encode()
        digest.update(len(data).to_bytes(8, "little") + data)

    bsdf, textures = surface.bsdf, surface.textures
    add(options)
    add(f"{surface.mi.is_rgb} {surface.mi.is_spectral} {surface.mi.is_monochromatic}")
    add(name_of(bsdf))
    # Without addresses, and as scalar and JIT variants write alike: no brackets, no zeros at the end of a number.
    text = re.sub(r"0x[0-9a-fA-F]+|[\[\]\s]", "", str(bsdf))
    at: Dict[str, Array] = {}
    wo, wi = probes(32)
    if textures:
        add(textures.ranges)
        text = re.sub(r'\bname="[^"]*"', "", text)  # of a bitmap's file
        rng = np.random.default_rng(4)
        at = {name: rng.uniform(*ends, len(wo)).astype(np.float32) for name, ends in textures.ranges.items()}
    add(re.sub(r"\d+\.\d+", lambda number: f"{float(number[0]):g}", text))
    for part in _parameter_parts(surface):
        add(part)
    add(" ".join(f"{v:.2e}" for v in surface.cosine_values(wo, wi, **at).reshape(-1)))
    return digest.hexdigest()[:32]


def parameters_of(surface: Surface) -> List[Any]:
    """All parameters of the BSDF but those of a family, to compare."""
    return list(_parameter_parts(surface))


def _parameter_parts(surface: Surface) -> Iterator[Any]:
    parameters = surface.mi.traverse(surface.bsdf)
    for name in sorted(surface.textures.others() if surface.textures else parameters.keys()):
        value = parameters[name]
        yield name
        try:
            yield np.ascontiguousarray(np.asarray(value, dtype=np.float32)).tobytes()
        except (TypeError, ValueError):
            yield str(value)
