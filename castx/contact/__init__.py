"""Contact of all interfaces: unknowns, rows and matrix of the bodies under the contact methods.

Public: `choice.Contact`, `building.contact_system`, `system.ContactSystem`,
`condensed.CondensedContact`, `multipliers.MultiplierContact`, `soft.SoftContact`
"""
