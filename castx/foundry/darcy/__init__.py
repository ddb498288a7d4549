"""Flow of melt through the skeleton of a mush, on one line: suction, pores, consolidation, levels.

Public: `column.MushResistance`, `column.column_suction`, `moving_front.PoresBehindFront`,
`skeleton.consolidation`, `skeleton.undrained`, `levels.communicating`.
"""
