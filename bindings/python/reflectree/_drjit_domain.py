# SPDX-License-Identifier: Apache-2.0
"""The domains over Dr.Jit's arrays: from the square to wi and back; domain_map.hpp and the maps that it
includes derive every line."""

from __future__ import annotations

from typing import Any, NamedTuple, Tuple

from ._tables import Tables

PI = 3.14159265358979
LEAST = 1e-7  # rounding may carry the rim of the square to the horizon: it stays just above


class Domain(NamedTuple):
    """A map for viewers ``o``, three arrays in its frame; ``dr`` is Dr.Jit. ``widths``: of ``scaled_star``, those of
    each viewer's member."""

    dr: Any
    kind: str
    half: bool
    exponent: float
    stretch: float
    widths: Tuple[Any, Any] = (1.0, 1.0)

    def lift(self, o: Any, px: Any, py: Any) -> Tuple[Any, Any]:
        """wi, and d(projected solid angle) / d(share of the square)."""
        dr = self.dr
        y = dr.abs(py)
        ux, uy = _circle(dr, px)
        uy = dr.mulsign(uy, py)
        if self.kind in ("half_vector", "back_vector"):
            ax = o[0] if self.kind == "half_vector" else -o[0]
            p, c = _star(dr, ax, o[2], ux)
            return self._reflected((ax, 0, o[2]), ux, uy, p, c, y)
        if self.kind in ("slope_star", "scaled_star"):
            scales = self._scales()
            sx, sy, p, c = _slope_star(dr, o, ux, uy, scales)
            wi, area = self._reflected(o, sx, sy, p, c, y)
            return wi, area * (scales[0] * scales[1])
        if self.kind in ("mirror_vector", "normal_vector"):
            y = dr.maximum(y, 1e-12)
            ax, az = self._axis(o)
            p, c, zr = _rim(dr, ax, az, ux)
            d = p / (p + (c - p) * y)
            t = y * d
            tt = t * t
            inverse = 1 / (1 + tt)
            z = dr.maximum(d * (1 - y) * (zr * t + az) * inverse, LEAST)
            wi = (-(ax * (1 - tt) + 2 * t * az * ux) * inverse, 2 * t * uy * inverse, z)
            return wi, z * (8 * PI) * t * (inverse * inverse) * (d * d)
        if self.kind == "projected_disk":
            r, z, area = dr.sqrt(y), dr.maximum(dr.sqrt(dr.maximum(1 - y, 0)), LEAST), PI
        elif self.kind == "equal_area":
            r, z = dr.sqrt(y * (2 - y)), dr.maximum(1 - y, LEAST)
            area = 2 * PI * z
        else:
            power = 1 / (2 - self.exponent)
            v = dr.maximum(1 - y, 1e-7)
            z = dr.maximum(dr.power(v, power), LEAST)
            r, area = dr.sqrt(dr.maximum(1 - z * z, 0)), 2 * PI * power * z * z / v
        return (r * ux, r * uy, z), area

    def lower(self, o: Any, wi: Any) -> Tuple[Any, Any]:
        """The place of wi in the square; of half squares wi.y >= 0."""
        dr = self.dr
        x, y, z = wi
        sin2 = x * x + y * y
        wx, wy = x, y
        if self.kind in ("half_vector", "back_vector"):
            ax = o[0] if self.kind == "half_vector" else -o[0]
            wx, wy, wz = _half(dr, (ax, 0, o[2]), wi)
            sine = dr.sqrt(dr.maximum(wx * wx + wy * wy, LEAST * LEAST))
            t = sine / dr.maximum(wz, 1e-12)
            p, c = _star(dr, ax, o[2], wx / sine)
            radius = p * t / (p - (c - p) * t)
        elif self.kind in ("slope_star", "scaled_star"):
            scales = self._scales()
            hx, hy, hz = _half(dr, o, wi)
            hz = dr.maximum(hz, 1e-12)
            vx, vy = hx / (hz * scales[0]), hy / (hz * scales[1])
            least = LEAST if self.kind == "slope_star" else LEAST / dr.maximum(*scales)
            r = dr.maximum(dr.sqrt(vx * vx + vy * vy), least)
            pole = (vx == 0) & (vy == 0)
            wx, wy = dr.select(pole, 1, vx / r), dr.select(pole, 0, vy / r)
            _, _, p, c = _slope_star(dr, o, wx, wy, scales)
            radius = p * r / (p - (c - p) * r)
        elif self.kind in ("mirror_vector", "normal_vector"):
            ax, az = self._axis(o)
            a, b = x + ax, z - az
            wx, wy, wz = -az * a - ax * b, y, az * z - ax * x
            sine = dr.sqrt(dr.maximum(wx * wx + wy * wy, LEAST * LEAST))
            t = dr.select(wz > 0, sine / (1 + wz), (1 - wz) / sine)
            p, c, _ = _rim(dr, ax, az, wx / sine)
            radius = p * t / (p - (c - p) * t)
        elif self.kind == "projected_disk":
            radius = sin2
        elif self.kind == "equal_area":
            radius = sin2 / (1 + z)
        else:
            radius = 1 - dr.power(z, 2 - self.exponent)
        radius = dr.clip(radius, 0, 1)
        return _azimuth(dr, wx, wy), radius if self.half else dr.select(wy < 0, -radius, radius)

    def _scales(self) -> Tuple[Any, Any]:
        """How slopes are stretched along x and y."""
        return self.widths if self.kind == "scaled_star" else (self.stretch, 1 / self.stretch)

    def _axis(self, o: Any) -> Tuple[Any, Any]:
        return (o[0], o[2]) if self.kind == "mirror_vector" else (0 * o[0], 0 * o[2] + 1)

    def _reflected(self, o: Any, sx: Any, sy: Any, p: Any, c: Any, y: Any) -> Tuple[Any, Any]:
        """o reflected at the slopes t (sx, sy), where the radius y leads to t = y d, t' = d^2."""
        dr = self.dr
        y = dr.maximum(y, 1e-12)
        d = p / (p + (c - p) * y)
        t = y * d
        tx, ty = t * sx, t * sy
        o_n = dr.maximum(o[0] * tx + o[1] * ty + o[2], LEAST)
        cos2 = 1 / (1 + tx * tx + ty * ty)
        twice = 2 * o_n * cos2
        wi = (twice * tx - o[0], twice * ty - o[1], dr.maximum(twice - o[2], LEAST))
        return wi, wi[2] * (8 * PI) * o_n * (cos2 * cos2) * (t * d * d)


