"""Pictures, curves and the report of a run, and figures of materials.

Public: `report.write_report`, `material_figure.write_figure`, `pictures.picture`, `pictures.View`,
`curves.curves`, `display.display`.
"""
