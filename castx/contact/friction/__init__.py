"""Coulomb friction of node pairs: condensed, and by a penalty.

Public: `coulomb.SlidingRows`, `method.Friction`, `condensed.CondensedFriction`,
`penalty.PenaltyFriction`
"""
