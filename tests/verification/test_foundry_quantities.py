"""V3: local solidification time and Niyama value of an alloy on a chilled wall.

Half-space, freezing range 560 to 615 °C with f_s linear in T, initially 640 °C, wall at 300 °C.
By similarity both fronts go with √t, so that at a distance x from the wall
    t_f = (1/7.527429e-3² - 1/1.0481317e-2²) x² = 8545.79 x² s/m²,
and the Niyama value G/√Ṫ at f_s = 0.9 is the same everywhere: 2740.71 K^½ s^½/m.
Source: `castx/proof/verification/coupled/chilled_alloy.py`.
Tolerances at 20 to 28 elements from the wall: Niyama value 1 % (a node sees the front in phases of
the element, which does not fall further), t_f 3.5 % in the mean, falling with element and step.
"""

from pathlib import Path

from mpi4py import MPI

import numpy as np
import pytest

from castx.case.reading.read import read_case
from castx.foundry.front.solidification import Solidification
from castx.materials.lookup import find_material
from castx.process.simulation import Simulation
from castx.proof.verification.coupled.chilled_alloy import ChilledAlloy

ALLOY = ChilledAlloy()
NIYAMA, TIME = ALLOY.half_space.niyama(), ALLOY.freezing
END = 5.0


def chilled_wall(size, step):
    """Return the case of V3."""
    content = {
        "geometry": {
            "generator": "slab",
            "model": "plane-strain",
            "length": 0.06,
            "width": 2 * size,
            "size": size,
        },
        "materials": {"alloy": ALLOY.half_space.material()},
        "bodies": [{"name": "casting", "material": "alloy", "temperature": 640}],
        "boundaries": [{"on": "casting/wall", "heat": {"type": "temperature", "value": 300}}],
        "time": {"end": END, "first_step": step, "largest_step": step, "fixed_step": step},
        "coupling": {"scheme": "thermal"},
    }
    return read_case(content, Path("v3.toml"))


def errors(comm, size, step):
    """Return mean and largest relative error of Niyama value and solidification time."""
    case = chilled_wall(size, step)
    simulation = Simulation.from_case(case, comm)
    curve = find_material("alloy", case.materials).enthalpy
    solidification = Solidification(simulation.mesh, {"casting": curve})
    for state in simulation:
        solidification.update(state)
    points = simulation.mesh.bodies["casting"].nodes.tabulate_dof_coordinates()[:, 0]
    here = (points > 0.0099) & (points < 0.0141)
    niyama = solidification.nodal("casting", "niyama")[here] / NIYAMA - 1.0
    time = solidification.nodal("casting", "solidification_time")[here]
    time = time / (TIME * points[here] ** 2) - 1.0
    simulation.destroy()
    return [summary(comm, np.abs(error)) for error in (niyama, time)]


def summary(comm, error):
    total, count = comm.allreduce(error.sum()), comm.allreduce(error.size)
    return total / count, comm.allreduce(error.max(initial=0.0), MPI.MAX)


@pytest.fixture(scope="module")
def fine():
    return errors(MPI.COMM_WORLD, 0.5e-3, 0.02)


def test_the_niyama_value_is_the_same_everywhere(fine):
    (mean, largest), _ = fine
    assert mean < 0.01 and largest < 0.03


def test_the_local_solidification_time_grows_with_the_square_of_the_distance(fine):
    _, (mean, _) = fine
    assert mean < 0.035


def test_the_error_falls_with_element_and_step(comm, fine):
    _, (coarser, _) = errors(comm, 1e-3, 0.04)
    _, (finer, _) = fine
    assert coarser > 1.6 * finer
