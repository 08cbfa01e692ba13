# SPDX-License-Identifier: Apache-2.0
"""Samplers over Dr.Jit arrays: tables become buffers, descents become loops. The C99 runtime of one file is the
specification; it says the same, one direction at a time."""

from __future__ import annotations

from typing import Any, Callable, List, NamedTuple, Optional, Tuple

import numpy as np

from ._arrays import Array
from ._drjit_domain import domain_of
from ._tables import Tables

MIN_COS = 2.0**-17  # viewers closer to the horizon have no sample
MAX_TRIALS = 256
LEAF = 2  # the axis of what is no inner node
Vector = Tuple[Any, Any, Any]


class View(NamedTuple):
    """A viewer in the frame of the domain: y turned around where ``side`` is -1, then turned by an angle."""

    valid: Any
    o: Vector
    cosine: Any
    sine: Any
    side: Any
    phi_o: Any

    def leave(self, w: Vector) -> Vector:
        x, y = w[0], w[1] * self.side
        return x * self.cosine - y * self.sine, x * self.sine + y * self.cosine, w[2]

    def enter(self, w: Vector) -> Vector:
        x, y = w[0] * self.cosine + w[1] * self.sine, w[1] * self.cosine - w[0] * self.sine
        return x, y * self.side, w[2]


class CosineLookup:
    """Finds the interval of ascending cosines that holds c, by the bits of c (cosine_lookup.hpp): a guide has the
    interval of the first c of each entry, and the border above it."""

    def __init__(self, lib: "Library", borders: Array) -> None:
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


class Forest:
    """The trees of one mode."""

    def __init__(self, lib: Library, tables: Tables, density: bool) -> None:
        self._lib = lib
        slabs, leaves = tables.slabs, tables.leaves
        self._half = tables.half
        self._lookup = CosineLookup(lib, tables.borders) if len(tables.borders) else None
        if self._lookup is None:
            self._slab_tree = lib.words(_slab_tree(tables))
        slab = np.zeros((len(slabs), 4), np.uint32)
        slab[:, 0], slab[:, 1] = slabs["first"], slabs["count"]
        if density:
            trees = _trees(tables)
            slab[:, 2] = trees.roots
            self._splits = lib.words(np.stack([trees.splits, trees.words], axis=1))
            self._lowers = lib.words(np.stack([trees.lowers, trees.words], axis=1))
            self._bits_x, self._bits_y, self._guide = trees.bits_x, trees.bits_y, lib.words(trees.guide)
        self._slabs = lib.words(slab)
        # Of the alias table thresholds are shares of a bucket in 32 bits, and aliases count from the first slab.
        capacity = np.repeat(slabs["bucket"], slabs["count"]).astype(np.float64)
        first = np.repeat(slabs["first"], slabs["count"])
        share = np.minimum(leaves["threshold"] / capacity * 2.0**32, 2.0**32 - 1)
        self._alias = lib.words(np.stack([share.astype(np.uint32), leaves["alias"] + first], axis=1))
        self._cells = lib.floats(_cells(tables))

    def slab_index(self, view: View, active: Any) -> Any:
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
        self._row = len(tables.albedo_borders) - 1
        segments = tables.albedo_segments
        self._segment_count = len(segments)
        self._segments = lib.words(np.ascontiguousarray(segments).view(np.uint32)) if len(segments) else None
        self._borders = lib.floats(np.append(segments["phi_o"], 100)) if len(segments) else None

    def __call__(self, view: View, active: Any) -> Any:
        lib, dr, mi = self._lib, self._lib.dr, self._lib.mi
        c = view.o[2]
        i = self._lookup(c, active)
        if self._segments is None:
            piece = dr.gather(mi.Vector2f, self._pieces, i, active)
            return piece.x + piece.y * c
        k = mi.UInt32(0)
        for half in reversed([2**b for b in range(self._segment_count.bit_length())]):  # the last that begins before
            at = dr.minimum(k + half, mi.UInt32(self._segment_count))
            k = dr.select(dr.gather(mi.Float, self._borders, at, active) <= view.phi_o, at, k)
        segment = dr.gather(mi.Vector4u, self._segments, k, active)
        x = dr.maximum((view.phi_o - lib.as_float(segment.x)) * lib.as_float(segment.y), 0)
        line = dr.minimum(mi.UInt32(x), segment.w)
        t = x - mi.Float(line)
        sum_ = mi.Float(0)
        for n, weight in enumerate((-t * (t - 1) * (t - 2) / 6, (t + 1) * (t - 1) * (t - 2) / 2,
                                    -(t + 1) * t * (t - 2) / 2, (t + 1) * t * (t - 1) / 6)):
            piece = dr.gather(mi.Vector2f, self._pieces, (segment.z + line + n) * self._row + i, active)
            sum_ = sum_ + weight * (piece.x + piece.y * c)
        return dr.maximum(sum_, 0)


