# SPDX-License-Identifier: Apache-2.0
"""Samplers inside Mitsuba 3: ``import reflectree.mitsuba`` registers the BSDF ``reflectree``.

    import mitsuba as mi
    mi.set_variant("llvm_ad_rgb")
    import reflectree.mitsuba

    bsdf = mi.load_dict({"type": "reflectree", "nested": {"type": "principled", "roughness": 0.3}})

It takes its values from the nested BSDF, and directions and densities from a sampler that is built from those values
when the scene is loaded, once: the next load finds it in a file. docs/mitsuba.md has the rest.
"""

from __future__ import annotations

import atexit
import os
import pathlib
import time
import warnings
import weakref
from typing import Any, Dict, List, Optional, Tuple

import numpy as np

from . import __version__
from ._brdf import Brdf, load, material
from ._drjit import DrJitSampler
from ._error import Error
from ._mitsuba_nested import Surface, brdf_of, complete, identity_of, refuse_what_cannot_be_wrapped
from ._sampler import Sampler, load_sampler

try:
    import drjit as dr  # type: ignore[import-not-found, import-untyped, unused-ignore]
    import mitsuba as mi  # type: ignore[import-not-found, import-untyped, unused-ignore]
except ImportError:
    raise Error("Mitsuba 3 is not installed", "reflectree.mitsuba", "pip install mitsuba") from None

__all__ = ["register"]

PARAMETERS = ("material", "file", "member", "sampler", "cache", "uniforms", "mode")


class _Held:
    """What a BSDF has of ours. Mitsuba's objects may outlive the interpreter's end; ours let go before."""

    alive: "weakref.WeakSet[_Held]" = weakref.WeakSet()

    def __init__(self, nested: Any, sampler: Sampler, tree: Any) -> None:
        self.nested, self.sampler, self.tree = nested, sampler, tree
        self.alive.add(self)

    @classmethod
    def release(cls) -> None:
        for held in list(cls.alive):
            vars(held).clear()


atexit.register(_Held.release)


class _PackageSampler:
    """The package's own sampler, one direction at a time: for scalar variants."""

    def __init__(self, sampler: Sampler) -> None:
        self._sampler = sampler

    def sample(self, wo: Any, u1: Any, u2: Any, active: Any, monotone: bool) -> Tuple[Any, Any]:
        x, y, z, pdf = self._sampler._core.draw_one(_floats(wo), u2[0], u2[1])
        return (x, y, z), pdf

    def pdf(self, wo: Any, wi: Any, active: Any) -> float:
        return float(self._sampler._core.density_one(_floats(wo), _floats(wi)))


def _floats(w: Any) -> List[float]:
    return [w[0], w[1], w[2]]


def _row(w: Any) -> Any:
    return np.array([w[0], w[1], w[2]], dtype=np.float32)


class _Ours:
    """A material of ours as values for Mitsuba: evaluated arrays go through NumPy."""

    def __init__(self, brdf: Brdf, where: str) -> None:
        self._brdf = brdf
        if brdf.channels not in (1, 3):
            raise Error(f"it has {brdf.channels} channels", where, "give a material of one channel or three")
        if mi.is_spectral and brdf.channels == 3:
            raise Error("its values are red, green and blue, and the variant is spectral", where,
                        "use an rgb variant, or a material of one channel")

    def eval(self, context: Any, si: Any, wi: Any, active: Any = True) -> Any:
        if not dr.is_jit_v(mi.Float):
            wo, wi = _row(si.wi), _row(wi)
            if not (active and wo[2] > 0 and wi[2] > 0):
                return mi.Spectrum(0)
            return self._spectrum([float(v) for v in self._brdf.eval(wo, wi, cosine=True).reshape(-1)])
        try:
            known, drawn = self._rows(si.wi), self._rows(wi)
            known, drawn = np.broadcast_arrays(known, drawn)
        except Exception as error:  # Dr.Jit's own, for arrays that are symbols
            raise Error(f"{self._brdf.name!r}, a material of ours, has values in evaluated arrays only, and these are "
                        "symbols: Dr.Jit compiles every BSDF that exists", "reflectree in Mitsuba",
                        "render inside `with reflectree.mitsuba.evaluated():`, nest a BSDF of Mitsuba instead, or, "
                        "where this one is no longer needed, delete it and call gc.collect()") from error
        above = (known[:, 2] > 0) & (drawn[:, 2] > 0)
        values = np.zeros((len(known), self._brdf.channels), dtype=np.float32)
        values[above] = self._brdf.eval(known[above], drawn[above], cosine=True).reshape(-1, self._brdf.channels)
        columns = [mi.Float(np.ascontiguousarray(values[:, c])) for c in range(self._brdf.channels)]
        return self._spectrum(columns) & active

    def _rows(self, w: Any) -> Any:
        w = dr.detach(w)
        dr.eval(w)
        columns = [np.asarray(w[k], dtype=np.float32) for k in range(3)]
        n = max(len(c) for c in columns)
        return np.stack([np.broadcast_to(c, n) for c in columns], axis=1)

    def _spectrum(self, columns: Any) -> Any:
        if mi.is_monochromatic and len(columns) == 3:
            return mi.Spectrum(0.2126 * columns[0] + 0.7152 * columns[1] + 0.0722 * columns[2])
        return mi.Spectrum(columns[0]) if len(columns) == 1 else mi.Spectrum(*columns)


