"""The page in a headless browser: a case opens, a click on a face writes its selector."""

import tomllib

import pytest

from tests.castx.app.browser import found_browser
from tests.castx.app.opened import opened_folder

pytestmark = [
    pytest.mark.serial,
    pytest.mark.skipif(found_browser() is None, reason="needs chromium on this machine"),
]

CASE = """# by hand
[geometry]
model = "3d"
file = "bar.step"
size = "10 mm"
[[bodies]]
name = "bar"
material = "Al-pure"
temperature = 700
[time]
end = 1
"""


ENTER = """(([key, value]) => {
  const field = document.querySelector(`[data-key="${key}"]`);
  field.value = value;
  field.dispatchEvent(new Event("change"));
})"""


@pytest.fixture
def opened(tmp_path, monkeypatch):
    """A browser in which the page of a folder with one case is open, and the folder."""
    with opened_folder(tmp_path, monkeypatch, {"bar.toml": CASE}) as found:
        yield found


def test_a_field_of_a_form_is_written_into_the_case_file_and_refused_beside(opened):
    browser, folder = opened
    browser.value("castx.tabs.show('Case')")
    browser.wait_for("document.querySelector('[data-key=\"time.end\"]') !== null")
    assert browser.value("document.querySelector('[data-key=\"time.end\"]').value") == "1"
    browser.value(f"{ENTER}(['time.end', '-3 s'])")
    row = "document.querySelector('[data-field=\"time.end\"] .wrong-field')"
    browser.wait_for(f"{row} && !{row}.hidden")
    assert "must be positive" in browser.value(f"{row}.textContent")
    browser.value(f"{ENTER}(['time.end', '8 min'])")
    browser.wait_for(f"{row}.hidden && castx.at('text').value.includes('end = \"8 min\"')")
    browser.value(f"{ENTER}(['bodies[0].law', 'rigid'])")
    browser.wait_for("castx.at('text').value.includes('law = \"rigid\"')")
    text = (folder / "bar.toml").read_text()
    assert text.startswith("# by hand\n")
    found = tomllib.loads(text)
    assert found["time"] == {"end": "8 min"} and found["bodies"][0]["law"] == "rigid"


HELD = """(() => {
  const ask = castx.server.ask, held = { asked: false };
  castx.server.ask = async (action, asked) => {
    const answer = await ask(action, asked);
    if (action === "%s") {
      held.asked = true;
      await new Promise((go) => { held.go = () => { castx.server.ask = ask; go(); }; });
    }
    return answer;
  };
  castx.held = held;
})()"""
"""Answers to one action come when `castx.held.go` is called, as from a busy machine."""


def test_what_is_typed_while_a_changed_file_is_read_stays(opened):
    browser, folder = opened
    browser.value("castx.tabs.show('Case')")
    browser.value(HELD % "open")
    (folder / "bar.toml").write_text(CASE + "# by another editor\n")
    browser.wait_for("castx.held.asked")
    browser.write("#text", "# typed meanwhile\n")
    browser.value("castx.held.go()")
    browser.wait_for("castx.at('dirty').textContent.startsWith('not saved, and changed on the')")
    assert browser.value("castx.at('text').value") == CASE + "# typed meanwhile\n"
    assert browser.value("castx.at('save').disabled") is False


def test_nothing_is_typed_or_opened_while_a_field_is_written(opened):
    browser, folder = opened
    (folder / "other.toml").write_text(CASE + "# other\n")
    browser.value("castx.tabs.show('Case')")
    browser.wait_for("document.querySelector('[data-key=\"time.end\"]') !== null")
    browser.value(HELD % "set")
    browser.value(f"{ENTER}(['time.end', '8 min'])")
    browser.wait_for("castx.held.asked")
    browser.write("#text", "# lost")
    assert browser.value("castx.at('text').value") == CASE
    browser.value("void castx.open('other.toml')")
    browser.value("castx.held.go()")
    browser.wait_for("castx.at('file-name').textContent === 'other.toml'")
    assert browser.value("castx.at('text').value") == CASE + "# other\n"
    assert tomllib.loads((folder / "bar.toml").read_text())["time"] == {"end": "8 min"}
    browser.write("#text", "# typed")
    browser.wait_for("castx.editor.dirty()")


