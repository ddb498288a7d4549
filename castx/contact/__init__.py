"""Contact of all interfaces: what the methods make of unknowns, rows and matrix of the bodies.

Public: `choice.Contact`, `building.contact_system`, `system.ContactSystem`,
`condensed.CondensedContact`, `multipliers.MultiplierContact`, `soft.SoftContact`
"""
