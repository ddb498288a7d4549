"""Gap heat law `none`: nothing is conducted; radiation may pass."""

from __future__ import annotations

from castx.transfer.conductance import ConstantConductance
from castx.transfer.declaration import GapHeatLaw, Given
from castx.transfer.keys import CURVED, RADIATION


def build(given: Given) -> ConstantConductance:
    """Return the law that conducts nothing."""
    return ConstantConductance()


LAW = GapHeatLaw(
    name="none",
    summary="Nothing is conducted; radiation may pass.",
    formula="h = 0",
    source="limit h → 0 of q = h (T_secondary − T_primary)",
    build=build,
    useful=(RADIATION, CURVED),
    exchange="none",
)
