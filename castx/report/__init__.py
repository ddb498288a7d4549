"""Pictures, curves and the report of a run, and figures of materials and interfaces.

`exploded` shows a case before it is run, its bodies apart; `browser_scene` packs meshes and fields
for a browser. `summary` finds numbers with place, time and a sentence; `page` is the report.

Public: `drawing.draw`, `drawing.Drawing`, `interface_law.heat_transfer_coefficient`,
`reported.ReportedRun`, `material_figure.write_figure`, `interface_figure.write_interface_figure`,
`pictures.picture`, `pictures.View`, `moments.moments`, `style.figure`, `display.display`,
`shells.shells_of`, `exploded.write_picture`, `spread.shifts`, `browser_scene.scene`,
`sunk_bodies.Pipes`, `packing.packed`, `packing.packed_values`, `topics.TOPICS`, `topics.Topic`.
"""
