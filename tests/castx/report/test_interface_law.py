"""Curves of interface laws against their formulas."""

from __future__ import annotations

import numpy as np
import pytest

from castx.errors import CaseError
from castx.report.interface_law import heat_transfer_coefficient

pytestmark = pytest.mark.serial

GAPS = np.linspace(0.0, 300e-6, 7)
GAS = {"closed": 2300, "gas_conductivity": 0.05}


def test_laws_are_their_formulas_over_the_gap():
    with np.errstate(divide="ignore"):
        limited = np.minimum(2300.0, 0.05 / GAPS)
    found = heat_transfer_coefficient({"law": "limited", **GAS}, GAPS)
    np.testing.assert_allclose(found, limited, rtol=1e-12)
    series = heat_transfer_coefficient({"law": "series", **GAS}, GAPS)
    np.testing.assert_allclose(series, 1.0 / (1.0 / 2300.0 + GAPS / 0.05), rtol=1e-12)
    assert (heat_transfer_coefficient({"law": "none"}, GAPS) == 0.0).all()


def test_pressure_temperature_time_and_solid_fraction_count():
    pressed = {"law": "constant", "closed": 1000,
               "pressure": {"resistance": 1e-3, "hardness": 5e8, "exponent": 1.0}}  # fmt: skip
    found = heat_transfer_coefficient(pressed, 0.0, [0.0, 5e8])
    np.testing.assert_allclose(found, [1000.0, 2000.0])
    table = {"over": "temperature", "of": "secondary", "table": [[0, 100], [1000, 1100]]}
    hot = heat_transfer_coefficient({"law": "constant", "closed": table}, secondary=[200, 700])
    np.testing.assert_allclose(hot, [300.0, 800.0])
    timed = {"law": "constant", "closed": {"over": "time", "table": [[0, 100], [10, 200]]}}
    assert heat_transfer_coefficient(timed, time=5.0) == pytest.approx(150.0)
    frozen = {"law": "solid-fraction", "closed": 1000, "open": 100}
    values = [heat_transfer_coefficient(frozen, solid_fraction=f) for f in (0.0, 0.5, 1.0)]
    assert values == pytest.approx([1000.0, 550.0, 100.0])


def test_arguments_are_combined_like_arrays():
    gap, hot = np.meshgrid(GAPS, [100.0, 600.0])
    assert heat_transfer_coefficient({"law": "limited", **GAS}, gap, secondary=hot).shape == (2, 7)
    assert heat_transfer_coefficient({"law": "limited", **GAS}).shape == ()


def test_laws_that_have_no_curve_are_refused():
    with pytest.raises(CaseError, match="heat: gas_conductivity: missing"):
        heat_transfer_coefficient({"law": "limited", "closed": 2300})
    with pytest.raises(CaseError, match="it is infinite"):
        heat_transfer_coefficient({"law": "perfect"})
