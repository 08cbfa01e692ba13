# SPDX-License-Identifier: Apache-2.0
"""The look-ups of a sampler over Dr.Jit arrays: the slab of a viewer, a leaf of its tree, a place in the leaf, the
albedo. Descents are loops."""

from __future__ import annotations

from typing import Any, List, NamedTuple, Tuple

import numpy as np

from ._arrays import Array
from ._drjit_packing import LEAF, cells, slab_grid, slab_tree, trees
from ._tables import AlbedoAxis, Tables

MIN_COS = 2.0**-17  # viewers closer to the horizon have no sample
Vector = Tuple[Any, Any, Any]
Rows = Tuple[Any, int, Tuple[Any, ...]]  # the first of four, their distance, their weights


class View(NamedTuple):
    """A viewer in the frame of the domain: y turned around where ``side`` is -1, then turned by an angle."""

    valid: Any
    o: Vector
    cosine: Any
    sine: Any
    side: Any
    phi_o: Any
    # Of families: the coordinates of the parameters, and the widths of the domain.
    at: Tuple[Any, ...] = ()
    widths: Tuple[Any, Any] = (1.0, 1.0)

    def leave(self, w: Vector) -> Vector:
        x, y = w[0], w[1] * self.side
        return x * self.cosine - y * self.sine, x * self.sine + y * self.cosine, w[2]

    def enter(self, w: Vector) -> Vector:
        x, y = w[0] * self.cosine + w[1] * self.sine, w[1] * self.cosine - w[0] * self.sine
        return x, y * self.side, w[2]


class Library:
    """Dr.Jit with the types of one variant of Mitsuba."""

    def __init__(self, mi: Any, dr: Any) -> None:
        self.mi, self.dr = mi, dr

    def floats(self, values: Array) -> Any:
        return self._kept(self.mi.Float(np.ascontiguousarray(values, dtype=np.float32).reshape(-1)))

    def words(self, values: Array) -> Any:
        return self._kept(self.mi.UInt32(np.ascontiguousarray(values, dtype=np.uint32).reshape(-1)))

    def _kept(self, buffer: Any) -> Any:
        self.dr.eval(buffer)
        return buffer

    def as_float(self, word: Any) -> Any:
        return self.dr.reinterpret_array(self.mi.Float, word)

    def as_word(self, number: Any) -> Any:
        return self.dr.reinterpret_array(self.mi.UInt32, self.mi.Float(number))


class CosineLookup:
    """Finds the interval of ascending cosines that holds c, by the bits of c (cosine_lookup.hpp): a guide has the
    interval of the first c of each entry, and the border above it."""

    def __init__(self, lib: Library, borders: Array) -> None:
        self._lib = lib
        self.single = len(borders) <= 2
        base, one = (int(np.float32(c).view(np.uint32)) for c in (MIN_COS, 1.0))
        for shift in range(18, 14, -1):
            entries = np.arange(((one - base) >> shift) + 2, dtype=np.uint32)
            first = (np.uint32(base) + (entries << np.uint32(shift))).astype(np.uint32).view(np.float32)
            at = np.clip(np.searchsorted(borders, first, side="right") - 1, 0, len(borders) - 2)
            steps = int(np.max(at[1:] - at[:-1]))
            if steps <= 1:
                break
        self._base, self._shift, self._steps = base, shift, steps
        at = at[:-1].astype(np.uint32)
        self._guide = lib.words(np.stack([at, borders[at + 1].astype(np.float32).view(np.uint32)], axis=1))
        self._borders = lib.floats(borders) if steps > 1 else None

    def __call__(self, c: Any, active: Any) -> Any:
        lib, dr, mi = self._lib, self._lib.dr, self._lib.mi
        if self.single:
            return mi.UInt32(0)
        c = dr.clip(c, MIN_COS, 1)
        entry = dr.gather(mi.Vector2u, self._guide, (lib.as_word(c) - self._base) >> self._shift, active)
        i = entry.x + dr.select(lib.as_float(entry.y) <= c, mi.UInt32(1), mi.UInt32(0))
        for _ in range(self._steps - 1):
            i += dr.select(dr.gather(mi.Float, self._borders, i + 1, active) <= c, mi.UInt32(1), mi.UInt32(0))
        return i


