"""Pictures, curves and the report of a run, figures of materials, and curves of interface laws.

Public: `drawing.draw`, `drawing.Drawing`, `interface_law.heat_transfer_coefficient`,
`report.write_report`, `material_figure.write_figure`, `pictures.picture`, `pictures.View`,
`moments.moments`, `curves.curves`, `display.display`.
"""
