"""The report is one file that needs nothing else, with the right numbers in it."""

import base64
import json
import re
from io import BytesIO

import matplotlib.image
import numpy as np
import pytest

from castx.command.run import run
from castx.errors import CaseError
from castx.report.figures import cooling
from castx.report.report import opening_text, solid_text, steps_text, summary, write_report
from castx.results.files.measurements import Measured
from castx.results.reading import Results

pytestmark = pytest.mark.serial


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("report")
    run(
        "demos/cylinder.toml",
        ["time.end=0.3", "geometry.size=5e-3", 'name="<b>tricky</b>"'],
        output=path / "out",
    )
    return path / "out"


def test_the_report_stands_alone(folder):
    text = write_report(folder).read_text()
    assert "&lt;b&gt;tricky&lt;/b&gt;" in text and "<b>tricky" not in text
    assert not re.findall(r'(?:src|href)="(?!data:)', text)
    images = re.findall(r'src="data:image/png;base64,([^"]+)"', text)
    titles = re.findall(r"<h3>([^<]+)</h3>", text)
    assert len(images) == len(titles)
    for title in ("Cooling curves", "Gap and contact", "Temperature", "Distortion and stress"):
        assert title in titles
    for image in images:
        pixels = matplotlib.image.imread(BytesIO(base64.b64decode(image)))
        assert pixels.shape[0] > 200 and np.ptp(pixels[..., :3]) > 0.5


def test_the_summary_has_the_numbers_of_the_run(folder):
    results = Results(folder)
    found = dict(summary(results))
    assert found["simulated"] == "0.3 of 0.3 s"
    assert found["casting all solid"].startswith("not yet")
    assert found["steps"] == f"{len(results.history['time']) - 1}, 0 of them cut"
    assert results.freezing == ["casting"]


def test_the_summary_compares_with_what_was_measured(folder):
    results = Results(folder)
    name = "centre.temperature"
    time, computed = results.probes["time"], results.probes[name]
    results.measured = {name: Measured(time, computed - np.where(time > 0.2, 3.0, 0.0))}
    text = dict(summary(results))[f"{name} beside its measurement"]
    count, later = len(time), int(np.count_nonzero(time > 0.2))
    first = time[time > 0.2][0]
    mean = 3.0 * np.sqrt(later / count)
    assert text == f"RMS {mean:.3g} K, at most +3 K at {first:.4g} s, {count} points"
    (panel,) = cooling(results)
    assert panel.points.keys() == {"centre"}


def test_steps_taken_again_are_told():
    assert steps_text({"steps": 9, "cutbacks": 1}) == "9, 1 of them cut"
    found = steps_text({"steps": 9, "cutbacks": 1, "repeats": 2})
    assert found == "9, 1 of them cut, 2 taken again"


def test_hot_spots_stand_in_a_table(folder):
    """A pool that no surface feeds from the start, in the record of a run."""
    path = folder / "run.json"
    before = path.read_text()
    assert "Hot spots" not in write_report(folder).read_text()
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


def test_pictures_stand_before_numerics(folder):
    titles = re.findall(r"<h2>([^<]+)</h2>", write_report(folder).read_text())
    assert titles.index("Pictures") < titles.index("Curves") < titles.index("Numerics")


def test_a_thermal_run_has_no_gaps_in_its_summary(folder):
    results = Results(folder)
    assert any("gap" in name for name, _ in summary(results))
    results.record = {**results.record, "scheme": "thermal"}
    assert not any("gap" in name or "open" in name for name, _ in summary(results))


def test_when_it_was_solid_and_when_it_opened():
    time = np.array([0.0, 1.0, 2.0, 3.0])
    history = {"time": time, "a.solid_fraction": np.array([0.0, 0.5, 1.0, 1.0])}
    assert solid_text(history, "a") == "between 1 and 2 s"
    assert opening_text(time, np.array([0.0, 5e-7, 2e-6, 1e-6])) == "at 2 s (1 µm)"
    assert opening_text(time, np.zeros(4)) == "never (1 µm)"


def test_a_folder_without_results_is_refused(tmp_path):
    with pytest.raises(CaseError, match="is not a results folder of castx"):
        write_report(tmp_path)
