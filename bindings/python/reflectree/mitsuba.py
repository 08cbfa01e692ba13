# SPDX-License-Identifier: Apache-2.0
"""Samplers inside Mitsuba 3: ``import reflectree.mitsuba`` registers the BSDF ``reflectree``.

    import mitsuba as mi
    mi.set_variant("llvm_ad_rgb")
    import reflectree.mitsuba

    bsdf = mi.load_dict({"type": "reflectree", "nested": {"type": "principled", "roughness": 0.3}})

It takes its values from the nested BSDF, and directions and densities from a sampler that is built from those values
when the scene is loaded, once: the next load finds it in a file. Where a texture varies a parameter, the sampler is of
a family:

    bsdf = mi.load_dict({"type": "reflectree", "family": "alpha",
                         "nested": {"type": "roughconductor", "alpha": {"type": "bitmap", "filename": "alpha.exr"}}})

docs/mitsuba.md has the rest.
"""

from __future__ import annotations

import atexit
import contextlib
import os
import pathlib
import time
import warnings
import weakref
from typing import Any, Callable, Dict, List, Optional, Tuple, Union

import numpy as np

from . import __version__, _core
from ._brdf import Brdf, load, material
from ._drjit import DrJitSampler
from ._error import Error
from ._family import FamilySampler, load_family
from ._mitsuba_nested import (Surface, brdf_of, complete, family_of, identity_of, name_of, parameters_of,
                              refuse_what_cannot_be_wrapped)
from ._mitsuba_textures import Textures, VariedTextures, parse_family
from ._sampler import Sampler, load_sampler

try:
    import drjit as dr  # type: ignore[import-not-found, import-untyped, unused-ignore]
    import mitsuba as mi  # type: ignore[import-not-found, import-untyped, unused-ignore]
except ImportError:
    raise Error("Mitsuba 3 is not installed", "reflectree.mitsuba", "pip install mitsuba") from None

__all__ = ["register"]

PARAMETERS = ("material", "file", "member", "sampler", "cache", "uniforms", "mode", "family")
AnySampler = Union[Sampler, FamilySampler]


class _Held:
    """What a BSDF has of ours. Mitsuba's objects may outlive the interpreter's end; ours let go before."""

    alive: "weakref.WeakSet[_Held]" = weakref.WeakSet()

    def __init__(self, nested: Any, sampler: AnySampler, tree: Any, textures: Optional[Textures],
                 parameters: List[Any]) -> None:
        self.nested, self.sampler, self.tree, self.textures = nested, sampler, tree, textures
        self.parameters = parameters  # of the nested BSDF, as the sampler was built for them
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

    def sample(self, wo: Any, u1: Any, u2: Any, active: Any, monotone: bool, at: Any) -> Tuple[Any, Any]:
        x, y, z, pdf = self._sampler._core.draw_one(_floats(wo), u2[0], u2[1])
        return (x, y, z), pdf

    def pdf(self, wo: Any, wi: Any, active: Any, at: Any) -> float:
        return float(self._sampler._core.density_one(_floats(wo), _floats(wi)))


def _floats(w: Any) -> List[float]:
    return [w[0], w[1], w[2]]


def _row(w: Any) -> Any:
    return np.array([w[0], w[1], w[2]], dtype=np.float32)


