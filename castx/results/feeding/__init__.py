"""Feeders: their levels and pipes, and how far they feed.

Public: `draining.drained`, `pipe.BodyPipe`, `feeders.Feeders`,
`geodesic.shortest_paths`, `feeding_path.FeedingReach`.
"""