def evaluated() -> Any:
    """A context in which Mitsuba renders in evaluated wavefronts, which materials of ours need."""
    import contextlib

    stack = contextlib.ExitStack()
    for flag in (dr.JitFlag.SymbolicLoops, dr.JitFlag.SymbolicCalls, dr.JitFlag.OptimizeCalls):
        stack.enter_context(dr.scoped_set_flag(flag, False))
    return stack


def _cache_folder(text: str) -> Optional[pathlib.Path]:
    if text == "none":
        return None
    if text:
        return pathlib.Path(text)
    base = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
    return pathlib.Path(base) / "reflectree" / "mitsuba"


def _built(f: Brdf) -> Sampler:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        sampler = Sampler(f)
    for warning in caught:
        mi.Log(mi.LogLevel.Warn, f"reflectree: {warning.message}")
    return sampler


def _wrapped(nested: Any, cache: str) -> Sampler:
    """The sampler of a nested BSDF, from its file where there is one."""
    surface = Surface(mi, dr, nested)
    refuse_what_cannot_be_wrapped(surface)
    f = brdf_of(surface)
    folder = _cache_folder(cache)
    path = folder / (identity_of(surface, __version__) + ".rfl") if folder else None
    if path and path.exists():
        try:
            return load_sampler(path, f)
        except Error as error:
            mi.Log(mi.LogLevel.Warn, f"reflectree: {error}; it is built again")
    start = time.perf_counter()
    sampler = _built(f)
    mi.Log(mi.LogLevel.Info, f"reflectree: built in {time.perf_counter() - start:.1f} s")
    if path:
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            sampler.save(path)
        except (OSError, Error) as error:
            mi.Log(mi.LogLevel.Warn, f"reflectree: the sampler is not kept: {error}")
    return sampler


def _class() -> Any:
    """The plug-in's class of the current variant."""

    class Reflectree(mi.BSDF):  # type: ignore[misc, unused-ignore]
        def __init__(self, props: Any) -> None:
            mi.BSDF.__init__(self, props)
            texts, nested = _parameters(props)
            self._exact = texts["mode"] == "exact"
            self._monotone = texts["uniforms"] == "monotone"
            self._cache = texts.get("cache", "")
            values, sampler = _values_and_sampler(texts, nested)
            self._hold(values, sampler)
            flags = mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide
            if not sampler.isotropic:
                flags |= mi.BSDFFlags.Anisotropic
            self.m_components = [flags]
            self.m_flags = flags

        def _hold(self, values: Any, sampler: Sampler) -> None:
            if dr.is_jit_v(mi.Float):
                exact = sampler.tables("exact") if self._exact else None
                tree: Any = DrJitSampler(mi, dr, sampler.tables(), exact)
                self._scale = sampler.tables().scale
            else:
                tree = _PackageSampler(sampler)
            self._held = _Held(values, sampler, tree)

        @property
        def nested(self) -> Any:
            """Where the values come from."""
            return self._held.nested

        @property
        def sampler(self) -> Sampler:
            """Where the directions come from."""
            return self._held.sampler

        def _values(self, context: Any, si: Any, wo: Any, active: Any) -> Any:
            return self.nested.eval(mi.BSDFContext(context.mode), si, wo, active)

        def _target(self, context: Any, si: Any) -> Any:
            """The norm of the channels, without the cosine, in the units of the sampler's target."""
            si = dr.detach(si)

            def target(wi: Any, active: Any) -> Any:
                wi = mi.Vector3f(*wi)
                values = dr.detach(self._values(context, si, wi, active)) * (self._scale / dr.maximum(wi.z, 1e-12))
                return dr.select(active & (wi.z > 0), dr.sqrt(dr.squared_norm(values)), 0)

            return target

        def sample(self, context: Any, si: Any, sample1: Any, sample2: Any, active: Any = True) -> Tuple[Any, Any]:
            drawn = dr.zeros(mi.BSDFSample3f)
            if not context.is_enabled(mi.BSDFFlags.GlossyReflection, 0):
                return drawn, mi.Spectrum(0)
            wo, tree = dr.detach(si.wi), self._held.tree
            if self._exact:
                wi, pdf = tree.sample_exact(wo, sample1, sample2, self._target(context, si), active)
            else:
                wi, pdf = tree.sample(wo, sample1, sample2, active, self._monotone)
            active = active & (pdf > 0)
            drawn.wo, drawn.pdf, drawn.eta = mi.Vector3f(*wi), pdf, 1
            drawn.sampled_type, drawn.sampled_component = mi.UInt32(int(mi.BSDFFlags.GlossyReflection)), 0
            values = self._values(context, si, drawn.wo, active)
            return drawn, dr.select(active, values / dr.select(active, pdf, 1), 0)

        def eval(self, context: Any, si: Any, wo: Any, active: Any = True) -> Any:
            if not context.is_enabled(mi.BSDFFlags.GlossyReflection, 0):
                return mi.Spectrum(0)
            return self._values(context, si, wo, active)

        def pdf(self, context: Any, si: Any, wo: Any, active: Any = True) -> Any:
            if not context.is_enabled(mi.BSDFFlags.GlossyReflection, 0):
                return mi.Float(0)
            known, drawn, tree = dr.detach(si.wi), dr.detach(wo), self._held.tree
            if self._exact:
                return tree.pdf_exact(known, drawn, self._target(context, si)(drawn, active), active)
            return tree.pdf(known, drawn, active)

        def eval_pdf(self, context: Any, si: Any, wo: Any, active: Any = True) -> Tuple[Any, Any]:
            if not self._exact:
                return self.eval(context, si, wo, active), self.pdf(context, si, wo, active)
            values = self.eval(context, si, wo, active)
            z = dr.maximum(dr.detach(wo.z), 1e-12)
            t = dr.sqrt(dr.squared_norm(dr.detach(values))) * (self._scale / z)
            return values, self._held.tree.pdf_exact(dr.detach(si.wi), dr.detach(wo), t, active)

        def parameters_changed(self, keys: Any = ()) -> None:
            """One-shot mode stays right with a sampler of other parameters, only noisier; exact mode does not."""
            if self._exact:
                self.rebuild()

        def rebuild(self) -> None:
            """The sampler again, for the parameters that the nested BSDF has now."""
            if isinstance(self.nested, mi.BSDF):
                self._hold(self.nested, _wrapped(self.nested, self._cache))

        def traverse(self, callback: Any) -> None:
            if isinstance(self.nested, mi.BSDF):
                callback.put("nested", self.nested, mi.ParamFlags.Differentiable)

        def to_string(self) -> str:
            return f"Reflectree[\n  nested = {self.nested},\n  sampler = {self.sampler}\n]"

    return Reflectree


