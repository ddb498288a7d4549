"""Surfaces through which castings are fed: which bodies have some, and their facets."""

from __future__ import annotations

from pathlib import Path

import pytest

from castx.case.reading.read import read_case
from castx.foundry.pools.feeding_surfaces import FeedingSurfaces
from castx.foundry.stress.fed_surface import fed_facets, fed_surfaces
from tests.castx.fakes import cylinder_mesh
from tests.verification.test_mush_flow import MUSH
from tests.verification.test_rest_and_sealed_boxes import box


def found(*changes, feeders=None, feeding="pockets"):
    """Return the surfaces of the casting in an open box."""
    data = box({"geometry": {"lid": False}}, MUSH, *changes)
    data["bodies"][0] |= {"feeding": feeding}
    if feeders is not None:
        data["foundry"] = {"feeders": feeders}
    return fed_surfaces(read_case(data, Path("case.toml")))


def test_pockets_are_fed_by_all_free_surfaces_whatever_is_named():
    for feeders in (None, [], ["casting/top"]):
        surfaces = found(feeders=feeders)["casting"]
        assert surfaces.named is None and surfaces.facing == {"casting/mould": "mould"}


@pytest.mark.parametrize(
    ("feeders", "named"), [(None, None), ([], ()), (["casting/top"], ("top",))]
)
def test_flow_through_the_mush_is_fed_by_what_is_named(feeders, named):
    assert found(feeders=feeders, feeding="darcy")["casting"].named == named


def test_metal_without_liquid_and_moulds_are_not_fed():
    assert list(found()) == ["casting"]
    assert not found({"materials": {"alloy": {"liquid": "none"}}})


def test_a_casting_without_a_mould_is_compared_whole():
    data = box()
    data["bodies"], data["interfaces"] = data["bodies"][:1], []
    data["geometry"] = {"generator": "slab", "model": "plane-strain", "length": 0.1, "width": 0.1,
                        "size": 0.05}  # fmt: skip
    assert not fed_surfaces(read_case(data, Path("case.toml")))


@pytest.mark.ranks
def test_facets_are_those_that_are_free_or_named(comm):
    body = cylinder_mesh(comm, size=6e-3).bodies["casting"]
    facing = {"casting/mould": "mould"}
    top = set(body.facet_tags.find(body.surface_tag("top")).tolist())
    open_ones = FeedingSurfaces(None, ("base",), facing)
    assert set(fed_facets(body, "axisymmetric", open_ones).tolist()) == top
    assert set(fed_facets(body, "axisymmetric", FeedingSurfaces(("top",))).tolist()) == top
    assert not len(fed_facets(body, "axisymmetric", FeedingSurfaces(())))
