"""Heat condition `insulated`: nothing passes."""

from __future__ import annotations

from castx.transfer.conditions.declaration import HeatConditionKind

CONDITION = HeatConditionKind(
    name="insulated",
    summary="No heat passes, as without any condition.",
    formula="q = 0",
    source="H. S. Carslaw, J. C. Jaeger, Conduction of Heat in Solids (1959), section 1.9",
    insulates=True,
)
