"""One declaration for each output field: name, title, unit, place, colours and how it is read.

Public: `declaration.OutputField`, `declaration.FieldColours`, `declaration.StateView`,
`registry.output_fields`.
"""
