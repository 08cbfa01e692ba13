#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes reference_values.inc: the models' values in 40 digits of precision, written down from the papers in
angles and trigonometric functions, where the C++ models use vectors and forms free of cancellation.

    python3 reference_values.py > reference_values.inc        (needs mpmath)

Angles and parameters are floats with few bits, so that C++ and Python mean the same numbers.
"""
from mpmath import mp, mpf, acos, atan2, cos, exp, pi, sin, sqrt, tan

mp.dps = 40


def direction(theta, phi):
    return [sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def half(wo, wi):
    h = [x + y for x, y in zip(wo, wi)]
    length = sqrt(dot(h, h))
    return [x / length for x in h]


def schlick(f0, c):
    return f0 + (1 - f0) * (1 - c) ** 5


class Pair:
    def __init__(self, theta_o, phi_o, theta_i, phi_i):
        self.to, self.po, self.ti, self.pi = (mpf(a) for a in (theta_o, phi_o, theta_i, phi_i))
        self.wo, self.wi = direction(self.to, self.po), direction(self.ti, self.pi)
        self.h = half(self.wo, self.wi)
        self.co, self.ci = cos(self.to), cos(self.ti)
        self.cd = dot(self.wo, self.h)
        self.th = acos(self.h[2])
        self.ph = atan2(self.h[1], self.h[0])
        self.dphi = self.po - self.pi


def oren_nayar(p, rho, sigma):
    a = 1 - sigma**2 / (sigma**2 + mpf("0.33")) / 2
    b = mpf("0.45") * sigma**2 / (sigma**2 + mpf("0.09"))
    alpha, beta = max(p.to, p.ti), min(p.to, p.ti)
    return rho / pi * (a + b * max(mpf(0), cos(p.dphi)) * sin(alpha) * tan(beta))


def phong(p, kd, ks, n):
    # spherical law of cosines between wi and wo turned by pi about the normal
    c = p.co * p.ci + sin(p.to) * sin(p.ti) * cos(p.dphi + pi)
    return kd / pi + ks * (n + 2) / (2 * pi) * max(mpf(0), c) ** n


def lafortune(p, kd, ks, cx, cy, cz, n):
    s = cx * p.wo[0] * p.wi[0] + cy * p.wo[1] * p.wi[1] + cz * p.wo[2] * p.wi[2]
    return kd / pi + ks * (n + 2) / (2 * pi) * max(mpf(0), s) ** n


def ward(p, kd, ks, ax, ay):
    h = [x + y for x, y in zip(p.wo, p.wi)]
    e = exp(-tan(p.th) ** 2 * (cos(p.ph) ** 2 / ax**2 + sin(p.ph) ** 2 / ay**2))
    return kd / pi + ks / (pi * ax * ay) * e * dot(h, h) / h[2] ** 4


def ashikhmin_shirley(p, kd, f0, nx, ny):
    power = nx * cos(p.ph) ** 2 + ny * sin(p.ph) ** 2
    s = sqrt((nx + 1) * (ny + 1)) / (8 * pi) * cos(p.th) ** power / (p.cd * max(p.co, p.ci)) * schlick(f0, p.cd)
    d = 28 * kd / (23 * pi) * (1 - f0) * (1 - (1 - p.co / 2) ** 5) * (1 - (1 - p.ci / 2) ** 5)
    return d + s


def cook_torrance(p, kd, ks, f0, m):
    d = exp(-((tan(p.th) / m) ** 2)) / (pi * m**2 * cos(p.th) ** 4)
    g = min(mpf(1), 2 * cos(p.th) * p.co / p.cd, 2 * cos(p.th) * p.ci / p.cd)
    return kd / pi + ks * schlick(f0, p.cd) * d * g / (4 * p.co * p.ci)


def ggx(p, alpha, f0):
    th = acos(p.h[2])
    d = alpha**2 / (pi * cos(th) ** 4 * (alpha**2 + tan(th) ** 2) ** 2)
    smith = lambda t: (sqrt(1 + alpha**2 * tan(t) ** 2) - 1) / 2
    return schlick(f0, p.cd) * d / (1 + smith(p.to) + smith(p.ti)) / (4 * p.co * p.ci)


def plastic(p, kd, f0, alpha):
    return kd / pi * (1 - schlick(f0, p.co)) * (1 - schlick(f0, p.ci)) + ggx(p, alpha, f0)


def retro_reflector(p, alpha, f0):
    return ggx(Pair(p.to, p.po, p.ti, p.pi + pi), alpha, f0)


def low_smooth(p, a, b, c, f0):
    d2 = (p.wo[0] + p.wi[0]) ** 2 + (p.wo[1] + p.wi[1]) ** 2
    return a / (1 + b * d2) ** c * schlick(f0, p.cd)


# model, C++ type, parameters in order; a tuple is r, g, b.
MODELS = [
    (oren_nayar, "OrenNayar", [(0.5, 0.25, 1.0), 0.375]),
    (oren_nayar, "OrenNayar", [(0.5, 0.25, 1.0), 1.0]),
    (phong, "Phong", [(0.25, 0.125, 0.0), (0.5, 0.25, 1.0), 50.0]),
    (phong, "Phong", [(0.0, 0.0, 0.0), (0.5, 0.25, 1.0), 100000.0]),
    (lafortune, "Lafortune",
     [(0.25, 0.125, 0.0), (0.5, 0.25, 1.0), (-1.0, -1.125, 0.5), (-1.0, -0.75, 0.5), (1.0, 0.875, 0.75), (8.0, 20.0, 1.5)]),
    (ward, "Ward", [(0.25, 0.125, 0.0), (0.5, 0.25, 1.0), 0.125, 0.125]),
    (ward, "Ward", [(0.25, 0.125, 0.0), (0.5, 0.25, 1.0), 0.0625, 0.5]),
    (ashikhmin_shirley, "AshikhminShirley", [(0.25, 0.5, 0.75), (0.0625, 0.5, 1.0), 100.0, 100.0]),
    (ashikhmin_shirley, "AshikhminShirley", [(0.25, 0.5, 0.75), (0.0625, 0.5, 1.0), 20.0, 1000.0]),
    (cook_torrance, "CookTorrance", [(0.25, 0.125, 0.0), (0.5, 0.25, 1.0), (0.875, 0.5, 0.0625), 0.25]),
    (ggx, "Ggx", [0.125, (1.0, 0.75, 0.25)]),
    (ggx, "Ggx", [0.75, (1.0, 0.75, 0.25)]),
    (ggx, "Ggx", [0.0009765625, (1.0, 0.75, 0.25)]),
    (plastic, "Plastic", [(0.25, 0.5, 0.75), 0.0625, 0.125]),
    (retro_reflector, "RetroReflector", [0.125, (1.0, 0.75, 0.25)]),
    (low_smooth, "LowSmooth", [(1.0, 2.0, 4.0), 100.0, 0.75, (0.0625, 0.5, 1.0)]),
]

# theta_o, phi_o, theta_i, phi_i in radians: an arbitrary pair, near the mirror direction, exactly on it but for
# a thousandth, near the back direction, and both grazing.
PAIRS = [
    (0.5, 0.25, 1.0, 2.0),
    (0.75, 0.5, 0.71875, 3.625),
    (0.75, 0.0, 0.7509765625, 3.1416015625),
    (1.0, 1.0, 1.03125, 1.0625),
    (1.5625, 0.0, 1.55859375, 3.0),
]


def literal(x):
    return "{" + ", ".join(f"{v}f" for v in x) + "}" if isinstance(x, tuple) else f"{x}f"


def main():
    print("// SPDX-License-Identifier: Apache-2.0")
    print("// Made by reference_values.py: VALUE(model, theta_o, phi_o, theta_i, phi_i, r, g, b)")
    for formula, name, parameters in MODELS:
        for angles in PAIRS:
            pair = Pair(*angles)
            rgb = []
            for c in range(3):
                value = formula(pair, *[mpf(p[c] if isinstance(p, tuple) else p) for p in parameters])
                rgb.append(value if value > mpf("1e-300") else mpf(0))  # beyond the range of double
            model = f"({name}{{{', '.join(literal(p) for p in parameters)}}})"
            print(f"VALUE({model}, {', '.join(map(str, angles))}, {', '.join(mp.nstr(v, 17) for v in rgb)})")


main()
