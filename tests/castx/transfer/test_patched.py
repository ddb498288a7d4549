"""Different laws on parts of one interface."""

from __future__ import annotations

import numpy as np
import pytest

from castx.case.heat_transfer import InterfaceHeat
from castx.transfer.conductance import ConstantConductance, Faces
from castx.transfer.laws.solid_fraction import SolidFractionTransfer
from castx.transfer.pair_state import PairState
from castx.transfer.patched import PatchedLaw
from tests.castx.transfer.law_samples import FALLING, conductance

pytestmark = pytest.mark.serial


def test_each_pair_follows_the_law_of_its_part():
    """Values, slopes and shares are those of the parts alone, in the order of the pairs."""
    gap, hot, cold = np.array([0.0, 1e-5, 2e-5, 0.0]), np.array([400.0, 300, 350, 450]), 100.0
    heats = [{"law": "constant", "closed": FALLING},
             {"law": "series", "closed": 700, "gas_conductivity": 0.05}]  # fmt: skip
    parts = [np.array([3, 1]), np.array([0, 2])]
    built = []
    expected = np.zeros((5, 4))
    for heat, points in zip(heats, parts, strict=True):
        built.append(InterfaceHeat.read(heat).conduction_law())
        part = conductance(heat, gap[points], secondary=hot[points], primary=cold)
        expected[:, points] = [part.coefficient.value, part.contact, *part.coefficient.slopes]
    law = PatchedLaw(list(zip(parts, built, strict=True)))
    faces = Faces.at_temperatures(hot, np.full(4, cold), 0.0, 0.3)
    found = law(PairState.of(gap, np.zeros(4)), faces)
    np.testing.assert_array_equal(
        [found.coefficient.value, found.contact, *found.coefficient.slopes], expected
    )


def test_the_solid_fraction_is_needed_where_one_part_needs_it():
    constant, every = ConstantConductance(5.0), np.arange(2)
    solid = SolidFractionTransfer(constant, constant)
    assert PatchedLaw([(every, solid), (every, constant)]).needs_solid_fraction
    assert not PatchedLaw([(every, constant)]).needs_solid_fraction
