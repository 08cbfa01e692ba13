# SPDX-License-Identifier: Apache-2.0
"""Textures that vary the parameters of a BSDF inside Mitsuba: read at a point of the surface; and, to build a family,
set to a value for every lane of a wavefront.

A texture of Mitsuba is a tree whose leaves are bitmaps and uniform ones. A uniform leaf takes an array. A bitmap
becomes a ramp of 2 x 2 texels: between their centres it is linear in u, or in v for a second parameter, and the
coordinates choose its value."""

from __future__ import annotations

import contextlib
import threading
from typing import Any, Dict, Iterator, List, Optional, Sequence, Set, Tuple

import numpy as np

from ._arrays import Array
from ._error import Error

Ranges = Dict[str, Tuple[float, float]]
CHUNK = 1 << 22  # texels that are asked at once
ROUNDING = 1e-5  # of a range
BUILDING = threading.RLock()
CHANGED: Set[Any] = set()  # leaves that hold something else for a while


def parse_family(text: str, where: str) -> Dict[str, Optional[Tuple[float, float]]]:
    """``alpha=0.02..1`` or ``alpha``, one or two, divided by a comma: the names, and the ranges that are given."""
    found: Dict[str, Optional[Tuple[float, float]]] = {}
    for part in text.split(","):
        name, equals, span = (piece.strip() for piece in part.partition("="))
        ends = span.split("..")
        try:
            found[name] = (float(ends[0]), float(ends[1])) if equals else None
        except (ValueError, IndexError):
            raise Error(f"{part.strip()!r} is no range", where, "say family alpha=0.02..1, or family alpha") from None
    if "" in found or not 1 <= len(found) <= 2:
        raise Error(f"family {text!r} names no one or two parameters", where,
                    "say family alpha=0.02..1, or family alpha")
    return found


