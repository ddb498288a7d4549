"""X4: with a tenth of the steps ten times as far off, which is first order."""

import pytest

from castx.proof.foreign.cases.cooled_casing import EXACT, KEPT, last

pytestmark = pytest.mark.serial


def test_the_cement_leaves_the_rock(comm):
    found = last(comm, 1e4, 10)
    for name, exact in EXACT[1e4].items():
        scale = 120.0 if name.startswith("T") else abs(exact)
        assert abs(found[name] - exact) < 1e-2 * scale, name
    assert abs(found["T(0.21272 m)"] - 43.9159) > 1e-4 * 120.0


def test_both_tables_have_the_same_rows():
    for time, rows in EXACT.items():
        assert rows.keys() == KEPT[time].keys()
        for name, exact in rows.items():
            assert KEPT[time][name] == pytest.approx(exact, rel=6e-3), name
