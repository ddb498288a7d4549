"""Displacements and interferences of the size of a body are refused with place, value and size."""

from pathlib import Path

import pytest

from castx.case.reading.read import read_case
from castx.errors import CaseError
from castx.process.plausible import refuse_absurd_displacements, size_of
from tests.castx.case_data import cylinder
from tests.castx.fakes import cylinder_mesh
from tests.partitions import PARTITION, on_the_last


def refuse(comm, **changes):
    case = read_case(cylinder(**changes), Path("case.toml"))
    refuse_absurd_displacements(case, cylinder_mesh(comm))


@pytest.mark.ranks
def test_the_size_is_the_largest_extent_on_all_ranks(comm):
    mesh = cylinder_mesh(comm)
    points = [comm.allgather(body.points) for body in mesh.bodies.values()]
    for name, found in zip(mesh.bodies, points, strict=True):
        low = min(p.min(axis=0).tolist() for p in found if len(p))
        high = max(p.max(axis=0).tolist() for p in found if len(p))
        assert size_of(mesh, name) == pytest.approx(max(high[1] - low[1], high[0] - low[0]))


@pytest.mark.ranks
def test_ranks_without_cells_know_the_size(comm, monkeypatch):
    monkeypatch.setattr(PARTITION, on_the_last)
    assert size_of(cylinder_mesh(comm), "casting") == pytest.approx(0.04)


def lifted(value):
    return [{"on": "casting/base", "displacement": {"normal": value}}]


def test_what_a_part_can_do_is_accepted(comm):
    refuse(comm)
    refuse(comm, boundaries=lifted([[0, 0], [1, "-1 mm"]]))
    refuse(comm, interfaces__0__contact={"initial_gap": "5 m"})
    refuse(comm, interfaces__0__contact={"initial_gap": "-1 mm"})


@pytest.mark.parametrize("value", ["1 m", "-1 m", [[0, 0], [1, "-1 m"], [2, 0]]])
def test_a_displacement_larger_than_the_body_is_refused(comm, value):
    message = r"boundary 'casting/base', displacement normal: 1 m, and 'casting' is 0\.\d+ m large"
    with pytest.raises(CaseError, match=message):
        refuse(comm, boundaries=lifted(value))


@pytest.mark.ranks
def test_an_interference_larger_than_a_body_is_refused(comm):
    with pytest.raises(CaseError, match=r"initial_gap: an interference: 0\.5 m, and 'casting'"):
        refuse(comm, interfaces__0__contact={"initial_gap": "-0.5 m"})


def test_rigid_bodies_may_move_far_and_heat_alone_moves_nothing(comm):
    out = [{"on": "mould/base", "displacement": {"normal": "1 m"}}]
    with pytest.raises(CaseError, match="and 'mould' is"):
        refuse(comm, boundaries=out)
    refuse(comm, bodies__1__law="rigid", boundaries=out)
    refuse(comm, coupling={"scheme": "thermal"}, boundaries=lifted("1 m"))
