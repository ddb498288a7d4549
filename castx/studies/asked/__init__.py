"""What a study of many runs is asked for: the tables of a case file that a single run leaves alone.

Public: `amounts.Amount`, `runner.Running`, `inputs.VariedInput`, `vary.Vary`,
`identify.Identify`, `optimise.Optimise`, `reading.read_study`.
"""
