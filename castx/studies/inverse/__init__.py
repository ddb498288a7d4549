"""Numbers of a case identified from measured curves by runs of it.

Public: `parameters.Parameters`, `sensors.Sensors`, `model.MeasuredCase`, `identify.identify`,
`design.design`, `estimates.Estimates`.
"""
