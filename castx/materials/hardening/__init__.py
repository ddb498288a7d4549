"""The hardening rules, one file each: how the yield surface grows and moves with plastic strain.

Public: `linear.RULE`, and the object of the same name in each other file.
"""
