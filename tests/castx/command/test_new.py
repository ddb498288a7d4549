"""`castx new` writes a case that is accepted, with the process that is asked for."""

import re

import pytest

from castx.case.processes.names import process_names
from castx.command.cli import execute
from tests.cad_files import write_cad

PNG = b"\x89PNG"


@pytest.mark.slow
def test_new_writes_a_case_that_check_accepts(comm, shared_tmp_path, said):
    part, case = shared_tmp_path / "bar.step", shared_tmp_path / "bar.toml"
    if comm.rank == 0:
        write_cad(part, lambda occ: [occ.addBox(0, 0, 0, 60, 20, 20)], ["my casting"])
    comm.Barrier()
    assert execute(["new", str(part)], comm) == 0
    text = said().replace("\n", "")
    assert f"castx check {case}" in text and f"castx new {part} --process NAME" in text
    assert re.search(r"[0-9]+ cells: a run takes .* on one processor", text)
    assert "my casting has walls of" in text and "mould has walls of" not in text
    assert execute(["check", str(case)], comm) == 0
    text = said()
    assert "interface my casting/mould" in text and "warning: mould has walls of" in text
    assert case.with_suffix(".png").read_bytes().startswith(PNG)
    assert execute(["new", str(part)], comm) == 2
    assert "bar.toml exists" in said().replace("\n", "")


@pytest.mark.ranks
def test_new_keeps_a_picture_that_is_there(comm, shared_tmp_path, said):
    part, photo = shared_tmp_path / "bar.step", shared_tmp_path / "bar.png"
    if comm.rank == 0:
        write_cad(part, lambda occ: [occ.addBox(0, 0, 0, 60, 20, 20)])
        photo.write_text("mine")
    comm.Barrier()
    asked = ["--process", "sand", "--alloy", "AlSi7Mg", "--split", "z", "--top", "open"]
    assert execute(["new", str(part), *asked], comm) == 0
    text = said().replace("\n", "")
    assert "bar: 60 × 20 × 20 mm, 24 cm³" in text
    assert 'split = "z = 10 mm"' in part.with_suffix(".toml").read_text()
    assert "bar.png exists" in text and f"look into it, then: castx check {part.parent}" in text
    assert photo.read_text() == "mine" and part.with_suffix(".toml").is_file()


@pytest.mark.serial
def test_new_tells_how_much_too_early_a_plate_freezes_in_cells_of_sand(comm, shared_tmp_path, said):
    """The worst of both halves of the mould."""
    part = write_cad(shared_tmp_path / "plate.step", lambda occ: [occ.addBox(0, 0, 0, 150, 90, 8)])
    asked = ["--process", "sand", "--alloy", "GJL-250", "--split", "z"]
    assert execute(["new", str(part), *asked], comm) == 0
    told = re.findall(
        r"cells of [\d.]+ mm in mould-\w+, which takes up the heat of freezing",
        said().replace("\n", " "),
    )
    assert len(told) == 1


@pytest.mark.serial
def test_an_unknown_process_is_refused_with_those_there_are(comm, shared_tmp_path, said):
    part = write_cad(shared_tmp_path / "bar.step", lambda occ: [occ.addBox(0, 0, 0, 9, 9, 9)])
    assert execute(["new", str(part), "--process", "sandd"], comm) == 2
    text = said()
    assert "no process 'sandd'" in text and "sand" in text and "investment" in text
    assert execute(["new", "--help"], comm) == 0
    shown = re.sub(r"[\s│]", "", said())
    assert all(name in shown for name in process_names())


@pytest.mark.serial
def test_a_strand_is_told_with_its_speed_and_times(comm, shared_tmp_path, said):
    def bar(occ):
        face = occ.addRectangle(0, 0, 0, 60, 60, roundedRadius=5)
        return [tag for dim, tag in occ.extrude([(2, face)], 0, 0, 80) if dim == 3]

    part = write_cad(shared_tmp_path / "bar.step", bar)
    assert execute(["new", str(part), "--process", "continuous"], comm) == 0
    text = said().replace("\n", " ")
    assert "bar: a strand of 60 × 60 mm along z" in text and "m/min: " in text
    assert execute(["check", str(part.with_suffix(".toml"))], comm) == 0
    assert "the case can be run" in said().replace("\n", " ")
