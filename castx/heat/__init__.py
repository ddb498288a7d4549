"""Enthalpy of all bodies: nodal balances, exchange between facing surfaces, book-keeping of heat.

Public: `problem.HeatProblem`, `problem.HeatReport`, `body.HeatBody`, `boundaries.SurfaceHeat`,
`interface.HeatExchange`, `ledger.Accounts`, `ledger.Ledger`, `building.surface_heats`,
`building.heat_exchange`, `building.initial_state`, `building.run_accounts`.
"""
