"""Description of a case by the user: every key of a case file, checked and in SI units.

Public: `case.Case`, `bodies.Body`, `boundaries.Boundary`, `caveats.caveats`,
`coherency.coherencies`, `coherency.sensitivity_command`, `contact.InterfaceContact`,
`control.Time`, `geometry.Geometry`, `heat_transfer.InterfaceHeat`,
`interfaces.Interface`, `output.Output`, `stages.Stage`.
"""
