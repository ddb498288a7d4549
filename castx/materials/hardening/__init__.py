"""The hardening rules, one file each: how the yield surface grows and moves with plastic strain.

Public: `linear.RULE`, `prager.RULE`, `voce.RULE`.
"""
