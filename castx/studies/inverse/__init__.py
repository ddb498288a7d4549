"""Numbers of a case identified from measured curves by runs of it, and checks of all studies.

Public: `parameters.Parameters`, `sensors.Sensors`, `model.MeasuredCase`, `identify.identify`,
`design.design`, `estimates.Estimates`, `checking.refuse_useless_studies`.
"""
