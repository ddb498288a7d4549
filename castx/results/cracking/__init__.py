"""Strain and stress of cooling against limits of the metal: tearing of the mush, cold cracks.

Public: `strains.BodyStrains`, `cold_cracks.BodyColdCracks`, `cracks.Cracks`.
"""
