"""The error of the heat flux by hand, summed over time, and a run that goes on."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from castx.case.fields.heat import FLUX_ERROR
from castx.case.reading.read import read_case
from castx.discretisation.flux_errors import FluxErrors, flux_errors_of
from castx.errors import CaseError
from tests.castx.fakes import FakeSnapshot, slab_mesh

SIZE, CONDUCTIVITY = 2e-3, 40.0


def potential(temperature):
    return CONDUCTIVITY * temperature


def state(mesh, time, curvature):
    """Return a state with the temperature c x², whose flux -2 k c x cells follow by its mean."""
    formulas = {"temperature": lambda x: curvature * x[:, 0] ** 2}
    return FakeSnapshot(time, 0, mesh, formulas=formulas)


def missed(curvature):
    """Return the spread of the flux within a triangle of half a square."""
    return 2.0 * CONDUCTIVITY * curvature * SIZE / np.sqrt(18.0)


@pytest.mark.ranks
def test_errors_count_as_long_as_they_last(comm):
    mesh = slab_mesh(comm, SIZE)
    found = FluxErrors(mesh, {"casting": potential})
    for time, curvature in ((0.0, 9e9), (1.0, 3e3), (4.0, 1e3)):
        found.update(state(mesh, time, curvature))
    rms = np.sqrt((1.0 * missed(3e3) ** 2 + 3.0 * missed(1e3) ** 2) / 4.0)
    known = found.described()["casting"]
    # The gradient of c x² on a triangle is that in the middle of its edge along x, not of itself.
    assert known["error"] == pytest.approx(rms, rel=0.25)
    flux = 2.0 * CONDUCTIVITY * np.sqrt((9e6 + 3.0 * 1e6) / 4.0 * 0.02**2 / 3.0)
    assert known["size"] == pytest.approx(flux, rel=0.02)
    assert found.field("casting", FLUX_ERROR) == pytest.approx(rms, rel=0.6)
    assert found.field("casting", "heat_flux") is None and found.field("mould", FLUX_ERROR) is None


@pytest.mark.serial
def test_a_run_that_goes_on_has_the_same_errors(comm):
    mesh = slab_mesh(comm, SIZE)
    whole, first, second = (FluxErrors(mesh, {"casting": potential}) for _ in range(3))
    course = ((0.0, 1e3), (1.0, 2e3), (3.0, 4e3))
    for time, curvature in course:
        whole.update(state(mesh, time, curvature))
    for time, curvature in course[:2]:
        first.update(state(mesh, time, curvature))
    second.restore({name: saved.values for name, saved in first.saved().items()})
    second.update(state(mesh, *course[2]))
    assert second.described() == whole.described()


@pytest.mark.serial
def test_nothing_is_known_without_temperatures(comm):
    mesh = slab_mesh(comm, SIZE)
    data = {
        "geometry": {"generator": "slab", "model": "plane-strain", "length": 0.02,
                     "width": 0.008, "size": SIZE},
        "bodies": [{"name": "casting", "material": "steel-H13", "temperature": 20.0}],
        "time": {"end": 1.0}, "coupling": {"scheme": "mechanical"},
    }  # fmt: skip
    case = read_case(data, Path("case.toml"))
    found = flux_errors_of(case, mesh)
    found.update(state(mesh, 0.0, 1.0))
    assert found.described() == {}
    with pytest.raises(CaseError, match="no heat_flux_error in a run with"):
        read_case(data | {"output": {"fields": ["heat_flux_error"]}}, Path("case.toml"))
