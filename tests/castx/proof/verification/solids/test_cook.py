import pytest

from castx.proof.verification.solids.cook import CASES, INCOMPRESSIBLE, VERIFICATION
from tests.castx.proof.verification.coarse_run import coarse_run

pytestmark = pytest.mark.serial


def test_the_volume_locks_towards_the_incompressible_panel():
    nearly = CASES["nearly incompressible"]
    assert nearly._replace(poisson=0.5, tip=INCOMPRESSIBLE.tip) == INCOMPRESSIBLE
    assert nearly.tip == pytest.approx(INCOMPRESSIBLE.tip, rel=1e-4)


def test_a_coarse_run(comm):
    coarse_run(VERIFICATION, comm)