class _Ours:
    """A material of ours as values for Mitsuba, or a family with its textures: evaluated arrays go through NumPy."""

    def __init__(self, brdf: Union[Brdf, FamilySampler], where: str, textures: Optional[Textures] = None) -> None:
        self._brdf, self._textures = brdf, textures
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
            at = {}
            if self._textures:
                found = self._rows(self._textures.values(si, active), len(known))
                at = {name: self._textures.within(name, found[:, k]) for k, name in enumerate(self._textures.ranges)}
        except Exception as error:  # Dr.Jit's own, for arrays that are symbols
            raise Error(f"{self._brdf.name!r}, a material of ours, has values in evaluated arrays only, and these are "
                        "symbols: Dr.Jit compiles every BSDF that exists", "reflectree in Mitsuba",
                        "render inside `with reflectree.mitsuba.evaluated():`, nest a BSDF of Mitsuba instead, or, "
                        "where this one is no longer needed, delete it and call gc.collect()") from error
        above = (known[:, 2] > 0) & (drawn[:, 2] > 0)
        values = np.zeros((len(known), self._brdf.channels), dtype=np.float32)
        values[above] = self._brdf.eval(known[above], drawn[above], cosine=True, **{
            name: values[above] for name, values in at.items()}).reshape(-1, self._brdf.channels)
        columns = [mi.Float(np.ascontiguousarray(values[:, c])) for c in range(self._brdf.channels)]
        return self._spectrum(columns) & active

    def _rows(self, w: Any, n: int = 1) -> Any:
        w = dr.detach(w)
        dr.eval(w)
        columns = [np.asarray(x, dtype=np.float32) for x in w]
        n = max(n, *(len(c) for c in columns))
        return np.stack([np.broadcast_to(c, n) for c in columns], axis=1)

    def _spectrum(self, columns: Any) -> Any:
        if mi.is_monochromatic and len(columns) == 3:
            return mi.Spectrum(0.2126 * columns[0] + 0.7152 * columns[1] + 0.0722 * columns[2])
        return mi.Spectrum(columns[0]) if len(columns) == 1 else mi.Spectrum(*columns)


def evaluated() -> Any:
    """A context in which Mitsuba renders in evaluated wavefronts, which materials of ours need."""
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


