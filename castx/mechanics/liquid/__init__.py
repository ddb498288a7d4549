"""Liquid of a body: where it is cut off, what it shrinks by, what is fed and where pores open.

Public: `feeding_paths.FeedingPaths`, `content.Content`, `pores.Pores`,
`pressures.PocketPressures`, `stiffness.PocketStiffness`, `regions.CellRegions`.
"""
