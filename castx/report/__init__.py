"""Pictures, curves and the report of a run, and figures of materials and interfaces.

Public: `drawing.draw`, `drawing.Drawing`, `interface_law.heat_transfer_coefficient`,
`reported.ReportedRun`, `material_figure.write_figure`, `interface_figure.write_interface_figure`,
`pictures.picture`, `pictures.View`, `moments.moments`, `style.figure`, `display.display`.
"""