class DrJitSampler:
    """Directions and densities over arrays. Ours are the names: ``wo`` is known, ``wi`` is drawn. With the tables of
    exact mode that is there, too."""

    def __init__(self, mi: Any, dr: Any, tables: Tables, exact: Optional[Tables] = None) -> None:
        self._lib = Library(mi, dr)
        self._tables = tables
        self._domain = domain_of(dr, tables)
        self._one_shot = Forest(self._lib, tables, True)
        if exact is not None:
            self._exact = Forest(self._lib, exact, False)
            self._albedo = Albedo(self._lib, exact)

    def sample(self, wo: Vector, u1: Any, u2: Tuple[Any, Any], active: Any, monotone: bool) -> Tuple[Vector, Any]:
        """wi and its density per solid angle, 0 for no sample. ``monotone``: a descent from u2 alone, which keeps
        stratified points stratified; else u1 chooses the leaf by alias table."""
        dr = self._lib.dr
        view = self.view(wo)
        active = active & view.valid
        slab = self._one_shot.slab(view, active)
        (ux, uy), below = self._unfolded(u2)
        if monotone:
            leaf, ux, uy = self._one_shot.descend(slab, ux, uy, active)
        else:
            leaf = self._one_shot.choose(slab, self._word(u1, u2), active)
        wi, area, height = self._placed(self._one_shot, view, leaf, ux, uy, below, active)
        return view.leave(wi), dr.select(active, height / area * wi[2], 0)

    def _unfolded(self, u2: Tuple[Any, Any]) -> Tuple[Tuple[Any, Any], Any]:
        """Uniforms for the square and, of half squares, the coin for the side of wi.y: continuous across the plane of
        incidence."""
        dr = self._lib.dr
        ux, uy = u2
        if not self._domain.half:
            return (ux, uy), None
        below = uy < 0.5
        return (ux, dr.select(below, 1 - 2 * uy, 2 * uy - 1)), below

    def _placed(self, forest: Forest, view: View, leaf: Any, ux: Any, uy: Any, below: Any,
                active: Any) -> Tuple[Vector, Any, Any]:
        px, py, height = forest.place(leaf, ux, uy, active)
        if self._domain.half:
            py = self._lib.dr.select(below, -py, py)
        return (*self._domain.lift(view.o, px, py), height)

    def sample_exact(self, wo: Vector, u1: Any, u2: Tuple[Any, Any], target: Callable[[Vector, Any], Any],
                     active: Any) -> Tuple[Vector, Any]:
        """wi in proportion to the target times cos theta_i, and the density. The first trial is made of the uniforms,
        later ones of a generator that they seed; ``target(wi, active)`` is evaluated at each, without the cosine."""
        lib, dr, mi = self._lib, self._lib.dr, self._lib.mi
        view = self.view(wo)
        active = active & view.valid
        albedo = self._albedo(view, active)
        active = active & (albedo > 0)
        slab = self._exact.slab(view, active)
        first = self._word(u1, u2)
        random = mi.PCG32(initstate=mi.UInt64(first), initseq=mi.UInt64(lib.as_word(u2[0])))
        zero = dr.zeros(mi.Float, dr.width(first))

        def body(going: Any, trial: Any, word: Any, ux: Any, uy: Any, random: Any, x: Any, y: Any, z: Any,
                 t: Any) -> Tuple[Any, ...]:
            (vx, vy), below = self._unfolded((ux, uy))
            leaf = self._exact.choose(slab, word, going)
            wi, area, majorant = self._placed(self._exact, view, leaf, vx, vy, below, going)
            w = view.leave(wi)
            found = target(w, going)
            taken = random.next_float32() * (majorant * albedo) < found * area
            x, y, z = dr.select(taken, w[0], x), dr.select(taken, w[1], y), dr.select(taken, w[2], z)
            trial += 1
            return (going & ~taken & (trial < MAX_TRIALS), trial, random.next_uint32(), random.next_float32(),
                    random.next_float32(), random, x, y, z, dr.select(taken, found, t))

        _, _, _, _, _, _, x, y, z, t = dr.while_loop(
            (mi.Bool(active), mi.UInt32(0), first, mi.Float(u2[0]), mi.Float(u2[1]), random, zero, zero, zero, zero),
            lambda going, *_: going, body, label="trials")
        return (x, y, z), dr.select(active & (t > 0), t * z / albedo, 0)

    def pdf_exact(self, wo: Vector, wi: Vector, t: Any, active: Any) -> Any:
        """Per solid angle, from the target at wi."""
        view = self.view(wo)
        active = active & view.valid & (wi[2] > 0)
        albedo = self._albedo(view, active)
        return self._lib.dr.select(active & (albedo > 0), t * wi[2] / albedo, 0)

    def pdf(self, wo: Vector, wi: Vector, active: Any) -> Any:
        """Per solid angle; 0 where a direction is below the surface."""
        dr = self._lib.dr
        view = self.view(wo)
        active = active & view.valid & (wi[2] > 0)
        w = view.enter(wi)
        if self._domain.half:
            w = (w[0], dr.abs(w[1]), w[2])
        px, py = self._domain.lower(view.o, w)
        slab = self._one_shot.slab_index(view, active)
        leaf = self._one_shot.locate(slab, px, py, active)
        height = self._one_shot.height(leaf, px, py, active)
        lifted, area = self._domain.lift(view.o, px, py)
        return dr.select(active, height / area * lifted[2], 0)

    def _word(self, u1: Any, u2: Tuple[Any, Any]) -> Any:
        """32 bits: the 23 that a renderer's number has, and below them a hash of the other numbers', so that a leaf
        whose mass is no multiple of 2^-23 has its own."""
        lib, dr, mi = self._lib, self._lib.dr, self._lib.mi
        high = dr.minimum(mi.UInt32(u1 * 2.0**23), mi.UInt32(2**23 - 1))
        h = (lib.as_word(u2[0]) * mi.UInt32(0x9E3779B1)) ^ (lib.as_word(u2[1]) * mi.UInt32(0x85EBCA6B)) ^ high
        h = (h ^ (h >> 15)) * mi.UInt32(0x2C1B3C6D)
        h = (h ^ (h >> 12)) * mi.UInt32(0x297A2D39)
        return (high << 9) | (h >> 23)

    def view(self, wo: Vector) -> View:
        """incidence.hpp and incidence.cpp."""
        dr, mi, tables = self._lib.dr, self._lib.mi, self._tables
        x, y, z = wo
        s2 = x * x + y * y
        valid = (z >= MIN_COS) & (dr.abs(s2 + z * z - 1) <= 1e-3)
        z = dr.minimum(z, 1)
        sine = dr.sqrt(s2)
        inverse = dr.select(sine > 0, 1 / sine, 0)
        if tables.symmetry == "isotropic":
            cosine = dr.select(sine > 0, x * inverse, 1)
            return View(valid, (sine, 0, z), cosine, y * inverse, 1, None)
        ca, sa = tables.cos_axis, tables.sin_axis
        x, y = x * ca + y * sa, y * ca - x * sa
        half_turn, mirrored = mi.Float(1), mi.Float(1)
        if tables.symmetry == "two mirror planes":
            half_turn = dr.select(x < 0, mi.Float(-1), 1)
        if tables.symmetry == "half turn":
            half_turn = dr.select(y < 0, mi.Float(-1), 1)
        x, y = x * half_turn, y * half_turn
        if tables.symmetry in ("two mirror planes", "one mirror plane"):
            mirrored = dr.select(y < 0, mi.Float(-1), 1)
        y = y * mirrored
        phi = dr.atan2(y, x)
        phi = dr.select(phi < 0, phi + 2 * dr.pi, phi)
        cosine, sine_axis = ca * half_turn, sa * half_turn
        if not tables.turns:
            return View(valid, (x, y, z), cosine, sine_axis, mirrored, phi)
        c, s = dr.select(sine > 0, x * inverse, 1), y * inverse * mirrored
        return View(valid, (sine, 0, z), cosine * c - sine_axis * s, sine_axis * c + cosine * s, mirrored, phi)


