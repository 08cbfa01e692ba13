# SPDX-License-Identifier: Apache-2.0
"""Cook and Torrance 1982, normalised as Walter et al. 2007."""
from mpmath import cos, exp, mpf, pi, tan
from reference_values import schlick


def value(p, kd, ks, f0, alpha):
    d = exp(-((tan(p.th) / alpha) ** 2)) / (pi * alpha**2 * cos(p.th) ** 4)
    g = min(mpf(1), 2 * cos(p.th) * p.co / p.cd, 2 * cos(p.th) * p.ci / p.cd)
    return kd / pi + ks * schlick(f0, p.cd) * d * g / (4 * p.co * p.ci)


VALUES = """
cook_torrance:kd=0.25/0.125/0,ks=0.5/0.25/1,f0=0.875/0.5/0.0625,alpha=0.25
  0.5 0.25 1.0 2.0  0.083692598431422513 0.04096460109148891 0.00058887002768935073
  0.75 0.5 0.71875 3.625  1.0870319351260391 0.32791338601666711 0.14635322042512837
  0.75 0.0 0.7509765625 3.1416015625  1.1212138129194536 0.33775598127831116 0.15189799784140956
  1.0 1.0 1.03125 1.0625  0.079577471545947681 0.039788735772973838 1.8126157838277601e-18
  1.5625 0.0 1.55859375 3.0  0.079577471545947668 0.039788735772973834 0.0
"""