class BorderLookup:
    """How many of ascending borders are at or below x: equal cells know how many lie before them."""

    def __init__(self, lib: Library, borders: Array, low: float, high: float) -> None:
        self._lib, self._low = lib, low
        self.none = len(borders) == 0
        for bits in range(4, 13):
            ends = np.linspace(low, high, 2**bits + 1)
            # A cell more at both ends, for what rounding puts into its neighbour.
            before = np.searchsorted(borders, ends - (high - low) * 1e-6, side="right")
            steps = int(np.max(np.searchsorted(borders, ends[1:] + (high - low) * 1e-6, side="right") - before[:-1],
                               initial=0))
            if steps <= 1:
                break
        self._per_unit, self._last, self._steps = 2**bits / (high - low), 2**bits - 1, steps
        self._guide = lib.words(before[:-1])
        self._borders = lib.floats(np.append(borders, np.float32(3e38)))

    def __call__(self, x: Any, active: Any) -> Any:
        dr, mi = self._lib.dr, self._lib.mi
        if self.none:
            return mi.UInt32(0)
        cell = dr.minimum(mi.UInt32(dr.maximum((x - self._low) * self._per_unit, 0)), mi.UInt32(self._last))
        i = dr.gather(mi.UInt32, self._guide, cell, active)
        for _ in range(self._steps):
            i += dr.select(dr.gather(mi.Float, self._borders, i, active) <= x, mi.UInt32(1), mi.UInt32(0))
        return i


class SlabGrid:
    """The slab of a family's viewer and member, by the borders of every coordinate."""

    def __init__(self, lib: Library, tables: Tables) -> None:
        grid = slab_grid(tables)
        self._lib, self._shape = lib, grid.slabs.shape
        self._cosines = CosineLookup(lib, grid.cosines)
        spans = [(p.lowest, p.highest) for p in tables.parameters]
        if len(grid.borders) > len(spans):
            spans.insert(0, (0.0, 6.2831855))
        self._others = [BorderLookup(lib, b, *span) for b, span in zip(grid.borders, spans)]
        self._slabs = lib.words(grid.slabs)

    def __call__(self, view: View, active: Any) -> Any:
        cell = self._cosines(view.o[2], active)
        known = view.at if view.phi_o is None else (view.phi_o, *view.at)
        for look_up, x, count in zip(self._others, known, self._shape[1:]):
            cell = cell * count + look_up(x, active)
        return self._lib.dr.gather(self._lib.mi.UInt32, self._slabs, cell, active)