def test_a_size_is_written_and_the_mesh_that_it_makes_is_drawn(opened):
    browser, folder = opened
    browser.value("castx.tabs.show('Mesh')")
    field = "document.querySelector('[data-size=size]')"
    browser.wait_for(f"{field} !== null")
    browser.value(f"{field}.value = '12 mm', {field}.dispatchEvent(new Event('change'))")
    browser.wait_for("castx.at('text').value.includes('size = \"12 mm\"')")
    told = "[...document.querySelectorAll('#sizes .quiet')].map((line) => line.textContent)"
    assert not [line for line in browser.value(told) if "[" in line or not line]
    narrow = "document.querySelector('[data-size=narrowest]')"
    browser.value(f"{narrow}.value = '0.5 mm', {narrow}.dispatchEvent(new Event('change'))")
    browser.wait_for("castx.at('text').value.includes('narrowest = \"0.5 mm\"')")
    browser.value("castx.at('do-mesh').click()")
    browser.wait_for("castx.at('mesh-state').textContent.startsWith('made in')")
    told = browser.value("castx.at('mesh-cells').textContent")
    assert int(told.split()[0]) > 50 and "worst cell of quality" in told
    drawn = browser.value("castx.meshes.view().positions.length / 9")
    assert drawn == browser.value("castx.meshes.view().counts.reduce((a, b) => a + b)") > 50
    assert (folder / "bar.toml").read_text().startswith("# by hand\n")


def test_the_button_of_the_mesh_stays_where_it_is_when_the_sizes_come(opened):
    browser, _ = opened
    top = "castx.at('do-mesh').getBoundingClientRect().top"
    before = browser.value(f"(castx.tabs.show('Mesh'), {top})")
    browser.wait_for("castx.at('sizes').childElementCount > 3")
    assert browser.value(top) == before > 0


def test_a_run_shows_its_last_moment_and_curves(opened):
    browser, folder = opened
    (folder / "bar.toml").write_text(
        CASE.replace("[time]", '[coupling]\nscheme = "thermal"\n[time]')
    )
    browser.value("castx.open('bar.toml')")
    browser.wait_for("castx.at('text').value.includes('thermal')")
    browser.value("castx.at('with-report').checked = false, castx.at('do-run').click()")
    browser.wait_for("castx.at('command').textContent.endsWith('done')")
    browser.wait_for("!castx.at('moment').hidden && castx.moments.state.time === 1")
    assert browser.value("castx.moments.view().values.length") > 0
    # what is asked for while a picture is drawn, or cannot be read yet, is drawn later
    state = "castx.moments.state"
    follow = f"castx.moments.follow({state}.results, 'later', true)"
    browser.value(f"void ({state}.busy = true, {follow}, {state}.busy = false)")
    assert browser.value(f"{state}.version") != "later"
    browser.value(
        f"void (castx.ask = castx.server.ask, {state}.time = 0.5,"
        " castx.server.ask = async () => { throw new Error('half written'); }, "
        f"{follow}, castx.server.ask = castx.ask)"
    )
    browser.wait_for(f"!{state}.busy")
    assert browser.value(f"{state}.version") != "later"
    said = "castx.at('moment-state').textContent"
    browser.wait_for(f"{said} === 't = 0.5 s; a later moment cannot be read yet'")
    browser.wait_for(f"({follow}, {state}.time === 1)")
    browser.wait_for(f"{said} === 't = 1 s'")
    assert browser.value("castx.at('curves').querySelectorAll('canvas').length") > 0
    assert "temperature" in browser.value(
        "[...castx.at('moment-field').options].map((o) => o.value)"
    )


def test_a_click_on_a_face_writes_its_selector_into_the_case_file(opened):
    browser, folder = opened
    assert browser.value("castx.at('text').value") == CASE
    assert "are accepted" in browser.value("castx.at('problems').textContent")
    browser.value("castx.tabs.show('Part'), castx.at('show-part').click()")
    browser.wait_for("castx.at('part-state').textContent.startsWith('bar.toml: 1 body, 6')")
    browser.value("castx.at('part-canvas').scrollIntoView({ block: 'center' })")
    # the eye looks along (1, -1.4, 0.9): a little above the middle is the top
    box = "castx.at('part-canvas').getBoundingClientRect()"
    x, y = browser.value(f"[{box}.left + {box}.width / 2, {box}.top + 0.43 * {box}.height]")
    browser.click(x, y)
    browser.wait_for("!castx.at('naming').hidden && castx.at('finds').textContent")
    assert browser.value("castx.at('selector').value") == '{ normal = "+z" }'
    assert browser.value("castx.at('finds').textContent") == "finds 1 face"
    browser.value("castx.at('surface-name').value = 'top', castx.at('do-name').click()")
    browser.wait_for("castx.at('finds').textContent.startsWith('written')")
    assert 'top = { normal = "+z" }' in browser.value("castx.at('text').value")
    # at the width of a telephone nothing lies beside the page
    browser.resize(400, 800)
    assert browser.value("document.documentElement.scrollWidth") <= 400
    browser.picture(folder.parent / "page.png")
    text = (folder / "bar.toml").read_text()
    assert text.startswith("# by hand\n")
    assert tomllib.loads(text)["geometry"]["surfaces"] == {"top": {"normal": "+z"}}


