"""Melt that flows through a mush: its metal, permeability, content, feeders and pores.

Public: `metal.MushMetal`, `permeability.step_permeability`, `arms.RunningArms`,
`content.MeltContent`, `feeding.FedNodes`, `levels.FeederLevels`, `sinking.SinkingLevels`,
`pores.PoreSet`, `wall.WallMelt`.
"""