class Forest:
    """The trees of one mode."""

    def __init__(self, lib: Library, tables: Tables, density: bool) -> None:
        self._lib = lib
        slabs, leaves = tables.slabs, tables.leaves
        self._half = tables.half
        self._lookup = CosineLookup(lib, tables.borders) if len(tables.borders) else None
        self._grid = SlabGrid(lib, tables) if tables.parameters else None
        if self._lookup is None and self._grid is None:
            self._slab_tree = lib.words(slab_tree(tables))
        slab = np.zeros((len(slabs), 4), np.uint32)
        slab[:, 0], slab[:, 1] = slabs["first"], slabs["count"]
        if density:
            packed = trees(tables)
            slab[:, 2] = packed.roots
            self._splits = lib.words(np.stack([packed.splits, packed.words], axis=1))
            self._lowers = lib.words(np.stack([packed.lowers, packed.words], axis=1))
            self._bits_x, self._bits_y, self._guide = packed.bits_x, packed.bits_y, lib.words(packed.guide)
        self._slabs = lib.words(slab)
        # Of the alias table thresholds are shares of a bucket in 32 bits, and aliases count from the first slab.
        capacity = np.repeat(slabs["bucket"], slabs["count"]).astype(np.float64)
        first = np.repeat(slabs["first"], slabs["count"])
        share = np.minimum(leaves["threshold"] / capacity * 2.0**32, 2.0**32 - 1)
        self._alias = lib.words(np.stack([share.astype(np.uint32), leaves["alias"] + first], axis=1))
        self._cells = lib.floats(cells(tables))

    def slab_index(self, view: View, active: Any) -> Any:
        if self._grid is not None:
            return self._grid(view, active)
        return self._lookup(view.o[2], active) if self._lookup is not None else self._in_slab_tree(view, active)

    def slab(self, view: View, active: Any) -> Any:
        """Its first leaf, their number, its root."""
        return self._lib.dr.gather(self._lib.mi.Vector4u, self._slabs, self.slab_index(view, active), active)

    def _in_slab_tree(self, view: View, active: Any) -> Any:
        lib, dr, mi = self._lib, self._lib.dr, self._lib.mi
        c, phi = view.o[2], view.phi_o

        def body(i: Any, split: Any, word: Any) -> Tuple[Any, Any, Any]:
            upper = dr.select((word & 3) == 0, c <= split, phi >= split)
            i = dr.select(upper, word >> 2, i + 1)
            node = dr.gather(mi.Vector2u, self._slab_tree, i, active)
            return i, lib.as_float(node.x), node.y

        root = dr.gather(mi.Vector2u, self._slab_tree, mi.UInt32(0), active)
        _, _, word = dr.while_loop((mi.UInt32(0), lib.as_float(root.x), root.y),
                                   lambda i, split, word: active & ((word & 3) != LEAF), body, label="slab")
        return word >> 2

    def choose(self, slab: Any, word: Any, active: Any) -> Any:
        """A leaf in proportion to its mass, by the alias table, from 32 random bits."""
        dr, mi = self._lib.dr, self._lib.mi
        own = slab.x + dr.mul_hi(word, slab.y)
        bucket = dr.gather(mi.Vector2u, self._alias, own, active)
        return dr.select(word * slab.y < bucket.x, own, bucket.y)

    def descend(self, slab: Any, ux: Any, uy: Any, active: Any) -> Tuple[Any, Any, Any]:
        """The leaf that two uniforms lead to, and uniforms in it: monotone."""
        lib, dr, mi = self._lib, self._lib.dr, self._lib.mi

        def body(i: Any, lower: Any, word: Any, ux: Any, uy: Any) -> Tuple[Any, ...]:
            along_x = (word & 3) == 1
            u = dr.select(along_x, ux, uy)
            upper = u >= lower
            u = dr.minimum(dr.select(upper, (u - lower) / (1 - lower), u / lower), 1)
            ux, uy = dr.select(along_x, u, ux), dr.select(along_x, uy, u)
            i = dr.select(upper, word >> 2, i + 1)
            node = dr.gather(mi.Vector2u, self._lowers, i, active)
            return i, lib.as_float(node.x), node.y, ux, uy

        root = dr.gather(mi.Vector2u, self._lowers, slab.z, active)
        _, _, word, ux, uy = dr.while_loop(
            (slab.z, lib.as_float(root.x), root.y, ux, uy),
            lambda i, lower, word, ux, uy: active & ((word & 3) != LEAF), body, label="descent")
        return word >> 2, ux, uy

    def locate(self, slab: Any, px: Any, py: Any, active: Any) -> Any:
        """The leaf that holds a point of the square, by a guide and a descent; of a slab by its index."""
        lib, dr, mi = self._lib, self._lib.dr, self._lib.mi

        def body(i: Any, split: Any, word: Any) -> Tuple[Any, Any, Any]:
            upper = dr.select((word & 3) == 1, px, py) >= split
            i = dr.select(upper, word >> 2, i + 1)
            node = dr.gather(mi.Vector2u, self._splits, i, active)
            return i, lib.as_float(node.x), node.y

        x, y = px * 0.5 + 0.5, py if self._half else py * 0.5 + 0.5
        across, along = 2**self._bits_x, 2**self._bits_y
        column = dr.minimum(mi.UInt32(dr.maximum(x * across, 0)), mi.UInt32(across - 1))
        line = dr.minimum(mi.UInt32(dr.maximum(y * along, 0)), mi.UInt32(along - 1))
        i = dr.gather(mi.UInt32, self._guide, (slab * along + line) * across + column, active)
        first = dr.gather(mi.Vector2u, self._splits, i, active)
        _, _, word = dr.while_loop((i, lib.as_float(first.x), first.y),
                                   lambda i, split, word: active & ((word & 3) != LEAF), body, label="location")
        return word >> 2

    def place(self, leaf: Any, ux: Any, uy: Any, active: Any) -> Tuple[Any, Any, Any]:
        """A point of a leaf in proportion to its shape, and the height there."""
        dr = self._lib.dr
        cell, shape = self._cell(leaf, active)
        tx, ty = _linear(dr, shape.x, ux), _linear(dr, shape.y, uy)
        height = shape.z * ((1 - shape.x) + 2 * shape.x * tx) * ((1 - shape.y) + 2 * shape.y * ty)
        return cell.x + cell.z * tx, cell.y + cell.w * ty, height

    def height(self, leaf: Any, px: Any, py: Any, active: Any) -> Any:
        dr = self._lib.dr
        cell, shape = self._cell(leaf, active)
        tx, ty = dr.clip((px - cell.x) / cell.z, 0, 1), dr.clip((py - cell.y) / cell.w, 0, 1)
        return shape.z * ((1 - shape.x) + 2 * shape.x * tx) * ((1 - shape.y) + 2 * shape.y * ty)

    def _cell(self, leaf: Any, active: Any) -> Tuple[Any, Any]:
        dr, mi = self._lib.dr, self._lib.mi
        return (dr.gather(mi.Vector4f, self._cells, 2 * leaf, active),
                dr.gather(mi.Vector4f, self._cells, 2 * leaf + 1, active))


