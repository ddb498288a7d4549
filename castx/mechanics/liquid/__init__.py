"""Liquid of a body: its isolation, shrinkage and feeding, and where pores open.

Public: `feeding_paths.FeedingPaths`, `content.Content`, `pores.Pores`,
`pressures.PocketPressures`, `stiffness.PocketStiffness`, `regions.CellRegions`.
"""