class Textures:
    """The textures of a family's parameters, by name; a number stands for itself."""

    def __init__(self, mi: Any, dr: Any, of: Dict[str, Any], where: str) -> None:
        self.mi, self.dr, self.of, self.where = mi, dr, of, where
        self.ranges: Ranges = {}

    def at(self, si: Any, active: Any) -> Tuple[Any, ...]:
        """The member at points of the surface, in the order of the ranges. What leaves its range, though check() has
        not seen it, is led back to the nearest one: of one-shot mode the density is then that of another member,
        and the weight is right all the same."""
        return tuple(self.dr.clip(value, float(np.float32(low)), float(np.float32(high)))
                     for value, (low, high) in zip(self.values(si, active), self.ranges.values()))

    def values(self, si: Any, active: Any) -> Tuple[Any, ...]:
        """The same, whatever the ranges."""
        si = self.dr.detach(si)
        return tuple(self._value(name, si, active) for name in self.ranges)

    def within(self, name: str, values: Array) -> Array:
        """Without the rounding that leaves the range; what is further off stays there."""
        low, high = self.ranges[name]
        inside = np.clip(values, np.float32(low), np.float32(high))
        kept: Array = np.where(np.abs(values - inside) <= ROUNDING * (high - low), inside, values)
        return kept

    def _value(self, name: str, si: Any, active: Any) -> Any:
        texture = self.of[name]
        return self.mi.Float(texture) if isinstance(texture, float) else self.dr.detach(texture.eval_1(si, active))

    def found(self, name: str) -> Tuple[float, float]:
        """The smallest value and the largest one of a texture."""
        texture = self.of[name]
        if isinstance(texture, float):
            return texture, texture
        nodes = list(self.mi.traverse(texture).hierarchy)
        leaves = [node for node in nodes if _is_bitmap(node) or _is_uniform(node)]
        # Others: themselves, at many places.
        ends = [self._ends(node) for node in leaves or [texture]]
        return min(low for low, _ in ends), max(high for _, high in ends)

    def _ends(self, texture: Any) -> Tuple[float, float]:
        mi, dr = self.mi, self.dr
        width, height, back = 512, 512, np.eye(3)
        if _is_bitmap(texture):
            width, height = (int(n) for n in texture.resolution())
            back = np.linalg.inv(np.array(mi.traverse(texture)["to_uv"].matrix, dtype=np.float64))
        elif _is_uniform(texture):
            width = height = 1
        low, high = np.inf, -np.inf
        rows = max(CHUNK // width, 1)
        for first in range(0, height, rows):
            x, y = np.meshgrid(np.arange(width), np.arange(first, min(first + rows, height)))
            u, v = (x.reshape(-1) + 0.5) / width, (y.reshape(-1) + 0.5) / height
            u, v, w = back @ np.stack([u, v, np.ones_like(u)])
            si = dr.zeros(mi.SurfaceInteraction3f, len(u))
            si.uv = mi.Point2f(_floats(mi, u / w), _floats(mi, v / w))
            values = np.asarray(dr.detach(texture.eval_1(si)), dtype=np.float64)
            low, high = min(low, float(values.min())), max(high, float(values.max()))
        return low, high

    def set_ranges(self, given: Dict[str, Optional[Tuple[float, float]]]) -> None:
        """Those that are given, or those of the textures, rounded outwards to two digits."""
        ranges: Ranges = {}
        for name, ends in given.items():
            if ends is None:
                low, high = self.found(name)
                if not low < high:
                    raise Error(f"{name} is {low:g} everywhere", self.where,
                                f"give a range, such as family {name}=0.02..1, or leave family out")
                ends = _rounded(low, -1), _rounded(high, 1)
            ranges[name] = ends
        self.ranges = ranges

    def check(self) -> None:
        """Raises Error where a texture leaves the range of its parameter."""
        for name, (low, high) in self.ranges.items():
            least, most = self.found(name)
            room = ROUNDING * (high - low)
            if not (least >= low - room and most <= high + room):
                raise Error(f"{name} goes from {least:g} to {most:g}, and the family from {low:g} to {high:g}",
                            self.where, "widen the range, or change the texture")

    def check_named(self, at: Dict[str, Any]) -> None:
        if set(at) != set(self.ranges):
            raise Error(f"the sampler is of {' and '.join(at)}, and family names {' and '.join(self.ranges)}", self.where,
                        "name the sampler's parameters")

    def check_served(self, ranges: Ranges, sampler: str) -> None:
        """Raises Error unless a sampler's ranges are those that were asked for."""
        if list(ranges) != list(self.ranges) or not np.allclose(list(ranges.values()), list(self.ranges.values()), 1e-6):
            text = ",".join(f"{name}={low:g}..{high:g}" for name, (low, high) in ranges.items())
            raise Error(f"the sampler is of {text}", sampler, f"say family {text}, or leave the sampler out")


class VariedTextures(Textures):
    """Those of a nested BSDF."""

    def __init__(self, mi: Any, dr: Any, bsdf: Any, names: Sequence[str], where: str) -> None:
        self._parameters = mi.traverse(bsdf)
        self._leaves = {name: _leaves_of(self._parameters, name, where) for name in names}
        super().__init__(mi, dr, {name: _texture_named(self._parameters, name, leaves[0])
                                  for name, leaves in self._leaves.items()}, where)
        self._nodes = {self._parameters.properties[key][2] for leaves in self._leaves.values() for key in leaves}
        self._tops: Dict[str, float] = {}
        self._is_varied = False

    def others(self) -> List[str]:
        """The keys of all other parameters of the BSDF."""
        return [key for key in self._parameters.keys()
                if not any(key.startswith(name + ".") for name in self._leaves)]

    @contextlib.contextmanager
    def varied(self) -> Iterator[None]:
        """In it, coordinates() chooses the values; after it all is as it was. One inside of another does nothing."""
        if self._is_varied:
            yield
            return
        with BUILDING:  # equal textures of a scene are one, and scenes are loaded by several threads
            if self._nodes & CHANGED:
                raise Error("its texture belongs to another family, too, which is being built at this moment", self.where,
                            "load the scene with parallel=False")
            CHANGED.update(self._nodes)
            self._is_varied = True
            try:
                with self._changed():
                    yield
            finally:
                self._is_varied = False
                CHANGED.difference_update(self._nodes)

    @contextlib.contextmanager
    def _changed(self) -> Iterator[None]:
        before: Dict[str, Any] = {}
        try:
            for axis, (name, (_, high)) in enumerate(self.ranges.items()):
                top = self._tops[name] = max(1.0, float(high))
                for key in self._leaves[name]:
                    before[key] = self._copy(key)
                    if key.endswith(".data"):
                        self._set(key, _ramp(before[key], top, axis))
                    elif key.endswith(".to_uv"):
                        self._set(key, type(before[key])())
                    else:
                        self._set(key, self.mi.Float(high))
                    self._parameters.set_dirty(key)
            self._parameters.update()
            yield
        finally:
            for key, value in before.items():
                self._set(key, value)
                self._parameters.set_dirty(key)
            self._parameters.update()

    def coordinates(self, at: Dict[str, Array]) -> Any:
        """Inside varied(): the texture coordinates at which the parameters have these values, and uniform leaves set
        to them."""
        mi = self.mi
        uv: List[Any] = [0.5, 0.5]
        for axis, name in enumerate(self.ranges):
            values = np.ascontiguousarray(at[name], dtype=np.float32)
            uv[axis] = 0.25 + 0.5 * values.astype(np.float64) / self._tops[name]
            for key in self._leaves[name]:
                if key.endswith(".value"):
                    self._set(key, _floats(mi, values))
        return mi.Point2f(*(_floats(mi, x) if isinstance(x, np.ndarray) else x for x in uv))

    def follows(self, at: Dict[str, Array], si: Any) -> None:
        """Raises Error unless the textures have taken these values, inside varied()."""
        for name, values in at.items():
            taken = np.asarray(self.of[name].eval_1(si), dtype=np.float64)
            if not np.allclose(np.broadcast_to(taken, len(values)), values, rtol=1e-4, atol=1e-6):
                raise Error(f"the texture of {name} cannot be set to given values: it is neither a bitmap with a linear "
                            "filter, nor uniform, nor a checkerboard of these, or another parameter has the same one", self.where,
                            "use such a texture; textures that are equal are one to Mitsuba, and must differ")

    def _copy(self, key: str) -> Any:
        value = self._parameters[key]
        return type(value)(value)

    def _set(self, key: str, value: Any) -> None:
        place, kind, _, _ = self._parameters.properties[key]
        self.mi.set_property(place, kind, value)


def _is_bitmap(node: Any) -> bool:
    return str(node.class_name()).startswith("BitmapTexture")


def _is_uniform(node: Any) -> bool:
    return str(node.class_name()) == "UniformSpectrum"


def _floats(mi: Any, values: Array) -> Any:
    return mi.Float(np.ascontiguousarray(values, dtype=np.float32))


def _rounded(value: float, way: int) -> float:
    """To two digits, downwards or upwards."""
    if value == 0:
        return 0.0
    unit = 10.0 ** (np.floor(np.log10(abs(value))) - 1)
    # A rounding above a multiple is that multiple.
    return float(f"{(np.floor(value / unit + 1e-4) if way < 0 else np.ceil(value / unit - 1e-4)) * unit:.6g}")


def _ramp(data: Any, top: float, axis: int) -> Any:
    """2 x 2 texels from 0 to top along an axis, as the tensor of a bitmap."""
    old = np.asarray(data)
    ramp = np.zeros((2, 2, old.shape[2]), old.dtype)
    ramp[(slice(None), 1) if axis == 0 else (1, slice(None))] = 255 * top if old.dtype == np.uint8 else top
    return type(data)(ramp)


def _leaves_of(parameters: Any, name: str, where: str) -> List[str]:
    keys = [key for key in parameters.keys() if key.startswith(name + ".")]
    if not keys:
        known = sorted({key.rpartition(".")[0] for key in parameters.keys() if key.endswith((".data", ".value"))})
        if name in parameters.keys():
            raise Error(f"its {name} is one number, not a texture", where, "vary one of " + ", ".join(known))
        raise Error(f"it has no parameter {name}", where, "vary one of " + ", ".join(known))
    leaves = [key for key in keys if _is_bitmap(parameters.properties[key][2]) or key.endswith(".value")]
    if not any(key.endswith((".data", ".value")) for key in leaves):
        raise Error(f"the texture of {name} is neither a bitmap, nor uniform, nor a checkerboard of these", where,
                    "use such a texture, or nest a BSDF without textures")
    return leaves


def _texture_named(parameters: Any, name: str, leaf: str) -> Any:
    """The texture that the BSDF calls by this name, from a key below it."""
    node, path = parameters.properties[leaf][2], leaf.rpartition(".")[0]
    while path != name:
        node, path = parameters.hierarchy[node][0], path.rpartition(".")[0]
    return node
