"""Kinds of values in a case file: quantities with units, choices, tables, coordinates.

Public: `units.Dimension`, `units.number`, `entries.Description`, `entries.Quantity`,
`entries.Tabulated`, `entries.Choice`, `entries.Whole`, `entries.Name`, `variation.Variation`,
`variation.Varying`, `formulas.Formula`, `placed.Placing`, `located.PlacedThere`,
`problems.Problem`, `problems.Refusal`, `overrides.apply_overrides`, `coordinates.coordinate`,
`registry.declarations`, `printable.printable`,
`toml_text.parse_toml`, `sourced.UNKNOWN_SOURCE`, `child_process.run_apart`.
"""
