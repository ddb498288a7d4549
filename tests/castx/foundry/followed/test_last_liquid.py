"""The last liquid of a made-up course: least solid, then hottest; kept once all is solid."""

import numpy as np
import pytest

from castx.case.reading.read import read_case
from castx.foundry.followed.last_liquid import LastLiquid, last_liquid_of
from tests.castx.fakes import FakeSnapshot, cylinder_mesh
from tests.coupled_cases import cylinder


def liquid_at(height):
    """Return fields whose least solid nodes lie at a height, hotter inside."""
    return {
        "solid_fraction": lambda x: np.minimum(0.5 + 20.0 * np.abs(x[:, 1] - height), 0.999),
        "temperature": lambda x: 600.0 - 1000.0 * x[:, 0],
    }


SOLID = {"solid_fraction": lambda x: np.ones(len(x)), "temperature": lambda x: -x[:, 0]}


@pytest.mark.ranks
def test_the_last_place_with_liquid_is_kept(comm):
    mesh = cylinder_mesh(comm, size=5e-3)
    found = LastLiquid(mesh, ["casting"])
    assert found.described() == {}
    for time, formulas in ((0.0, liquid_at(0.0)), (1.0, liquid_at(0.04)), (2.0, SOLID)):
        found.update(FakeSnapshot(time, 1, mesh, formulas=formulas))
    said = found.described()["casting"]
    assert said["time"] == 1.0 and said["place"] == pytest.approx([0.0, 0.04], abs=1e-12)
    later = LastLiquid(mesh, ["casting"])
    later.restore({name: saved.values for name, saved in found.saved().items()})
    later.update(FakeSnapshot(3.0, 1, mesh, formulas=SOLID))
    assert later.described() == found.described()


def test_moulds_and_runs_without_heat_are_not_followed(comm, tmp_path):
    mesh = cylinder_mesh(comm, size=1e-2)
    case = read_case(cylinder(size=0.01), tmp_path / "case.toml")
    assert list(last_liquid_of(case, mesh).saved()) == ["casting"]
    mechanical = case.model_copy(
        update={"coupling": case.coupling.model_copy(update={"scheme": "mechanical"})}
    )
    assert last_liquid_of(mechanical, mesh).saved() == {}
