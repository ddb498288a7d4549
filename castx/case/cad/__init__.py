"""CAD files as the geometry of a case: solids, named surfaces, sizes of cells.

Public: `geometry.CadGeometry`, `selectors.FaceSelector`, `sizes.LocalSize`,
`mould.CadMould`, `template.case_text`.
"""
