"""Steps, stages and cycles of a casting process.

Public: `simulation.Simulation`, `process.Process`, `process.StageProblem`, `process.Cycling`,
`building.process_of`, `building.step_settings`, `step_control.StepControl`,
`step_control.StepSettings`, `state.State`, `stage_case.stage_case`, `handover.without`,
`cycles.CycleEnds`, `events.Events`, `ejection.normal_force`, `ejection.ejection_forces`,
`plausible.refuse_absurd_displacements`.
"""
