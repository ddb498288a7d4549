"""What is shown of CAD files."""

from __future__ import annotations

from dataclasses import replace

import pytest

from castx.command.cad_report import difference_text, quality_text
from castx.command.cli import execute
from castx.meshes.cad.cells import Quality
from castx.meshes.cad.report import Measure
from tests.cad_files import two_blocks, write_cad

CASE = """
[geometry]
model = "3d"
file = "two.step"
size = "10 mm"
surfaces = { top = { normal = "+z", body = "casting" }, far = { normal = "+x", body = "die" } }
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
heat = { closed = 2000, law = "constant" }
[[boundaries]]
on = "casting/top"
heat = { type = "convection", coefficient = 10, ambient = 20 }
[time]
end = "1 s"
"""


@pytest.mark.parametrize(
    "cad, mesh, text", [(1.0, 1.0 + 1e-12, "0 %"), (2.0, 1.97, "-1.5 %"), (1.0, 1.001, "+0.1 %")]
)
def test_differences(cad, mesh, text):
    assert difference_text(Measure("a", 1, cad, mesh)) == text


def test_quality_in_words():
    quality = Quality(9, 0.75, 0.0521, (0.0, 0.01, 2.0), 2, 0.001, 0.0031)
    assert quality_text(quality) == (
        "9 cells with edges of 0.001 to 0.0031 m; quality 0.75 in the mean, 0.052 in the worst, "
        "at (0, 0.01, 2) m; 2 cells are below 0.1"
    )
    assert quality_text(replace(quality, poor=0)).endswith("m; none is below 0.1")


def test_check_shows_what_was_selected_with_its_area(comm, shared_tmp_path, said):
    case = shared_tmp_path / "two.toml"
    if comm.rank == 0:
        write_cad(shared_tmp_path / "two.step", two_blocks, ["casting", "die"])
        case.write_text(CASE)
    comm.Barrier()
    assert execute(["check", str(case)], comm) == 0
    text = said()
    for line in (
        "body casting             1       4 cm³    4 cm³    0 %",
        "interface casting/die    1       4 cm²    4 cm²    0 %",
        "surface casting/top      1       4 cm²    4 cm²    0 %",
        "surface die/far          1       2 cm²    2 cm²    0 %",
        "surface die/outside      5       16 cm²   16 cm²   0 %",
    ):
        assert " ".join(line.split()) in " ".join(text.split())
    assert "in the worst, at (" in text
    other = 'interfaces=[{ bodies = ["die", "casting"], heat = { closed = 9, law = "constant" } }]'
    assert execute(["check", str(case), "--set", other], comm) == 0
    assert "interface die/casting 1 4 cm²" in " ".join(said().split())
    assert execute(["check", str(case), "--set", "geometry.surfaces.top.radius=1"], comm) == 2
    assert "'top' selects no face; there are" in said()


def test_a_bad_file_is_refused_with_code_2_and_one_message(comm, shared_tmp_path, said):
    case, part = shared_tmp_path / "two.toml", shared_tmp_path / "two.step"
    for content, text in (("", "is empty"), ("ISO-10303-21;\nHEADER;\n", "cannot be read")):
        if comm.rank == 0:
            part.write_text(content)
            case.write_text(CASE)
        comm.Barrier()
        assert execute(["check", str(case)], comm) == 2
        output = " ".join(said().split())
        assert text in output and output.count("castx: ") == 1 and "Traceback" not in output
