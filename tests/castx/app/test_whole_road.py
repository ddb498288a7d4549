"""The whole road on the page by clicks: STEP, face, process, mesh, run, stop, resume, report."""

import tomllib

import pytest

from castx.results.reading import Results
from tests.castx.app.browser import found_browser
from tests.castx.app.opened import opened_folder

pytestmark = [
    pytest.mark.serial,
    pytest.mark.skipif(found_browser() is None, reason="needs chromium on this machine"),
]

AT = "castx.at('{}').textContent"


def case_of(folder):
    return tomllib.loads((folder / "bar.toml").read_text())


def tab(browser, name):
    number = ["New case", "Part", "Case", "Mesh", "Run"].index(name) + 1
    browser.press(f"#tabs button:nth-child({number})")


@pytest.fixture
def opened(tmp_path, monkeypatch):
    """A browser with the page of a folder that holds one STEP file and nothing else."""
    with opened_folder(tmp_path, monkeypatch, {}) as found:
        yield found


@pytest.mark.slow
def test_from_a_step_file_to_a_report(opened):
    browser, folder = opened

    # A folder without a case begins with the first case of a part.
    assert browser.value("castx.at('do-run').disabled")
    browser.choose("#new-part", "bar.step")
    browser.wait_for(f"{AT.format('part-size')}.includes('60 × 20 × 20 mm')")
    browser.choose("#new-process", "gravity-die")
    browser.choose("#new-alloy", "AlSi12")
    browser.choose("#new-top", "open")
    browser.press("#do-new")
    browser.wait_for(f"{AT.format('part-state')}.startsWith('bar.toml: 2 bodies')")
    assert case_of(folder)["bodies"][0]["material"] == "AlSi12"
    browser.wait_for(f"{AT.format('part-state')}.includes('modulus')")

    # The face at the top is all of the casting that is open: its new name takes its conditions.
    browser.value("castx.at('part-canvas').scrollIntoView({ block: 'center' })")
    box = "castx.at('part-canvas').getBoundingClientRect()"
    x, y = browser.value(f"[{box}.left + {box}.width / 2, {box}.top + 0.43 * {box}.height]")
    browser.click(x, y)
    browser.wait_for(f"!castx.at('naming').hidden && {AT.format('finds')} === 'finds 1 face'")
    assert "bar: 12 cm² around (30, 10, 20) mm" in browser.value(AT.format("face-text"))
    browser.enter("#surface-name", "top")
    browser.choose("#kind", "radiation")
    browser.enter("#numbers [name=emissivity]", "0.3")
    browser.enter("#numbers [name=ambient]", "25 degC")
    browser.press("#do-name")
    browser.wait_for(f"{AT.format('finds')}.startsWith('written')")
    heat = {"type": "radiation", "emissivity": 0.3, "ambient": "25 degC"}
    on = {entry["on"]: entry["heat"] for entry in case_of(folder)["boundaries"]}
    assert on["bar/top"] == heat and "bar/outside" not in on
    browser.wait_for("!document.querySelector('#surfaces .notice')")

    tab(browser, "Case")
    browser.press("#groups [data-group=time] > summary")
    browser.enter('[data-key="time.end"]', "100 s")
    browser.wait_for("castx.at('text').value.includes('end = \"100 s\"')")

    # By hand: without mechanics a run takes seconds.
    browser.write("#text", '\n[coupling]\nscheme = "thermal"\n')
    browser.wait_for("castx.editor.dirty() && !castx.at('save').disabled")
    browser.press("#save")
    browser.wait_for("!castx.editor.dirty()")
    assert case_of(folder)["coupling"] == {"scheme": "thermal"}

    tab(browser, "Mesh")
    for name, value in (("size", "20 mm"), ("interface_size", "20 mm"), ("growth", "2")):
        browser.enter(f"[data-size={name}]", value)  # sooner than the one before is written
    browser.press("#do-mesh")
    browser.wait_for(f"{AT.format('mesh-state')}.startsWith('made in')")
    assert 20 < int(browser.value(AT.format("mesh-cells")).split()[0]) < 600
    assert case_of(folder)["geometry"]["growth"] == 2

    tab(browser, "Run")
    browser.press("#do-run")
    browser.wait_for(f"{AT.format('run-state')}.includes('steps')")
    browser.press("#do-stop")
    browser.wait_for(f"{AT.format('command')}.endsWith('stopped')")
    stopped = Results(folder / "results/bar").history["time"][-1]
    assert 0 < stopped < 100
    assert browser.value("castx.at('do-restart').className") == "main"
    browser.press("#do-restart")
    browser.wait_for(f"{AT.format('command')}.startsWith('castx report')")
    browser.wait_for(f"{AT.format('command')}.endsWith('done')")
    assert Results(folder / "results/bar").history["time"][-1] == 100
    assert Results(folder / "results/bar").record["exit"]["reason"] == "finished"
    assert (folder / "results/bar/report.html").is_file()
    assert browser.value("castx.at('do-show').hidden") is False
    assert browser.value("castx.at('do-run').textContent") == "Run anew"
    assert not browser.value("castx.editor.dirty()")
    assert browser.value("castx.at('text').value") == (folder / "bar.toml").read_text()
