"""Pools of liquid: connected nodes, the surfaces that feed them, and their course in time.

Public: `joined_nodes.NodeRegions`, `heritage.Heritage`, `pool.Pool`, `tracking.BodyPools`,
`feeding_surfaces.FeedingSurfaces`, `feeding_surfaces.FeedingNodes`, `pooled_metal.PooledMetal`.
"""
