"""Stress at a point: the law of a body, return mapping of metals and of grains, and the history.

Public: `granular_points.GranularPoints`, `law.Law`, `history.PointHistory`, `response.respond`,
`return_mapping.return_mapping`, `points.MaterialPoints`, `integration_points.IntegrationPoints`,
`plane_stress.normal_strain`, `thickness.Thickness`.
"""
