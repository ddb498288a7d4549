"""When the front of solidification passes a node: control volumes, levels, gradients.

Public: `control_volumes.ControlVolumes`, `levels.Level`, `passing.Front`, `lasting.Lasting`,
`windows.Window`, `gradients.Steepness`, `solidification.Solidification`.
"""
