"""Pools of liquid: which nodes liquid joins, and what becomes of a pool from step to step.

Public: `joined_nodes.NodeRegions`, `heritage.Heritage`, `pool.Pool`, `tracking.BodyPools`.
"""