def _built(build: Callable[[], Any]) -> Any:
    """A sampler, its notes in Mitsuba's log."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        sampler = build()
    for warning in caught:
        mi.Log(mi.LogLevel.Warn, f"reflectree: {warning.message}")
    return sampler


def _textures_of(nested: Any, text: str) -> VariedTextures:
    where = f"reflectree around {name_of(nested)}"
    if not dr.is_jit_v(mi.Float):
        raise Error("families are there in LLVM variants alone", where, "use another variant, or leave family out")
    given = parse_family(text, where)
    textures = VariedTextures(mi, dr, nested, list(given), where)
    textures.set_ranges(given)
    textures.check()
    return textures


def _wrapped(nested: Any, texts: Dict[str, str]) -> Tuple[AnySampler, Optional[VariedTextures], List[Any]]:
    """The sampler of a nested BSDF, its textures, and its other parameters."""
    textures = _textures_of(nested, texts["family"]) if "family" in texts else None
    surface = Surface(mi, dr, nested, textures)
    refuse_what_cannot_be_wrapped(surface)
    with textures.varied() if textures else contextlib.nullcontext():
        return _found_or_built(surface, texts), textures, parameters_of(surface)


def _found_or_built(surface: Surface, texts: Dict[str, str]) -> AnySampler:
    """From its file where there is one."""
    exact = texts["mode"] == "exact"
    if surface.textures:
        family = family_of(surface)
        as_function: Dict[str, Any] = {"name": "a BSDF of Mitsuba", "dtype": np.float32}
        options: Dict[str, Any] = {**as_function, **surface.textures.ranges}
        if not exact:  # one-shot mode draws nothing from the trees of exact mode, which cost most
            options.update(expected_trials=2.0, albedo_error=1e-3)
        load_it: Callable[[Any], AnySampler] = lambda path: load_family(path, family, **as_function)  # noqa: E731
        build: Callable[[], AnySampler] = lambda: FamilySampler(family, **options)  # noqa: E731
    else:
        f = brdf_of(surface)
        load_it, build = lambda path: load_sampler(path, f), lambda: Sampler(f)  # noqa: E731
    if "sampler" in texts:
        found = load_it(texts["sampler"])
        if surface.textures and isinstance(found, FamilySampler):
            surface.textures.check_served(found.ranges, texts["sampler"])
        return found
    folder = _cache_folder(texts.get("cache", ""))
    options_text = __version__ + (" exact" if surface.textures and exact else "")
    path = folder / (identity_of(surface, options_text) + ".rfl") if folder else None
    if path and path.exists():
        try:
            return load_it(path)
        except Error as error:
            mi.Log(mi.LogLevel.Warn, f"reflectree: {error}; it is built again")
    start = time.perf_counter()
    sampler: AnySampler = _built(build)
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
            texts, nested, given = _parameters(props)
            self._exact = texts["mode"] == "exact"
            self._monotone = texts["uniforms"] == "monotone"
            self._texts = texts
            if nested:
                complete(mi, nested[0])
                self._hold(nested[0], *_wrapped(nested[0], texts))
            else:
                self._hold(*_of_ours(texts, given), [])
            flags = mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide
            if not self.sampler.isotropic:
                flags |= mi.BSDFFlags.Anisotropic
            if self._held.textures:
                flags |= mi.BSDFFlags.SpatiallyVarying
            self.m_components = [flags]
            self.m_flags = flags

        def _hold(self, values: Any, sampler: AnySampler, textures: Optional[Textures], parameters: List[Any]) -> None:
            if dr.is_jit_v(mi.Float):
                exact = sampler.tables("exact") if self._exact else None
                tree: Any = DrJitSampler(mi, dr, sampler.tables(), exact)
                self._scale = sampler.tables().scale
            else:
                assert isinstance(sampler, Sampler)
                tree = _PackageSampler(sampler)
            self._held = _Held(values, sampler, tree, textures, parameters)

        @property
        def nested(self) -> Any:
            """Where the values come from."""
            return self._held.nested

        @property
        def sampler(self) -> AnySampler:
            """Where the directions come from."""
            return self._held.sampler

        def _member(self, si: Any, active: Any) -> Tuple[Any, ...]:
            """Of a family the values of its parameters at points of the surface."""
            textures = self._held.textures
            return textures.at(si, active) if textures else ()

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
            wo, tree, at = dr.detach(si.wi), self._held.tree, self._member(si, active)
            if self._exact:
                wi, pdf = tree.sample_exact(wo, sample1, sample2, self._target(context, si), active, at)
            else:
                wi, pdf = tree.sample(wo, sample1, sample2, active, self._monotone, at)
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
            known, drawn, tree, at = dr.detach(si.wi), dr.detach(wo), self._held.tree, self._member(si, active)
            if self._exact:
                return tree.pdf_exact(known, drawn, self._target(context, si)(drawn, active), active, at)
            return tree.pdf(known, drawn, active, at)

        def eval_pdf(self, context: Any, si: Any, wo: Any, active: Any = True) -> Tuple[Any, Any]:
            if not self._exact:
                return self.eval(context, si, wo, active), self.pdf(context, si, wo, active)
            values = self.eval(context, si, wo, active)
            z = dr.maximum(dr.detach(wo.z), 1e-12)
            t = dr.sqrt(dr.squared_norm(dr.detach(values))) * (self._scale / z)
            return values, self._held.tree.pdf_exact(dr.detach(si.wi), dr.detach(wo), t, active,
                                                     self._member(si, active))

        def parameters_changed(self, keys: Any = ()) -> None:
            """One-shot mode stays right with a sampler of other parameters, only noisier; exact mode does not. A
            family follows its textures as long as they stay in its ranges."""
            textures = self._held.textures
            if textures:
                textures.check()
            if self._exact and not (isinstance(textures, VariedTextures) and self._held.parameters == parameters_of(
                    Surface(mi, dr, self.nested, textures))):
                self.rebuild()

        def rebuild(self) -> None:
            """The sampler again, for the parameters that the nested BSDF has now."""
            if isinstance(self.nested, mi.BSDF):
                self._hold(self.nested, *_wrapped(self.nested, self._texts))

        def traverse(self, callback: Any) -> None:
            if isinstance(self.nested, mi.BSDF):
                callback.put("nested", self.nested, mi.ParamFlags.Differentiable)
            elif self._held.textures:
                for name, texture in self._held.textures.of.items():
                    if not isinstance(texture, float):
                        callback.put(name, texture, mi.ParamFlags.Differentiable)

        def to_string(self) -> str:
            return f"Reflectree[\n  nested = {self.nested},\n  sampler = {self.sampler}\n]"

    return Reflectree


def _parameters(props: Any) -> Tuple[Dict[str, str], List[Any], Dict[str, Any]]:
    """Texts by name, nested BSDFs, and textures and numbers by name."""
    if mi.is_polarized:
        raise Error("the variant is polarized, and samplers are of intensities", "reflectree", "use another variant")
    if mi.Float is not mi.Float32 and dr.is_jit_v(mi.Float):
        raise Error("the variant is of double precision, and tables are of single", "reflectree", "use another variant")
    nested, given, texts = [], {}, {"uniforms": "alias", "mode": "one-shot"}
    for key in props.keys():
        value = props[key]
        if isinstance(value, mi.BSDF):
            nested.append(value)
        elif key in PARAMETERS:
            texts[key] = str(value)
        elif isinstance(value, (mi.Texture, float, int)) and not isinstance(value, bool):
            given[key] = value if isinstance(value, mi.Texture) else float(value)
        else:
            raise _no_parameter(key)
    if given and nested:
        raise _no_parameter(next(iter(given)))
    if "family" in texts and not nested:
        raise Error("family names a parameter of a nested BSDF, and there is none", "reflectree",
                    "nest a BSDF; a material says its ranges in its text, as in ggx:alpha=0.02..1")
    for key, choices in (("uniforms", ("alias", "monotone")), ("mode", ("one-shot", "exact"))):
        if texts[key] not in choices:
            raise Error(f"{key} {texts[key]!r} is none", "reflectree", f"say {' or '.join(choices)}")
    functions = len(nested) + ("material" in texts) + ("file" in texts)
    if functions > 1 or (functions == 0 and "sampler" not in texts):
        raise Error(f"{functions} functions are given", "reflectree", "nest one BSDF, or give material, file or sampler")
    if texts["mode"] == "exact" and (not nested or "sampler" in texts or mi.is_spectral or not dr.is_jit_v(mi.Float)):
        raise Error("exact mode is there for nested BSDFs in LLVM variants of rgb and mono, with a sampler built here",
                    "reflectree", "leave mode out: one-shot mode serves all")
    return texts, nested, given


def _no_parameter(key: str) -> Error:
    return Error(f"it has no parameter {key!r}", "reflectree", f"say {', '.join(PARAMETERS)} or nest a BSDF")


def _of_ours(texts: Dict[str, str], given: Dict[str, Any]) -> Tuple[Any, AnySampler, Optional[Textures]]:
    """A material's values, its sampler, and of a family the textures of its parameters."""
    text = texts.get("material", texts.get("sampler", ""))
    if "file" not in texts and _core.names_family(text):
        return _family_of_ours(texts, given)
    if given:
        raise _no_parameter(next(iter(given)))
    if "file" in texts:
        f: Optional[Brdf] = load(texts["file"], texts.get("member", ""))
    else:
        f = material(texts["material"]) if "material" in texts else None
    if "sampler" in texts:
        sampler = load_sampler(texts["sampler"], f)
    else:
        assert f is not None
        found = f
        sampler = _built(lambda: Sampler(found))
    return _Ours(sampler.brdf, "reflectree"), sampler, None


