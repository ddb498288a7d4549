"""Chills and cores of metals that could be cast: they start solid, and expand as any other metal.

Free bars have their exact length after every step. A core in a ring that is heated by it, all of it
elastic and at one temperature at the end, is a shrink fit: by Lamé p (C1 + C2) is the overlap of
the free bodies, the core's radius times the difference of their strains.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from castx.materials.lookup import find_material
from castx.proof.verification.contact.shrink_fit import ShrinkFit
from tests.coupled_cases import nodal, paired
from tests.defaults.runs import by_default
from tests.verification.free_bar import HOT, LENGTH, START, bar, ends, growth

pytestmark = pytest.mark.sampled

CORE, OUTSIDE, COLD_CORE, HOT_RING = 0.02, 0.04, 120.0, 560.0
RING = "Al-pure"


@pytest.mark.parametrize("stress_free", [None, 20.0])
@pytest.mark.parametrize("metal", ["Cu-pure", "GJL-250", "CuSn12", "AlSi7Mg", "steel-H13"])
def test_a_chill_has_its_own_length(comm, metal, stress_free):
    changes = {} if stress_free is None else {"stress_free": stress_free}
    hot = 400.0 if metal == "AlSi7Mg" else HOT
    case = bar(metal, [[0, START], [10, hot]], **changes)
    free = START if stress_free is None else stress_free
    compared = 0
    for state in by_default(comm, case):
        temperature = START + state.time / 10.0 * (hot - START)
        (far,) = ends([state])
        assert far == pytest.approx(LENGTH * growth(metal, free, temperature), rel=1e-6)
        compared += 1
    assert compared > 10


def core_in_ring(metal: str, stress_free: float | None) -> dict[str, Any]:
    """Return a cold core in a hot ring of aluminium that is already solid, insulated outside."""
    core = {"extends": metal} | ({} if stress_free is None else {"stress_free": stress_free})
    return {
        "geometry": {"generator": "core_in_ring", "model": "plane-stress",
                     "core_radius": CORE, "outer_radius": OUTSIDE, "size": CORE / 12},
        "materials": {"core metal": core},
        "bodies": [
            {"name": "casting", "material": RING, "temperature": HOT_RING},
            {"name": "core", "material": "core metal", "temperature": COLD_CORE},
        ],
        "interfaces": [
            {"bodies": ["casting", "core"],
             "heat": {"law": "limited", "closed": 5000, "gas_conductivity": 0.05}},
        ],
        "time": {"end": 120},
    }  # fmt: skip


def elastic(metal: str, temperature: float) -> tuple[float, float]:
    """Return Young's modulus [Pa] and Poisson's ratio."""
    material = find_material(metal)
    assert material.young_modulus is not None and material.poisson_ratio is not None
    return float(material.young_modulus(temperature)), float(material.poisson_ratio(temperature))


@pytest.mark.parametrize(
    "metal, stress_free",
    [("Cu-pure", None), ("Cu-pure", 20.0), ("GJL-250", None), ("GJL-250", 200.0),
     ("steel-H13", None)],
)  # fmt: skip
def test_a_core_in_its_ring(comm, metal, stress_free):
    """The pressure is uniform; node by node linear elements are within 1 %, as in V9."""
    for state in by_default(comm, core_in_ring(metal, stress_free)):
        # One that is free of strain at another temperature has its own size from the first step on.
        fits = stress_free is None or stress_free < COLD_CORE
        assert not fits or paired(state, "casting/core", "gap").max() < 1e-9
    parts = [nodal(state, body, "temperature") for body in ("casting", "core")]
    end = float(parts[1].mean())
    assert np.ptp(np.concatenate(parts)) < 0.5
    free = COLD_CORE if stress_free is None else stress_free
    overlap = CORE * (growth(metal, free, end) - growth(RING, HOT_RING, end))
    fit = ShrinkFit(CORE, OUTSIDE, overlap, elastic(metal, end), elastic(RING, end))
    pressure = paired(state, "casting/core", "contact_pressure")
    np.testing.assert_allclose(pressure, fit.pressure, rtol=0.01)
    assert pressure.mean() == pytest.approx(fit.pressure, rel=4e-3)
