"""The cold-crack index of cells: the largest ratio of all steps in which they are solid."""

import numpy as np

from castx.foundry.stress.cold_cracks import BodyColdCracks
from castx.results.states.snapshot import ProcessState
from castx.tables import Table
from tests.castx.fakes import FakeSnapshot, slab_mesh

STRENGTH = Table(np.array([0.0, 500.0]), np.array([200e6, 100e6]))


def at(mesh, temperature, stress, solid=1.0, renewed=()):
    return FakeSnapshot(
        0.0,
        0,
        mesh,
        formulas={
            "temperature": lambda x: np.full(len(x), temperature),
            "solid_fraction": lambda x: np.full(len(x), solid),
            "largest_principal_stress": lambda x: np.full(len(x), stress),
        },
        process=ProcessState(renewed=frozenset(renewed)),
    )


def test_the_largest_ratio_of_the_cooling(comm):
    mesh = slab_mesh(comm, 1e-3, 3e-3)
    cracks = BodyColdCracks(mesh.bodies["casting"], STRENGTH, melts=True)
    for temperature, stress, solid, exact in (
        (600.0, 50e6, 0.99, np.nan),
        (500.0, -10e6, 1.0, 0.0),
        (250.0, 75e6, 1.0, 0.5),
        (0.0, 80e6, 1.0, 0.5),
        (500.0, 60e6, 1.0, 0.6),
        (600.0, 60e6, 0.0, np.nan),
        (500.0, 10e6, 1.0, 0.1),
    ):
        cracks.update(at(mesh, temperature, stress, solid))
        np.testing.assert_allclose(cracks.index, exact, rtol=1e-12)
    cracks.update(at(mesh, 500.0, 5e6, renewed=["casting"]))
    np.testing.assert_allclose(cracks.index, 0.05, rtol=1e-12)


def test_the_index_is_saved(comm):
    mesh = slab_mesh(comm, 1e-3, 3e-3)
    cracks, other = (
        BodyColdCracks(mesh.bodies["casting"], STRENGTH, melts=False) for _ in range(2)
    )
    cracks.update(at(mesh, 500.0, 60e6, solid=0.0))
    other.restore({name: saved.values for name, saved in cracks.saved().items()})
    other.update(at(mesh, 500.0, 10e6))
    np.testing.assert_allclose(other.index, 0.6, rtol=1e-12)
