"""Declarations of flow rules and hardening rules, and the functions from which they are built.

Public: `flow_rule.FlowRule`, `hardening_rule.HardeningRule`, `key.RuleKey`,
`overstress.Overstress`, `overstress.RateOverstress`, `power_law.PowerLaw`.
"""
