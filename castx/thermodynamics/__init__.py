"""Solidification after thermodynamic databases, with the packages of the extra `calphad`.

Public: `scheil.Composition`, `scheil.scheil_table`, `scheil.case_text`.
"""
