"""A case of two blocks of a CAD file that are warm side by side: a casting on its die."""

from __future__ import annotations

from pathlib import Path

from mpi4py import MPI

from tests.cad_files import two_blocks, write_cad

CASE = """
[geometry]
model = "3d"
file = "two.step"
size = "5 mm"
across = 1
surfaces = { top = { normal = "+z", body = "casting" }, foot = { normal = "-z", body = "die" } }
[[bodies]]
name = "casting"
material = "Al-pure"
temperature = 700
[[bodies]]
name = "die"
material = "steel-H13"
temperature = 200
[[interfaces]]
bodies = ["casting", "die"]
heat = { closed = 5000, law = "constant" }
[[boundaries]]
on = "casting/top"
heat = { type = "convection", coefficient = 10, ambient = 20 }
[[boundaries]]
on = "die/foot"
displacement = { all = 0 }
[coupling]
scheme = "thermal"
[time]
end = "2 s"
fixed_step = "0.5 s"
"""


def two_blocks_case(comm: MPI.Intracomm, folder: Path) -> Path:
    """Write part and case into a folder, and return the path of the case; collective."""
    case = folder / "two.toml"
    if comm.rank == 0:
        write_cad(folder / "two.step", two_blocks, ["casting", "die"])
        case.write_text(CASE)
    comm.Barrier()
    return case
