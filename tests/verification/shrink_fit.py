"""Radial displacements of a shaft and a hub under the pressure between them (Lamé), plane stress.

S. P. Timoshenko and J. N. Goodier, Theory of Elasticity, 3rd ed., section 28.
"""

from __future__ import annotations


def shaft_compliance(radius: float, young: float, poisson: float) -> float:
    """Return C1 = a (1 - ν)/E, by which the surface of a solid shaft moves inwards [m/Pa]."""
    return radius * (1 - poisson) / young


def hub_compliance(inner: float, outer: float, young: float, poisson: float) -> float:
    """Return C2 = a/E ((b² + a²)/(b² - a²) + ν), by which that of a bore moves outwards [m/Pa]."""
    ratio = (outer**2 + inner**2) / (outer**2 - inner**2)
    return inner / young * (ratio + poisson)
