"""Heat and deformation together, foundry quantities: exact solutions and the runs beside them.

Public: `expanding_bars.Bars`, `chilled_alloy.ChilledAlloy`.
"""
