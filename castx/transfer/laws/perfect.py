"""Gap heat law `perfect`: facing nodes have one temperature (`castx.heat.perfect_contact`)."""

from __future__ import annotations

from castx.transfer.declaration import GapHeatLaw

LAW = GapHeatLaw(
    name="perfect",
    summary="Perfect thermal contact: facing nodes have one temperature.",
    formula="T_secondary = T_primary",
    source="limit h → ∞ of q = h (T_secondary − T_primary)",
    exchange="perfect",
)
