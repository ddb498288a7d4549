"""A run tells by how much cells in the skin of its casting may put the freezing time off."""

from __future__ import annotations

import logging
from pathlib import Path

import pytest

from castx.case.reading.read import read_case
from castx.command.watches.skins import skin_errors, tell_of_skins
from castx.domain.mesh import build_mesh
from castx.domain.summary import mesh_summary
from tests.coupled_cases import cylinder


def told(comm, caplog, size: float) -> tuple[float, list[tuple[int, str]]]:
    """Return the error in a cylinder with cells of a size, and what is logged."""
    bodies = [{"name": "casting", "material": "AlSi7Mg", "temperature": 670.0},
              {"name": "mould", "material": "steel-H13", "temperature": 200.0}]  # fmt: skip
    case = read_case(cylinder({"bodies": bodies}, size=size), Path("case.toml"))
    mesh = build_mesh(case.geometry, [body.name for body in case.bodies], comm)
    caplog.clear()
    with caplog.at_level(logging.INFO):
        tell_of_skins(case, mesh)
    ((error, text),) = skin_errors(case, mesh_summary(mesh))
    assert "freezing time" in text or "fine enough" in text
    return error, [(record.levelno, record.getMessage()) for record in caplog.records]


@pytest.mark.ranks
def test_coarse_skins_are_told_and_very_coarse_ones_warned_of(comm, caplog):
    for size, low, high, level in (
        (0.003, 0.05, 0.2, logging.INFO), (0.015, 0.2, 1.0, logging.WARNING),
    ):  # fmt: skip
        error, lines = told(comm, caplog, size)
        assert low <= error < high
        assert [number for number, _ in lines] == ([level] if comm.rank == 0 else [])
    error, lines = told(comm, caplog, 0.0005)
    assert error < 0.05 and not lines
