# SPDX-License-Identifier: Apache-2.0
"""Samplers over Dr.Jit arrays: tables become buffers, descents become loops. The C99 runtime of one file is the
specification; it says the same, one direction at a time."""

from __future__ import annotations

from typing import Any, Callable, Optional, Sequence, Tuple

from ._drjit_domain import Domain, domain_of
from ._drjit_forest import MIN_COS, Albedo, Forest, Library, Vector, View
from ._tables import Tables, Width

MAX_TRIALS = 256
Parameters = Sequence[Any]


class DrJitSampler:
    """Directions and densities over arrays. Ours are the names: ``wo`` is known, ``wi`` is drawn. With the tables of
    exact mode that is there, too. ``at``: of families the values of the parameters; outside of their ranges there is
    no sample."""

    def __init__(self, mi: Any, dr: Any, tables: Tables, exact: Optional[Tables] = None) -> None:
        self._lib = Library(mi, dr)
        self._tables = tables
        self._domain = domain_of(dr, tables)
        self._one_shot = Forest(self._lib, tables, True)
        if exact is not None:
            self._exact = Forest(self._lib, exact, False)
            self._albedo = Albedo(self._lib, exact)

    def sample(self, wo: Vector, u1: Any, u2: Tuple[Any, Any], active: Any, monotone: bool,
               at: Parameters = ()) -> Tuple[Vector, Any]:
        """wi and its density per solid angle, 0 for no sample. ``monotone``: a descent from u2 alone, which keeps
        stratified points stratified; else u1 chooses the leaf by alias table."""
        dr = self._lib.dr
        view = self.view(wo, at)
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
        """Uniforms for the square and, of half squares, the coin for the side of wi.y: continuous across
        the plane of incidence."""
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
        return (*self._domain_of(view).lift(view.o, px, py), height)

    def _domain_of(self, view: View) -> Domain:
        return self._domain._replace(widths=view.widths)

    def sample_exact(self, wo: Vector, u1: Any, u2: Tuple[Any, Any], target: Callable[[Vector, Any], Any],
                     active: Any, at: Parameters = ()) -> Tuple[Vector, Any]:
        """wi in proportion to the target times cos theta_i, and the density. The first trial is made of the uniforms,
        later ones of a generator that they seed; ``target(wi, active)`` is evaluated at each, without the cosine."""
        lib, dr, mi = self._lib, self._lib.dr, self._lib.mi
        view = self.view(wo, at)
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

    def pdf_exact(self, wo: Vector, wi: Vector, t: Any, active: Any, at: Parameters = ()) -> Any:
        """Per solid angle, from the target at wi."""
        view = self.view(wo, at)
        active = active & view.valid & (wi[2] > 0)
        albedo = self._albedo(view, active)
        return self._lib.dr.select(active & (albedo > 0), t * wi[2] / albedo, 0)

    def pdf(self, wo: Vector, wi: Vector, active: Any, at: Parameters = ()) -> Any:
        """Per solid angle; 0 where a direction is below the surface."""
        dr = self._lib.dr
        view = self.view(wo, at)
        active = active & view.valid & (wi[2] > 0)
        w = view.enter(wi)
        if self._domain.half:
            w = (w[0], dr.abs(w[1]), w[2])
        domain = self._domain_of(view)
        px, py = domain.lower(view.o, w)
        slab = self._one_shot.slab_index(view, active)
        leaf = self._one_shot.locate(slab, px, py, active)
        height = self._one_shot.height(leaf, px, py, active)
        lifted, area = domain.lift(view.o, px, py)
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

    def view(self, wo: Vector, at: Parameters = ()) -> View:
        """incidence.hpp and incidence.cpp."""
        view = self._view(wo)
        if not self._tables.parameters:
            return view
        valid, coordinates = self._coordinates(at)
        widths = tuple(self._width(w, coordinates) for w in self._tables.widths)
        return view._replace(valid=view.valid & valid, at=coordinates, widths=widths)

    def _coordinates(self, at: Parameters) -> Tuple[Any, Tuple[Any, ...]]:
        """Whether all parameters are inside of their ranges, and their coordinates (packed_family.hpp)."""
        dr, valid, coordinates = self._lib.dr, True, []
        for p, value in zip(self._tables.parameters, at):
            inside = (value >= p.low) & (value <= p.high)
            x = dr.log(dr.select(inside, value, p.low)) if p.logarithmic else value
            valid = inside & valid
            coordinates.append(dr.clip(x, p.lowest, p.highest))
        return valid, tuple(coordinates)

    def _width(self, width: Width, at: Tuple[Any, ...]) -> Any:
        exponent = 0.0
        for slope, corner, x in zip(width.slope, width.corner, at):
            exponent = exponent + slope * (x - corner)
        return width.largest * self._lib.dr.exp(exponent)

    def _view(self, wo: Vector) -> View:
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
