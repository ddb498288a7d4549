"""The report of a run, and of several beside each other, as one file for a browser.

Public: `report.write_report`, `comparison.write_page`, `charts.run_sections`,
`shots.Shot`, `assets.page`.
"""
