"""A mesh that cannot fit into memory is refused with the estimate, before it is made."""

import time

import pytest

from castx.case.geometry import Geometry
from castx.command.cli import execute
from castx.domain.memory import available_memory, estimated_elements, refuse_too_large
from castx.domain.source import named_mesh
from castx.errors import MeshError

NAMES = ("casting", "mould")
SIZES = {"radius": 0.03, "height": 0.1, "wall": 0.025}


def geometry(**arguments):
    return Geometry.model_validate({"generator": "cylinder_in_mould", **SIZES, **arguments})


@pytest.mark.serial
@pytest.mark.parametrize(
    "arguments",
    [
        {"model": "axisymmetric", "size": 5e-4},
        {"model": "axisymmetric", "size": 5e-4, "cells": "quadrilaterals"},
        {"model": "axisymmetric", "size": 2e-3, "interface_size": 4e-4},
        {"model": "3d", "size": 3e-3, "sector": "quarter"},
    ],
)
def test_the_estimate_is_about_right(arguments):
    described = geometry(**arguments)
    elements = len(named_mesh(described, NAMES).cells)
    assert estimated_elements(described, NAMES) == pytest.approx(elements, rel=0.3)


def test_what_is_free_decides(comm, monkeypatch):
    described = geometry(model="3d", size=2e-3)
    refuse_too_large(described, NAMES, comm, solved=True)
    monkeypatch.setattr("castx.domain.memory.available_memory", lambda: 3e9)
    refuse_too_large(described, NAMES, comm, solved=False)
    with pytest.raises(MeshError, match=r"about [89].*; solving with them needs") as no:
        refuse_too_large(described, NAMES, comm, solved=True)
    fitting = float(str(no.value).split("geometry.size of ")[1].split(" m")[0])
    refuse_too_large(geometry(model="3d", size=fitting), NAMES, comm, solved=True)
    monkeypatch.setattr("castx.domain.memory.available_memory", lambda: 5e8)
    with pytest.raises(MeshError, match=r"the mesh alone needs about .* GB"):
        refuse_too_large(described, NAMES, comm, solved=False)


@pytest.mark.ranks
def test_a_file_is_judged_by_its_length(comm, shared_tmp_path, monkeypatch):
    path = shared_tmp_path / "part.msh"
    if comm.rank == 0:
        path.write_bytes(b" " * 4_000_000)
    comm.Barrier()
    described = Geometry.model_validate({"model": "3d", "file": str(path)})
    refuse_too_large(described, NAMES, comm, solved=True)
    monkeypatch.setattr("castx.domain.memory.available_memory", lambda: 2e8)
    with pytest.raises(MeshError, match=r"part\.msh: about 1\.0e\+05 elements; .* coarser mesh"):
        refuse_too_large(described, NAMES, comm, solved=True)


@pytest.mark.serial
def test_the_computer_tells_what_is_free():
    assert 1e7 < available_memory() < 1e14


@pytest.mark.ranks
def test_a_run_is_refused_soon(comm, shared_tmp_path, capsys):
    """Some 10⁸ tetrahedra: hundreds of gigabytes."""
    path = shared_tmp_path / "case.toml"
    text = """
[geometry]
generator = "cylinder_in_mould"
model = "3d"
radius = "300 mm"
height = "1 m"
wall = "250 mm"
size = "2.5 mm"
[[bodies]]
name = "casting"
material = "Al-pure"
temperature = 700
[[bodies]]
name = "mould"
material = "steel-H13"
temperature = 200
[time]
end = 1
"""
    if comm.rank == 0:
        path.write_text(text)
    comm.Barrier()
    begin = time.monotonic()
    assert execute(["run", str(path), "--output", str(shared_tmp_path / "out")], comm) == 2
    assert time.monotonic() - begin < 10.0
    said = comm.bcast(" ".join(capsys.readouterr().err.split()))
    assert "elements; solving with them needs about" in said and "would fit" in said
