"""Exact numbers of the record, which were found another way, and the run."""

import pytest

from castx.proof.verification.foundry.die_life import VERIFICATION, cycles_of, restrained
from tests.castx.proof.verification.coarse_run import coarse_run

pytestmark = pytest.mark.serial


def test_the_numbers_of_the_record():
    assert [cycles_of(strain) for strain in (0.008, 0.012)] == pytest.approx([63942.07, 3716.959])
    assert restrained() == pytest.approx(5.281690e-3, rel=1e-6)


def test_a_run(comm):
    coarse_run(VERIFICATION, comm)
