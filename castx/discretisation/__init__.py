"""What the cells of a mesh leave out: recovered stress and heat flux, and errors by them.

Public: `cell_flux.CellHeatFlux`, `recovery.PatchRecovery`, `cell_errors.CellErrors`,
`flux_errors.FluxErrors`.
"""