def _family_of_ours(texts: Dict[str, str], given: Dict[str, Any]) -> Tuple[Any, AnySampler, Optional[Textures]]:
    if not dr.is_jit_v(mi.Float):
        raise Error("families are there in LLVM variants alone", "reflectree", "use another variant, or a material "
                    "without a range")
    if "sampler" in texts:
        sampler = load_family(texts["sampler"])
    else:
        sampler = _built(lambda: FamilySampler(texts["material"]))
    where = f"reflectree of {sampler.name}"
    for name in given:
        if name not in sampler.ranges:
            raise Error(f"it has no range of {name}", where, "give " + " and ".join(sampler.ranges))
    for name in sampler.ranges:
        if name not in given:
            raise Error(f"{name} is missing", where, "give it a texture or a number, beside the material")
    textures = Textures(mi, dr, {name: given[name] for name in sampler.ranges}, where)
    textures.ranges = sampler.ranges
    textures.check()
    return _Ours(sampler, "reflectree", textures), sampler, textures


def register(*variants: Any) -> None:
    """Registers the BSDF ``reflectree`` with the current variant; importing does so for all that are set later."""
    if mi.variant() is None:
        return
    made = _class()
    mi.register_bsdf("reflectree", lambda props: made(props))


register()
mi.detail.add_variant_callback(register)
