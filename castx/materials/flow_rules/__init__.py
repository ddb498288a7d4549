"""The flow rules, one file each: how fast a material flows at an overstress.

Public: `perzyna.RULE`, and the object of the same name in each other file.
"""
