"""A picture of the bodies of a case before anything is solved: apart from each other, by colours.

Public: `shells.Shell`, `shells.shells_of`, `exploded.write_picture`, `spread.shifts`.
"""
