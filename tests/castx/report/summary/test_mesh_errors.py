"""What a report says about errors by the mesh."""

import pytest

from castx.report.summary.mesh_errors import mesh_errors
from tests.castx.report.summary.fake_run import run

pytestmark = pytest.mark.serial


def test_errors_of_stress_and_heat_flux_stand_among_the_findings():
    error = {"error": 2e6, "size": 16e6, "relative": 0.124}
    flux = {"error": 5e3, "size": 1e5, "relative": 0.05}
    ends = [{"stage": 0, "time": 60.0, "bodies": {"casting": {"stress_error": error}, "mould": {}}}]
    record = run().record | {"stage_ends": ends, "flux_errors": {"mould": flux}}
    stress, heat = mesh_errors(run(record=record))
    assert (stress.name, stress.number) == ("Error of the stress by the mesh: casting", "12.4 %")
    assert stress.sentence.startswith("2 MPa of 16 MPa, root mean squares over what is solid")
    assert (stress.time, stress.of_mesh) == (60.0, True)
    assert (heat.name, heat.number) == ("Error of the heat flux by the mesh: mould", "5 %")
    assert heat.sentence.startswith("5 kW/m² of 100 kW/m²") and heat.of_mesh


@pytest.mark.parametrize(("size", "shown"), [(0.9, 0), (1.1, 1)])
def test_a_body_without_stress_has_no_error_of_it(size, shown):
    """A core that nothing touches bears rounding errors alone."""
    error = {"error": 0.5 * size, "size": size, "relative": 0.5}
    ends = [{"stage": 0, "time": 60.0, "bodies": {"core": {"stress_error": error}}}]
    assert len(list(mesh_errors(run(record=run().record | {"stage_ends": ends})))) == shown
