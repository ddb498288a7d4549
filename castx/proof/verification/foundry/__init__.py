"""Foundry quantities that are functions of arrays, beside closed forms and adaptive quadrature.

Public: `feeding.scheil_suction`, `tearing.Columnar`, `mush_flow.column`, `cold_part.frame`,
`die_life.strain_of`, `identification.uncertainty`.
"""
