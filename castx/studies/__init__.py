"""Studies of a case by many runs: how its answers hang on numbers, and what is best.

Inside: `asked` reads the tables of a study, `runs` makes its runs and keeps them.

Public: `vary.vary`, `vary.sampled`, `effects.lines`, `effects.elementary`,
`effects.variance_shares`, `table.StudyTable`, `optimise.optimise`.
"""
