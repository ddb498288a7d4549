"""Strain and stress of the cooling against what the metal bears: tearing of the mush, cold cracks.

Public: `strains.BodyStrains`, `cold_cracks.BodyColdCracks`, `cracks.Cracks`.
"""
