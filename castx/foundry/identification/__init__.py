"""What measured temperatures tell of interface data: fits, covariance, when and where to measure.

Public: `fit.fit`, `covariance.posterior`, `covariance.correlation`,
`smoothness.second_differences`, `whiteness.ljung_box`, `directions.unseen`, `sensors.d_optimal`,
`sensors.a_optimal`, `lumped.LumpedCooling`, `sobol.first_order_indices`.
"""