def test_what_a_process_cannot_have_is_not_offered_and_the_reason_is_told(opened):
    browser, _ = opened
    browser.value("castx.tabs.show('New case')")
    browser.wait_for("castx.at('new-process').options.length > 3")
    off = "['split', 'plane', 'top'].filter((name) => castx.at(`new-${name}`).disabled)"
    browser.choose("#new-process", "gravity-die")
    browser.choose("#new-split", "z")
    browser.choose("#new-top", "open")
    assert browser.value(off) == []
    browser.choose("#new-process", "high-pressure-die")
    assert browser.value(off) == ["top"] and browser.value("castx.at('new-top').value") == "closed"
    assert "a die is closed" in browser.value("castx.at('process-text').textContent")
    browser.choose("#new-process", "investment")
    assert browser.value(off) == ["split", "plane"]
    assert browser.value("getComputedStyle(castx.at('new-plane')).opacity") == "0.5"
    assert browser.value("castx.at('new-split').value") == ""
    browser.choose("#new-process", "")
    assert browser.value(off) == ["plane"]


def test_the_time_of_a_run_is_unknown_until_one_has_come_to_its_end(opened):
    browser, folder = opened
    expected = "castx.at('expected').textContent"
    browser.value("castx.tabs.show('Run')")
    browser.wait_for(f"{expected}.includes('unknown: make the mesh first')")
    browser.value("castx.tabs.show('Mesh'), castx.at('do-mesh').click()")
    browser.wait_for("castx.at('mesh-state').textContent.startsWith('made in')")
    browser.value("castx.tabs.show('Run')")
    browser.wait_for(f"{expected}.includes('no run of this folder has come to its end')")
    thermal = CASE.replace("[time]", '[coupling]\nscheme = "thermal"\n[time]')
    (folder / "bar.toml").write_text(thermal)
    browser.value("castx.open('bar.toml')")
    browser.wait_for("castx.at('text').value.includes('thermal')")
    browser.value("castx.at('with-report').checked = false, castx.at('do-run').click()")
    browser.wait_for("castx.at('command').textContent.endsWith('done')")
    browser.wait_for(f"{expected}.includes('results/bar took')")
    # a finer mesh is not known, and takes longer once it is
    (folder / "bar.toml").write_text(thermal.replace("10 mm", "7 mm"))
    browser.wait_for(f"{expected}.includes('unknown: make the mesh first')")
    browser.value("castx.tabs.show('Mesh'), castx.at('do-mesh').click()")
    browser.wait_for("castx.at('mesh-state').textContent.startsWith('made in')")
    browser.value("castx.tabs.show('Run')")
    browser.wait_for(f"/about .* cells: results.bar took/.test({expected})")


def test_older_results_are_opened_and_the_case_keeps_its_own(opened):
    browser, folder = opened
    thermal = CASE.replace("[time]", '[coupling]\nscheme = "thermal"\n[time]')
    (folder / "bar.toml").write_text(thermal)
    browser.value("castx.open('bar.toml')")
    browser.wait_for("castx.at('text').value.includes('thermal')")
    run = "castx.at('with-report').checked = false, castx.at('do-run').click()"
    done = "castx.at('command').textContent.endsWith('done')"
    state = "castx.at('run-state').textContent"
    browser.value(run)
    browser.wait_for(f"{done} && {state}.startsWith('results/bar: t = 1 s')")
    (folder / "bar.toml").write_text(thermal.replace("end = 1", "end = 0.5"))
    browser.wait_for("castx.at('text').value.includes('end = 0.5') && !castx.run.seen.running")
    browser.value(run)
    browser.wait_for(f"{done} && {state}.startsWith('results/bar: t = 0.5 s of at most 0.5')")
    names = "[...castx.at('results-of').options].map((o) => o.value)"
    browser.wait_for(f"{names}.includes('results/bar.1')")
    assert browser.value(f"{names}[0]") == "results/bar"
    browser.choose("#results-of", "results/bar.1")
    browser.wait_for(f"{state}.startsWith('results/bar.1: t = 1 s of at most 1 s')")
    browser.wait_for("castx.moments.state.time === 1")
    assert browser.value("castx.at('curves').querySelectorAll('canvas').length") > 0
    assert "Run and Resume" in browser.value("castx.at('results-state').textContent")
    # its report is written beside it, and a new run is that of the case
    browser.press("#do-report")
    browser.wait_for(f"{done} && castx.at('command').textContent.includes('report results/bar.1')")
    assert (folder / "results/bar.1/report.html").is_file()
    assert not (folder / "results/bar/report.html").exists()
    browser.value(run)
    browser.wait_for(f"{done} && {state}.startsWith('results/bar: t = 0.5 s')")
    browser.wait_for(f"{names}.includes('results/bar.2')")
    assert browser.value("castx.at('results-of').value") == "results/bar"