def _circle(dr: Any, x: Any) -> Tuple[Any, Any]:
    """sin and cos of pi x / 2, |x| <= 1."""
    h = 0.5 * x
    q = h * h
    q2 = q * q
    sine = h * ((3.14159264 - q * 5.16771009) + q2 * ((2.55007766 - q * 0.598292159) + q2 * 0.0776594082))
    cosine = (1 - q * 4.93480214) + q2 * ((4.05870916 - q * 1.33521206) + q2 * (0.234937559 - q * 0.0243967166))
    return sine, cosine


def _quarter_atan(t: Any) -> Any:
    s = t * t
    p = (-0.00597563674 * s + 0.0308790214) * s - 0.0757402948
    p = (((p * s + 0.126232606) * s - 0.178501543) * s + 0.254262416) * s
    return t * ((p - 0.424396087) * s + 1.27323942)


def _azimuth(dr: Any, x: Any, y: Any) -> Any:
    a, b = dr.abs(x), dr.abs(y)
    flat = a > b
    angle = 0.5 * _quarter_atan(dr.minimum(a, b) / dr.maximum(dr.maximum(a, b), 1e-30))
    turned = dr.select(flat | (b == 0), 1 - angle, angle)
    return dr.select(x < 0, -turned, turned)


def _half(dr: Any, o: Any, wi: Any) -> Tuple[Any, Any, Any]:
    """normalize(o + wi); where they nearly cancel, what is rounding is taken out of the sum."""
    wx, wy, wz = o[0] + wi[0], o[1] + wi[1], o[2] + wi[2]
    mx, my, mz = o[0] - wi[0], o[1] - wi[1], o[2] - wi[2]
    opposite = o[0] * wi[0] + o[1] * wi[1] + o[2] * wi[2] < 0
    t = (wx * mx + wy * my + wz * mz) / (mx * mx + my * my + mz * mz)
    t = dr.select(opposite, t, 0)
    wx, wy, wz = wx - t * mx, wy - t * my, wz - t * mz
    n = dr.rsqrt(wx * wx + wy * wy + wz * wz)
    return wx * n, wy * n, wz * n


def _star(dr: Any, sine: Any, cosine: Any, cos_phi: Any) -> Tuple[Any, Any]:
    c2, sx = cosine * cosine, sine * cos_phi
    length = dr.sqrt(c2 + sx * sx) + dr.abs(sx)
    return dr.select(sx < 0, c2, length * length), cosine * length


def _rim(dr: Any, sine: Any, cosine: Any, cos_phi: Any) -> Tuple[Any, Any, Any]:
    sx = sine * cos_phi
    length = dr.sqrt(cosine * cosine + sx * sx) + dr.abs(sx)
    below = sx < 0
    return (dr.select(below, length, cosine), dr.select(below, cosine, length),
            dr.select(below, length, cosine * cosine / length))


def _slope_star(dr: Any, o: Any, ux: Any, uy: Any, scales: Tuple[Any, Any]) -> Tuple[Any, Any, Any, Any]:
    ax, ay = scales[0] * ux, scales[1] * uy
    q, b = ax * ax + ay * ay, ax * o[0] + ay * o[1]
    length = dr.sqrt(b * b + q * o[2] * o[2]) + dr.abs(b)
    return ax, ay, dr.select(b < 0, o[2], length), dr.select(b < 0, length, q * o[2])


def domain_of(dr: Any, tables: Tables) -> Domain:
    return Domain(dr, tables.domain, tables.half, tables.exponent, tables.stretch)