def _linear(dr: Any, slope: Any, u: Any) -> Any:
    """From 1 + g s, s in [-1, 1], by its inverse CDF, as (s + 1) / 2."""
    a = 1 - slope
    return dr.minimum(2 * u / (a + dr.sqrt(dr.maximum(a * a + u * (4 * slope), 0))), 1)


def _cells(tables: Tables) -> Array:
    """x, y, width, length, slope_x, slope_y, height of every leaf, and one number to spare."""
    leaves = tables.leaves
    cells = np.zeros((len(leaves), 8), np.float32)
    cells[:, 0] = (leaves["x"].astype(np.float64) - 0x4000) * 2.0**-14
    cells[:, 2] = 2.0 ** (1 - leaves["level_x"].astype(np.float64))
    if tables.half:
        cells[:, 1] = leaves["y"] * 2.0**-15
        cells[:, 3] = 2.0 ** -leaves["level_y"].astype(np.float64)
    else:
        cells[:, 1] = (leaves["y"].astype(np.float64) - 0x4000) * 2.0**-14
        cells[:, 3] = 2.0 ** (1 - leaves["level_y"].astype(np.float64))
    cells[:, 4], cells[:, 5] = leaves["slope_x"] / 128, leaves["slope_y"] / 128
    cells[:, 6] = leaves["height"]
    return cells


