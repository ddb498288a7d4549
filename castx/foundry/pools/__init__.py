"""Pools of liquid and what feeds them: joined nodes, hot spots, feeders, pipes, feeding paths.

Public: `joined_nodes.NodeRegions`, `heritage.Heritage`, `pool.Pool`, `tracking.BodyPools`,
`feeding_surfaces.FeedingSurfaces`, `feeding_surfaces.FeedingNodes`, `pooled_metal.PooledMetal`,
`hot_spots.HotSpots`, `draining.drained`, `pipe.BodyPipe`, `feeders.Feeders`,
`geodesic.shortest_paths`, `feeding_path.FeedingReach`.
"""
