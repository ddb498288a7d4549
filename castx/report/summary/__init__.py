"""Findings of a run, as numbers with place, time and a sentence.

Public: `finding.Finding`, `finding.Shown`, `registry.FINDERS`, `registry.findings`,
`rows.further_rows`, `rows.numeric_rows`, `hot_spots.hot_spot_table`.
"""