def _parameters(props: Any) -> Tuple[Dict[str, str], List[Any]]:
    """Texts by name, and nested BSDFs."""
    if mi.is_polarized:
        raise Error("the variant is polarized, and samplers are of intensities", "reflectree", "use another variant")
    if mi.Float is not mi.Float32 and dr.is_jit_v(mi.Float):
        raise Error("the variant is of double precision, and tables are of single", "reflectree", "use another variant")
    nested, texts = [], {"uniforms": "alias", "mode": "one-shot"}
    for key in props.keys():
        value = props[key]
        if isinstance(value, mi.BSDF):
            nested.append(value)
        elif key in PARAMETERS:
            texts[key] = str(value)
        else:
            raise Error(f"it has no parameter {key!r}", "reflectree", f"say {', '.join(PARAMETERS)} or nest a BSDF")
    for key, choices in (("uniforms", ("alias", "monotone")), ("mode", ("one-shot", "exact"))):
        if texts[key] not in choices:
            raise Error(f"{key} {texts[key]!r} is none", "reflectree", f"say {' or '.join(choices)}")
    given = len(nested) + ("material" in texts) + ("file" in texts)
    if given > 1 or (given == 0 and "sampler" not in texts):
        raise Error(f"{given} functions are given", "reflectree", "nest one BSDF, or give material, file or sampler")
    if texts["mode"] == "exact" and (not nested or "sampler" in texts or mi.is_spectral or not dr.is_jit_v(mi.Float)):
        raise Error("exact mode is there for nested BSDFs in LLVM variants of rgb and mono, with a sampler built here",
                    "reflectree", "leave mode out: one-shot mode serves all")
    return texts, nested


def _values_and_sampler(texts: Dict[str, str], nested: List[Any]) -> Tuple[Any, Sampler]:
    if nested:
        complete(mi, nested[0])
        if "sampler" not in texts:
            return nested[0], _wrapped(nested[0], texts.get("cache", ""))
        surface = Surface(mi, dr, nested[0])
        refuse_what_cannot_be_wrapped(surface)
        return nested[0], load_sampler(texts["sampler"], brdf_of(surface))
    if "file" in texts:
        f: Optional[Brdf] = load(texts["file"], texts.get("member", ""))
    else:
        f = material(texts["material"]) if "material" in texts else None
    if "sampler" in texts:
        sampler = load_sampler(texts["sampler"], f)
    else:
        assert f is not None
        sampler = _built(f)
    return _Ours(sampler.brdf, "reflectree"), sampler


def register(*variants: Any) -> None:
    """Registers the BSDF ``reflectree`` with the current variant; importing does so for all that are set later."""
    if mi.variant() is None:
        return
    made = _class()
    mi.register_bsdf("reflectree", lambda props: made(props))


register()
mi.detail.add_variant_callback(register)