class Albedo:
    """a(wo) of the target (albedo.hpp)."""

    def __init__(self, lib: Library, tables: Tables) -> None:
        self._lib = lib
        self._lookup = CosineLookup(lib, tables.albedo_borders)
        pieces = tables.albedo_pieces
        self._pieces = lib.floats(np.stack([pieces["base"], pieces["slope"]], axis=1))
        segments = tables.albedo_segments
        self._segment_count = len(segments)
        self._segments = lib.words(np.ascontiguousarray(segments).view(np.uint32)) if len(segments) else None
        self._borders = lib.floats(np.append(segments["phi_o"], 100)) if len(segments) else None
        self._axes, self._of_cosine = tables.albedo_axes, tables.albedo_row

    def __call__(self, view: View, active: Any) -> Any:
        lib, dr, mi = self._lib, self._lib.dr, self._lib.mi
        c = view.o[2]
        i = self._lookup(c, active)
        rows = [self._rows(axis, x) for axis, x in zip(self._axes, view.at)]
        if self._segments is not None:
            rows.append(self._azimuths(view, active))
        if not rows:
            piece = dr.gather(mi.Vector2f, self._pieces, i, active)
            return piece.x + piece.y * c
        return dr.maximum(self._sum(rows, i * self._of_cosine, 1, c, active), 0)

    def _sum(self, rows: List[Rows], at: Any, weight: Any, c: Any, active: Any) -> Any:
        """Over four rows of every axis."""
        dr, mi = self._lib.dr, self._lib.mi
        if not rows:
            piece = dr.gather(mi.Vector2f, self._pieces, at, active)
            return weight * (piece.x + piece.y * c)
        first, stride, weights = rows[0]
        sum_ = mi.Float(0)
        for n, w in enumerate(weights):
            sum_ = sum_ + self._sum(rows[1:], at + (first + n) * stride, weight * w, c, active)
        return sum_

    def _rows(self, axis: AlbedoAxis, at: Any) -> Rows:
        dr, mi = self._lib.dr, self._lib.mi
        x = dr.clip((at - axis.low) * axis.rows_per_unit, 0, axis.rows - 1)
        first = dr.minimum(mi.UInt32(x), mi.UInt32(axis.rows - 2))
        return first, axis.stride, _cubic(x - mi.Float(first))

    def _azimuths(self, view: View, active: Any) -> Rows:
        lib, dr, mi = self._lib, self._lib.dr, self._lib.mi
        k = mi.UInt32(0)
        for half in reversed([2**b for b in range(self._segment_count.bit_length())]):  # the last that begins before
            at = dr.minimum(k + half, mi.UInt32(self._segment_count))
            k = dr.select(dr.gather(mi.Float, self._borders, at, active) <= view.phi_o, at, k)
        segment = dr.gather(mi.Vector4u, self._segments, k, active)
        x = dr.maximum((view.phi_o - lib.as_float(segment.x)) * lib.as_float(segment.y), 0)
        line = dr.minimum(mi.UInt32(x), segment.w)
        return segment.z + line, 1, _cubic(x - mi.Float(line))


def _cubic(t: Any) -> Tuple[Any, ...]:
    """The weights of equidistant values at -1, 0, 1, 2 in the cubic through them (cubic_weights of albedo.hpp)."""
    return (-t * (t - 1) * (t - 2) / 6, (t + 1) * (t - 1) * (t - 2) / 2, -(t + 1) * t * (t - 2) / 2,
            (t + 1) * t * (t - 1) / 6)


def _linear(dr: Any, slope: Any, u: Any) -> Any:
    """From 1 + g s, s in [-1, 1], by its inverse CDF, as (s + 1) / 2."""
    a = 1 - slope
    return dr.minimum(2 * u / (a + dr.sqrt(dr.maximum(a * a + u * (4 * slope), 0))), 1)
