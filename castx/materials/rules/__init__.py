"""What a flow rule and a hardening rule declare, and how their files are found.

Public: `flow_rule.FlowRule`, `hardening_rule.HardeningRule`, `key.Key`,
`overstress.Overstress`, `overstress.RateOverstress`, `power_law.PowerLaw`, `registry.rules_of`.
"""
