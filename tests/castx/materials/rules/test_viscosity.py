"""Viscosities of flow rules: plain, or with the unit Pa·s, which is remembered."""

from __future__ import annotations

import pytest

from castx.errors import CaseError
from castx.materials.rules.viscosity import TableInPascalSeconds, ViscosityEntry

pytestmark = pytest.mark.serial


@pytest.mark.parametrize(
    ("value", "written"),
    [(2e6, False), ([[20, 2e6], [500, 1e6]], False), ("2 MPa*s", True),
     ([[20, 2e6], [500, "1 MPa*s"]], True)],
)  # fmt: skip
def test_a_written_unit_is_remembered(value, written) -> None:
    entry = ViscosityEntry()
    table = entry.read(value)
    assert isinstance(table, TableInPascalSeconds) == written
    assert table(20.0) == 2e6
    assert isinstance(entry.read(table), TableInPascalSeconds) == written  # read once more


@pytest.mark.parametrize("value", ["3 Pa", 0.0, [[20, -1.0]]])
def test_refusals(value) -> None:
    with pytest.raises(CaseError):
        ViscosityEntry().read(value)
