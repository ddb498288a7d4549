"""The report is one file that needs nothing else, with the right numbers in it."""

import base64
import json
import shutil
from html.parser import HTMLParser
from io import BytesIO
from pathlib import Path

import matplotlib.image
import numpy as np
import pytest

from castx.command.run import run
from castx.errors import CaseError
from castx.report.packing import LEVELS, unpacked
from castx.report.page.charts import cooling
from castx.report.page.report import write_report
from castx.report.reported import ReportedRun
from castx.report.summary.gaps import ROUNDING
from castx.report.summary.registry import findings
from castx.results.files.measurements import Measured, write_measured
from castx.results.reading import Results
from tests.castx.app.browser import Browser, found_browser

pytestmark = pytest.mark.serial

HOSTILE = "<b>tricky</b></script><script>alert(1)</script>"
VOID = {"meta", "img", "input", "br", "link", "hr"}


class Page(HTMLParser):
    """What stands in a page: elements in their order, texts of headings and scripts, numbers."""

    def __init__(self, text):
        super().__init__()
        self.open, self.attributes, self.texts = [], [], {}
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attributes):
        self.attributes.append((tag, dict(attributes)))
        if tag not in VOID:
            self.open.append((tag, dict(attributes)))

    def handle_endtag(self, tag):
        assert self.open and self.open.pop()[0] == tag, f"{tag} ends what is not open"

    def handle_data(self, data):
        if self.open:
            tag, attributes = self.open[-1]
            key = attributes.get("data-finding") or attributes.get("id") or tag
            self.texts.setdefault(key, []).append(data)

    def values(self, name):
        return [found[name] for _, found in self.attributes if name in found]

    def data(self, key):
        return json.loads("".join(self.texts[key]))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("report")
    run(
        "demos/cylinder.toml",
        ["time.end=0.3", "geometry.size=5e-3", f'name="{HOSTILE}"', "output.every=0.1"],
        output=path / "out",
    )
    return path / "out"


@pytest.fixture(scope="module")
def text(folder):
    return write_report(folder).read_text()


@pytest.fixture(scope="module")
def page(text):
    return Page(text)


def test_the_report_stands_alone(page, text):
    assert not page.open
    assert "http:" not in text and "https:" not in text
    sources = page.values("src")
    assert sources and all(source.startswith("data:image/png;base64,") for source in sources)
    assert not page.values("href")
    assert not [tag for tag, _ in page.attributes if tag in ("link", "iframe", "object", "base")]
    policy = next(value for value in page.values("content") if "default-src" in value)
    assert "default-src 'none'" in policy and "http" not in policy
    assert len(text) < 2_000_000


@pytest.mark.skipif(found_browser() is None, reason="needs chromium on this machine")
@pytest.mark.parametrize("phone, width", [(True, 390), (False, 390), (False, 1280)])
def test_a_phone_shows_the_whole_width(folder, text, tmp_path, phone, width):
    """Tables that are wider move inside the page."""
    with Browser(found_browser(), tmp_path / "profile", width, phone=phone) as browser:
        browser.open(f"file://{folder / 'report.html'}")
        wide = browser.wait_for("document.readyState === 'complete' && innerWidth")
        assert wide == width
        assert browser.value("document.querySelector('table').offsetHeight") > 0
        assert browser.value("document.documentElement.scrollWidth") <= width


LINES = """[...document.querySelectorAll("td[data-finding]")].map((cell) => {
  const range = document.createRange();
  range.selectNodeContents(cell.firstChild);
  return range.getClientRects().length;
})"""


@pytest.mark.skipif(found_browser() is None, reason="needs chromium on this machine")
def test_a_number_and_its_unit_stand_in_one_line(folder, text, tmp_path):
    with Browser(found_browser(), tmp_path / "profile", width=700) as browser:
        browser.open(f"file://{folder / 'report.html'}")
        browser.wait_for("document.readyState === 'complete'")
        lines = browser.value(LINES)
        assert lines and set(lines) == {1}


