"""The temperature that a body is heated to by hotter ones that touch it.

Two half-spaces that touch without resistance have the temperature

    T = (b_1 T_1 + b_2 T_2)/(b_1 + b_2),  b = √(k ρc)

at their faces from the first moment on (H. S. Carslaw, J. C. Jaeger, Conduction of Heat in Solids,
2nd ed., 1959, section 2.14). The latent heat of a melt counts in its ρc, spread from its
temperature to that of the colder body. A resistance keeps the colder one below; cores and pins that
metal surrounds get hotter.
"""

from __future__ import annotations

import math

import numpy as np

from castx.case.bodies import Body
from castx.case.case import Case
from castx.materials.lookup import find_material
from castx.materials.material import Material


def contact_temperature(case: Case, body: Body) -> float | None:
    """Return the highest temperature by contact with hotter bodies [°C]; None: there is none.

    Args:
        case: the case.
        body: one of its bodies.
    """
    own = body.temperature.bounds
    if own is None:
        return None
    others = {other.name: other for other in case.bodies}
    touching = [set(interface.bodies) - {body.name} for interface in case.interfaces
                if body.name in interface.bodies]  # fmt: skip
    found = [_between(case, body, own[1], others[name]) for names in touching for name in names]
    return max((value for value in found if value is not None), default=None)


def _between(case: Case, body: Body, cold: float, other: Body) -> float | None:
    bounds = other.temperature.bounds
    if bounds is None or bounds[1] <= cold:
        return None
    first, second = (find_material(b.material, case.materials) for b in (body, other))
    hot = bounds[1]
    own, others = (effusivity(material, cold, hot) for material in (first, second))
    return (own * cold + others * hot) / (own + others)


def effusivity(material: Material, cold: float, hot: float) -> float:
    """Return √(k ρc) over a range of temperatures, latent heat included [W √s/m²/K].

    Args:
        material: of the body.
        cold: lowest temperature [°C].
        hot: highest temperature [°C].
    """
    low, high = material.enthalpy.enthalpy(np.array([cold, hot]))
    conductivity = material.conductivity
    most = max(float(conductivity.solid(cold)), float(conductivity.liquid(hot)))
    return math.sqrt(most * float(high - low) / (hot - cold))
