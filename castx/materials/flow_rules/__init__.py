"""The flow rules, one file each: how fast a material flows at an overstress.

Public: `bingham.RULE`, `norton.RULE`, `perzyna.RULE`.
"""
