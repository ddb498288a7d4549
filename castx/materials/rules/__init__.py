"""What the files of flow rules and hardening rules declare, and what their formulas build on.

Public: `flow_rule.FlowRule`, `hardening_rule.HardeningRule`, `key.RuleKey`,
`overstress.Overstress`, `overstress.RateOverstress`, `power_law.PowerLaw`.
"""