DRAWN = """void (() => {
  const root = document.createElement("div");
  root.innerHTML = '<div data-curves="Gaps"></div>';
  document.body.append(root);
  const lines = [{ name: "a", curve: "a", run: "", values: %s }];
  const table = { time: [0, 1, 2, 3, 4], measured: false, lines };
  const measured = [{ name: "b", curve: "b", run: "", values: [1, 1] }];
  const tables = [table, { time: [3, 9], measured: true, lines: measured }];
  const panel = { label: "gap", levels: {}, logarithmic: false, steps: false, least: 1, tables };
  panel.abscissa = "time [s]";
  const until = { "all solid": 2, "stage 1": 4 };
  const [{ plot }] = castx.charts.draw(root, [{ title: "Gaps", panels: [panel], until }]);
  window.along = plot.scales.x;
  window.buttons = [...root.querySelectorAll(".untils button")];
})()"""


@pytest.mark.skipif(found_browser() is None, reason="needs chromium on this machine")
@pytest.mark.parametrize(
    "values, ends",
    [("[0, 1, 2, null, null]", [0, 2]), ("[null, 1, 2, null, 3]", [1, 4]),
     ("[null, null, null, null, null]", [0, 4])],
)  # fmt: skip
def test_the_axis_of_a_curve_ends_with_its_values(folder, text, tmp_path, values, ends):
    """The gap of an interface that is gone has none; a logger that ends late does not count."""
    with Browser(found_browser(), tmp_path / "profile") as browser:
        browser.open(f"file://{folder / 'report.html'}")
        browser.wait_for("document.readyState === 'complete' && castx.charts")
        browser.value(DRAWN % values)
        found = browser.wait_for("typeof along.max === 'number' && [along.min, along.max]")
    assert found == ends


@pytest.mark.skipif(found_browser() is None, reason="needs chromium on this machine")
def test_a_button_shows_curves_until_all_is_solid(folder, text, tmp_path):
    with Browser(found_browser(), tmp_path / "profile") as browser:
        browser.open(f"file://{folder / 'report.html'}")
        browser.wait_for("document.readyState === 'complete' && castx.charts")
        browser.value(DRAWN % "[0, 1, 2, 2, 3]")
        browser.wait_for("typeof along.max === 'number'")
        # a moment near the end shows nothing that the whole run does not
        told = browser.value("buttons.map((button) => button.textContent)")
        assert told == ["whole run", "until all solid, 2 s"]
        browser.value("buttons[1].click()")
        browser.wait_for("along.max === 2 && along.min === 0")
        browser.value("buttons[0].click()")
        browser.wait_for("along.max === 4 && along.min === 0")


def test_a_run_that_was_killed_has_not_said_how_it_ended(folder, text, tmp_path):
    told = "or killed: it has not said how it ended"
    assert told not in text
    copy = Path(shutil.copytree(folder, tmp_path / "out"))
    record = json.loads((copy / "run.json").read_text())
    record["exit"] = {"reason": "running", "message": ""}
    (copy / "run.json").write_text(json.dumps(record))
    assert told in write_report(copy).read_text()


def test_hostile_names_are_text(page):
    assert "".join(page.texts["h1"]) == HOSTILE
    assert sum(tag == "script" for tag, _ in page.attributes) == 3
    assert not any(tag == "b" for tag, _ in page.attributes)


def test_sections_stand_in_the_order_of_what_matters(page):
    order = ["Summary", "View", "Curves", "Case", "Numerics", "Made with"]
    assert [title for title in page.texts["h2"] if title in order] == order


def test_each_number_of_the_summary_is_that_of_the_results(page, folder):
    results = ReportedRun(folder)
    found = {finding.name: finding for finding in findings(results)}
    shown = {
        attributes["data-finding"]: float(attributes["data-value"])
        for _, attributes in page.attributes if "data-finding" in attributes
    }  # fmt: skip
    assert shown == {name: finding.value for name, finding in found.items()} and len(shown) >= 5
    for name, finding in found.items():
        assert "".join(page.texts[name]) == finding.number
    widest = results.history["casting/mould.max_gap"].max()
    assert shown["Largest gap: casting/mould"] == (widest if widest > ROUNDING else 0.0)
    assert shown["Still liquid: casting"] == 1.0 - results.history["casting.solid_fraction"][-1]
    stress = results.record["stage_ends"][-1]["bodies"]["casting"]["stress"]
    assert shown["Stress at the end: casting"] == stress["largest_principal"]["value"]


