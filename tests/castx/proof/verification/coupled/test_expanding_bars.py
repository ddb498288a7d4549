import pytest

from castx.proof.verification.coupled.expanding_bars import GIVEN, OPEN, VERIFICATION
from tests.castx.proof.verification.coarse_run import coarse_run


@pytest.mark.serial
def test_given_numbers():
    exact = GIVEN.exact()
    assert exact["p"] == pytest.approx(276.472197e6, rel=1e-8)
    assert exact["h"] == pytest.approx(15676.404, rel=1e-7)
    assert exact["q"] == pytest.approx(140201.647, rel=1e-8)
    assert (exact["casting"], exact["mould"]) == pytest.approx((253.2661, 244.3226), rel=1e-6)


@pytest.mark.serial
@pytest.mark.parametrize("bars", [GIVEN, OPEN])
def test_heat_flows_through_bars_and_interface_alike(bars):
    exact = bars.exact()
    across = exact["h"] * (exact["casting"] - exact["mould"])
    inside = bars.conductivity[1] * (exact["mould"] - bars.ends[1]) / bars.lengths[1]
    assert (across, inside) == pytest.approx((exact["q"], exact["q"]), rel=1e-9)


def test_a_coarse_run(comm):
    coarse_run(VERIFICATION, comm)
