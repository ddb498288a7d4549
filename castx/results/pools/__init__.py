"""Pools of liquid: which nodes liquid joins, what feeds it, and what becomes of a pool.

Public: `joined_nodes.NodeRegions`, `heritage.Heritage`, `pool.Pool`, `tracking.BodyPools`,
`feeding_surfaces.FeedingSurfaces`, `feeding_surfaces.FeedingNodes`, `pooled_metal.PooledMetal`.
"""