def test_findings_without_a_picture_come_last(text):
    cards = text.split('<section class="card">')[1:]
    drawn = ["<figure>" in card.partition("</section>")[0] for card in cards]
    assert drawn == sorted(drawn, reverse=True) and True in drawn and False in drawn


def test_pictures_have_colours(page):
    for source in page.values("src"):
        image = base64.b64decode(source.partition(",")[2])
        pixels = matplotlib.image.imread(BytesIO(image))
        assert min(pixels.shape[:2]) > 100 and np.ptp(pixels[..., :3]) > 0.5
    assert len(page.values("src")) >= 4


def test_the_view_has_the_fields_of_the_moments(page, folder):
    scene, results = page.data("scene"), Results(folder)
    assert scene["times"] == results.times
    for field in scene["fields"]:
        for body, stored in field["bodies"].items():
            found = unpacked(stored["values"])
            times = scene["times"][-1:] if field["final"] else scene["times"]
            for values, time in zip(found, times, strict=True):
                written = results.grids(time)[body]
                if field["name"] in written.array_names:
                    step = (stored["values"]["high"] - stored["values"]["low"]) / LEVELS
                    np.testing.assert_allclose(
                        values, written[field["name"]], atol=0.51 * step, rtol=1e-6
                    )
    assert {"temperature", "largest_principal_stress"} <= {f["name"] for f in scene["fields"]}


def test_the_curves_are_those_of_the_probes(page, folder):
    sections = {section["title"]: section for section in page.data("curves")}
    (table,) = sections["Cooling curves"]["panels"][0]["tables"]
    probes = Results(folder).probes
    np.testing.assert_allclose(table["time"], probes["time"], rtol=1e-6)
    lines = {line["name"]: line["values"] for line in table["lines"]}
    np.testing.assert_allclose(lines["centre"], probes["centre.temperature"], rtol=1e-6)
    assert set(page.values("data-curves")) == set(sections)


def test_the_summary_compares_with_what_was_measured(folder):
    results = Results(folder)
    name = "centre.temperature"
    time, computed = results.probes["time"], results.probes[name]
    write_measured(folder, {name: Measured(time, computed - np.where(time > 0.2, 3.0, 0.0))})
    found = Page(write_report(folder).read_text())
    write_measured(folder, {})
    count, later = len(time), int(np.count_nonzero(time > 0.2))
    number = "".join(found.texts[f"Beside its measurement: {name}"])
    assert number == f"{3.0 * np.sqrt(later / count):.4g} K"
    tables = next(s for s in found.data("curves") if s["title"] == "Cooling curves")["panels"][0]
    (measured,) = [table for table in tables["tables"] if table["measured"]]
    assert measured["lines"][0]["name"] == "centre, measured"
    results.measured = {name: Measured(time, computed)}
    assert cooling(results)[0].points.keys() == {"centre"}


def test_hot_spots_stand_in_a_table(folder, page):
    """A pool that no surface feeds from the start, in the record of a run."""
    path = folder / "run.json"
    before = path.read_text()
    assert "Hot spots" not in page.texts["h2"]
    spot = {
        "body": "casting", "pool": 1, "parent": None, "children": [], "merged": [],
        "isolated": 0.25, "ended": None, "place": [0.0, 0.0123], "centre": [0.01, 0.01],
        "volume": 4e-6, "deficit": 2.4e-7,
    }  # fmt: skip
    path.write_text(json.dumps({**json.loads(before), "hot_spots": [spot]}))
    text = write_report(folder).read_text()
    path.write_text(before)
    assert "<h2>Hot spots</h2>" in text
    assert "<td>0.0, 12.3</td><td>4</td><td>0.24</td>" in text
    assert "".join(Page(text).texts["Worst hot spot: casting"]) == "0.24 cm³"


def test_a_thermal_run_has_no_gaps(folder):
    path = folder / "run.json"
    before = path.read_text()
    path.write_text(json.dumps({**json.loads(before), "scheme": "thermal"}))
    text = write_report(folder).read_text()
    path.write_text(before)
    assert "Largest gap" not in text


def test_a_folder_without_results_is_refused(tmp_path):
    with pytest.raises(CaseError, match="is not a results folder of castx"):
        write_report(tmp_path)
