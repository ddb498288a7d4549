"""When the front of solidification passes a node: control volumes, levels, gradients.

Public: `control_volumes.ControlVolumes`, `passing.Level`, `passing.Front`, `gradients.Steepness`.
"""
