"""Mid-sides of the edges of triangles and tetrahedra, where displacements are quadratic.

Public: `bubbles.bubble_element`, `midsides.Midsides`.
"""
