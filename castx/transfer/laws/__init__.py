"""Gap heat laws, one in each file; `castx.transfer.registry` finds them by itself.

Public: `limited.LAW`, and the object of the same name in each other file.
"""
