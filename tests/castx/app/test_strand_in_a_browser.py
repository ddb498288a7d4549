"""A strand on the page by clicks: the process, the case file that comes, its checks, its mesh."""

import tomllib

import pytest

from tests.cad_files import write_cad
from tests.castx.app.browser import found_browser
from tests.castx.app.opened import opened_folder

pytestmark = [
    pytest.mark.serial,
    pytest.mark.skipif(found_browser() is None, reason="needs chromium on this machine"),
]

AT = "castx.at('{}').textContent"


def billet(occ):
    """A length of a billet, 60 mm square, with round edges along it."""
    face = occ.addRectangle(0, 0, 0, 60, 60, roundedRadius=6)
    return [tag for dim, tag in occ.extrude([(2, face)], 0, 0, 100) if dim == 3]


@pytest.mark.slow
def test_a_strand_from_its_step_file_to_its_mesh(tmp_path, monkeypatch):
    with opened_folder(tmp_path, monkeypatch, {}) as (browser, folder):
        write_cad(folder / "billet.step", billet, ["billet"])
        browser.press("#again")
        browser.wait_for(
            "[...castx.at('new-part').options].some((one) => one.value === 'billet.step')"
        )
        browser.choose("#new-part", "billet.step")
        browser.wait_for(f"{AT.format('part-size')}.includes('60 × 60 × 100 mm')")
        browser.choose("#new-process", "continuous")
        browser.press("#do-new")
        browser.wait_for(f"{AT.format('part-state')}.startsWith('billet.toml: 2 bodies')")
        case = tomllib.loads((folder / "billet.toml").read_text())
        strand, mould = case["bodies"]
        assert (strand["material"], mould["material"]) == ("316L", "Cu-pure")
        assert strand["feeding"] == "darcy" and len(case["geometry"]["symmetry"]) == 3
        assert [stage.get("remove") for stage in case["stages"]] == [["mould"], None, None, None]

        browser.press("#tabs button:nth-child(3)")
        browser.wait_for("castx.at('text').value.includes('steel-copper-cooled')")
        assert browser.value("castx.at('text').value") == (folder / "billet.toml").read_text()
        browser.press("#tabs button:nth-child(4)")
        browser.press("#do-mesh")
        browser.wait_for(f"{AT.format('mesh-state')}.startsWith('made in')")
        assert int(browser.value(AT.format("mesh-cells")).split()[0]) > 500

        browser.press("#tabs button:nth-child(5)")
        browser.press("#do-check")
        browser.wait_for(f"{AT.format('command')}.startsWith('castx check')")
        browser.wait_for(f"{AT.format('command')}.endsWith('done')")
        assert browser.value("castx.editor.state.problems.map((problem) => problem.text)") == []
