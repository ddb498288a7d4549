"""Stress at a point: the law of a body, the return mapping of J2 viscoplasticity, and the history.

Public: `law.Law`, `history.PointHistory`, `response.respond`, `return_mapping.return_mapping`,
`points.MaterialPoints`, `integration_points.IntegrationPoints`, `plane_stress.normal_strain`,
`thickness.Thickness`.
"""
