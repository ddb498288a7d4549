"""Maps of bodies and interfaces: heat flux, and the first opening of gaps.

Public: `heat_flux.HeatFluxes`, `first_opening.FirstOpenings`.
"""
