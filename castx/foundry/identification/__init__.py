"""Interface data from measured temperatures: fits, covariance, times and places of sensors.

Public: `fit.fit`, `ensemble.assimilate`, `descent.descend`, `covariance.posterior`,
`covariance.correlation`, `smoothness.second_differences`, `whiteness.ljung_box`,
`directions.unseen`, `sensors.d_optimal`, `sensors.a_optimal`, `lumped.LumpedCooling`,
`sobol.first_order_indices`.
"""
