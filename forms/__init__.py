"""The weak forms of heat and mechanics, and their geometry, as pure UFL functions.

Public: `momentum.mixed_internal_virtual_work`, `momentum.mixed_tangent`,
`momentum.displacement_internal_virtual_work`, `momentum.displacement_tangent`,
`momentum.deviatoric_virtual_work`, `momentum.dilatation`, `clamp.clamp_work`,
`clamp.backing_work`, `stabilisation.tau`,
`stabilisation.weighted_gradient`, `heat.conduction`, `kinematics.strain`, `nodal.nodal_measure`,
`nodal.nodal_area_vector`.
"""
