"""A disc in a hole with little play by Michell's series: a second formulation of its pressure."""

import math

import numpy as np


def michell_disc(half_angle, terms):
    """Return the peak of p R / (E* dR) at a half-angle of contact, and the load over E* dR.

    A pressure p_n cos(n phi) opens the gap by 2 R / E* c_n p_n, c_n = n / (n^2 - 1), c_0 = 1/2; n = 1 moves
    the disc. Within the arc that must make up for D cos(phi) - dR.
    """
    b = math.tan(0.5 * half_angle)
    w = 0.5 * math.pi / terms
    s = w * (np.arange(2 * terms) + 0.5) - 0.5 * math.pi
    y = b * np.sin(s)
    angle, element = 2.0 * np.arctan(y), 2.0 * b * np.cos(s) / (1.0 + y * y) * w
    basis = np.array([b * np.cos(s) * np.sin(s) ** (2 * k) for k in range(9)])
    n = np.arange(terms)
    p = (basis * element) @ np.cos(np.outer(n, angle)).T / math.pi
    p[:, 0] *= 0.5
    c = np.ones(terms)
    c[1] = 0.0
    c[2:] = 2.0 * n[2:] / (n[2:] ** 2 - 1.0)
    at = 2.0 * np.arctan(b * np.sin(0.5 * math.pi * np.linspace(0.0, 0.93, 50)))
    system = np.vstack([(p * c) @ np.cos(np.outer(n, at)), -np.cos(at)]).T
    shares = np.linalg.lstsq(system, -np.ones(at.size), rcond=None)[0][:-1]
    return b * float(shares[0]), math.pi * float(shares @ p[:, 1])
