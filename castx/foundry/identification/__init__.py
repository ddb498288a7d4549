"""What measured temperatures tell of interface data: covariance, correlation, when to measure.

Public: `covariance.posterior`, `covariance.correlation`, `lumped.LumpedCooling`,
`sobol.first_order_indices`.
"""
