"""Iron that shrinks onto sand, which lets go below the strength of the iron, in few steps."""

from __future__ import annotations

from typing import Any

import pytest

from bench.sand import Answer, casting, run
from castx.materials.lookup import find_material

pytestmark = pytest.mark.serial


def answer(comm, law: str) -> Answer:
    data: dict[str, Any] = casting(law, size=7.5e-3)
    data["time"]["temperature_change"] = 80.0
    return run(data, comm)


def test_a_ring_of_iron_keeps_little_stress_on_a_core_of_sand(comm) -> None:
    strength = find_material("GJL-250", {}).description.tensile_strength
    assert strength is not None
    yielding, rigid = answer(comm, "drucker-prager"), answer(comm, "rigid")
    assert rigid.stress > 0.9 * strength(20.0)
    assert yielding.stress < 0.25 * strength(20.0)
    assert yielding.steps + yielding.cuts <= 1.3 * (rigid.steps + rigid.cuts)