class _Trees(NamedTuple):
    """Whole trees in preorder. Of a node the place of its cut, the share below, and a word: of an inner node its upper
    child and the axis (1 is x), of a leaf its number and LEAF. The lower child follows at once. The guide has, for
    each cell of a grid over each slab's square, the smallest node around it."""

    roots: Array
    splits: Array
    lowers: Array
    words: Array
    bits_x: int
    bits_y: int
    guide: Array


def _trees(tables: Tables) -> _Trees:
    count = 2 * len(tables.leaves) - len(tables.slabs)
    splits, lowers, words = np.zeros(count, np.float32), np.zeros(count, np.float32), np.zeros(count, np.uint32)
    roots = np.zeros(len(tables.slabs), np.uint32)
    # Eight cells for a leaf, four times as many along y, the radius, which is refined most.
    bits = min(max(3 + int(np.ceil(np.log2(len(tables.leaves) / len(tables.slabs)))), 4), 14)
    bits_x = max((bits - 2) // 2, 0)
    bits_y = bits - bits_x
    across, along = 2**bits_x, 2**bits_y
    guide = np.zeros((len(tables.slabs), along, across), np.uint32)
    shares, packed = tables.nodes["lower"], tables.nodes["lower_leaves_split_x"].tolist()
    y0 = 0.0 if tables.half else -1.0
    at = 0
    for k, (first, leaves, node, _, _) in enumerate(tables.slabs.tolist()):
        roots[k] = at
        leaf = first
        grid = guide[k]
        open_nodes = [(leaves, 0.0, 1.0, 0.0, 1.0)]  # start and size along each axis, of the square's unit
        while open_nodes:
            n, x, width, y, length = open_nodes.pop()
            if width * across >= 1 and length * along >= 1:
                grid[int(y * along):int((y + length) * along), int(x * across):int((x + width) * across)] = at
            if n == 1:
                words[at] = leaf << 2 | LEAF
                leaf += 1
            else:
                lower, along_x = packed[node] & 0x7FFFFFFF, packed[node] >> 31
                words[at] = (at + 2 * lower) << 2 | along_x
                lowers[at] = shares[node]
                node += 1
                if along_x:
                    width /= 2
                    splits[at] = 2 * (x + width) - 1
                    open_nodes += [(n - lower, x + width, width, y, length), (lower, x, width, y, length)]
                else:
                    length /= 2
                    splits[at] = y0 + (1 - y0) * (y + length)
                    open_nodes += [(n - lower, x, width, y + length, length), (lower, x, width, y, length)]
            at += 1
    return _Trees(roots, splits.view(np.uint32), lowers.view(np.uint32), words, bits_x, bits_y, guide)


def _slab_tree(tables: Tables) -> Array:
    """In preorder the cut, a cosine or an azimuth, and a word as above; the axis of a cosine is 0."""
    nodes = np.zeros((len(tables.partition_axis), 2), np.uint32)
    splits = iter(tables.partition_split)
    open_uppers: List[int] = []
    slab = 0
    for at, axis in enumerate(tables.partition_axis.tolist()):
        if axis == 255:
            nodes[at, 1] = slab << 2 | LEAF
            slab += 1
            if open_uppers:
                parent = open_uppers.pop()
                nodes[parent, 1] |= (at + 1) << 2
        else:
            split = np.float32(next(splits))
            nodes[at] = (np.float32(np.cos(split) if axis == 0 else split).view(np.uint32), axis)
            open_uppers.append(at)
    return nodes
