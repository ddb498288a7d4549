"""Maps of what passes bodies and interfaces: heat flux, and when gaps opened first.

Public: `heat_flux.HeatFluxes`, `first_opening.FirstOpenings`.
"""
