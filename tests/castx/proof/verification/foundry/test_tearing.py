"""Exact numbers of the record, which were found another way, and the run."""

import pytest

from castx.proof.verification.foundry.tearing import (
    ALLOYS,
    BINARY,
    VERIFICATION,
    Columnar,
    shrinking,
    straining,
)
from tests.castx.proof.verification.coarse_run import coarse_run

pytestmark = pytest.mark.serial


def test_the_numbers_of_the_record():
    mush = Columnar()
    assert shrinking(0.02) == pytest.approx(42.155954, rel=1e-7)
    assert [straining(cut) for cut in (0.02, 0.01)] == pytest.approx([18.052884, 41.396353])
    assert [mush.suction(cut) for cut in (0.02, 0.01)] == pytest.approx([910.5686, 1960.841])
    assert mush.critical_rate(0.02) == pytest.approx(0.03162823, rel=1e-6)
    assert mush.critical_rate(0.01) == pytest.approx(4.957869e-4, rel=1e-6)
    assert Columnar(speed=0.0).critical_rate(0.02) == pytest.approx(0.05806374, rel=1e-6)
    assert mush.suction(0.02) / 2000.0 == pytest.approx(0.4552843, rel=1e-6)
    assert [alloy.clyne_davies for alloy in ALLOYS] == pytest.approx([8.121778, 7.443063])
    assert [BINARY.slope(f) for f in (0.87, 0.94)] == pytest.approx([926.1630, 3962.701])


def test_a_run(comm):
    coarse_run(VERIFICATION, comm)
