"""Every demo runs and gives the number it is about."""

import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from castx.case.caveats import caveats
from castx.case.reading.read import load_case
from castx.command.run import run
from castx.materials.inelastic import FLOW_RULES
from castx.report.page.report import write_report
from castx.results.files.series import read_series
from castx.transfer.registry import gap_heat_laws
from docs.generator.notebooks import execute

DEMOS = Path(__file__).parents[1] / "demos"
pytestmark = pytest.mark.serial


@pytest.mark.parametrize("name", [path.name for path in sorted(DEMOS.glob("*.toml"))])
def test_case_files_are_valid(name):
    case = load_case(DEMOS / name)
    assert case.output.folder.name == Path(name).stem
    assert case.name and case.probes


@pytest.mark.parametrize(
    "name", [str(path.relative_to(DEMOS)) for path in sorted(DEMOS.rglob("*.toml"))]
)
def test_no_casting_is_elastic_for_want_of_a_law(name):
    assert not [text for text in caveats(load_case(DEMOS / name)) if "has no law" in text]


@pytest.fixture(scope="module")
def feeder(tmp_path_factory):
    """Return the folder with the demo of six bodies on a coarse mesh."""
    folder = tmp_path_factory.mktemp("feeder")
    script = [sys.executable, str(DEMOS / "feeder_mesh.py"), str(folder / "feeder.msh"), "5"]
    subprocess.run(script, check=True, timeout=100)
    (folder / "feeder.toml").write_bytes((DEMOS / "feeder.toml").read_bytes())
    return folder


def run_feeder(folder, name, *overrides):
    coarse = ["time.temperature_change=40", "time.end=190", *overrides]
    run(folder / "feeder.toml", coarse, output=folder / name)
    history = read_series(folder / name / "history.csv")
    return history, read_series(folder / name / "probes.csv")


def end_of_freezing(probes, name):
    """Return the time at which a probe is solid, interpolated."""
    return float(np.interp(0.99, probes[f"{name}.solid_fraction"], probes["time"]))


@pytest.mark.slow
def test_six_bodies_steer_the_heat(feeder):
    """Chill, channel, core, sleeve and cover are ordinary bodies; the feeder freezes last."""
    history, probes = run_feeder(feeder, "given")
    time, end = history["time"], {name: values[-1] for name, values in history.items()}
    assert end["energy_error"] < 1e-6 and max(history["passes"]) <= 25
    bush, above = (end_of_freezing(probes, name) for name in ("bush", "feeder"))
    assert bush < 0.5 * above < 95.0
    # The channel: shut until 10 s and from 70.5 s on.
    power = history["mould/channel.power"]
    assert (power[time < 10.0] == 0.0).all() and (power[time > 80.0] == 0.0).all()
    assert power[(time > 12.0) & (time < 60.0)].max() < -1000.0
    # The cover: 4 MJ/kg, 0.7 t/m³, a disc of 20 to 34 mm that is 6 mm thick.
    volume = np.pi * (0.034**2 - 0.020**2) * 0.006
    burnt = 48e6 * (52.0 + 3.0 / 2 + 8.0 / 2) * volume
    assert end["cover.source"] == pytest.approx(burnt, rel=1e-6)
    assert end["casting/cover.heat"] < 0.0  # the cover heats the feeder
    assert end["casting/chill.power"] > 3.0 * end["casting/sleeve.power"] > 0.0
    assert probes["gap.gap"][-1] > 50e-6
    bodies = ("casting", "mould", "chill", "core", "sleeve", "cover")
    gained = sum(end[f"{body}.enthalpy"] - history[f"{body}.enthalpy"][0] for body in bodies)
    outside = [n for n in end if n.endswith(".heat") and n.split("/")[1][:-5] not in bodies]
    assert len(outside) == 5
    inside = end["cover.source"] + end["casting.dissipation"]
    received = inside + sum(end[name] for name in outside)
    assert gained == pytest.approx(received, rel=1e-6)


@pytest.mark.slow
def test_a_cover_that_does_not_burn_feeds_less(feeder):
    thermal = "coupling.scheme=thermal"
    fields = 'output.fields=["temperature", "solid_fraction"]'
    gap = 'probes.3.quantities=["gap"]'
    _, burning = run_feeder(feeder, "burning", thermal, fields, gap)
    _, cold = run_feeder(feeder, "cold", thermal, fields, gap, "bodies.5.heat_source=0")
    assert end_of_freezing(cold, "feeder") < 0.95 * end_of_freezing(burning, "feeder")


def executed(name):
    """Return the outputs of a notebook and what it printed."""
    notebook = execute(name)
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    text = "".join(output.get("text", "") for output in outputs)
    pictures = sum("image/png" in output.get("data", {}) for output in outputs)
    return text, pictures


@pytest.mark.slow
def test_the_notebook_shows_that_the_gap_delays_solidification():
    text, pictures = executed("cylinder_notebook.py")
    found = re.search(r"delay: ([\d.]+)", text)
    assert found is not None and 1.5 < float(found[1]) < 1.75
    assert pictures == 2


@pytest.mark.slow
def test_the_notebook_compares_the_laws_of_an_interface():
    text, pictures = executed("interface_notebook.py")
    hidden = [law for law in gap_heat_laws() if not re.search(rf"^{law} +\S", text, re.M)]
    assert not hidden, f"demos/interface_notebook.py does not show the laws {hidden}"
    solid = {
        name.strip(): float(time)
        for name, time in re.findall(r"^(.{24}) 98 % solid after +([\d.]+) s", text, re.M)
    }
    assert solid["constant"] < 0.7 * solid["limited"]
    assert solid["limited, radiating"] < solid["limited"] < solid["series"] < solid["coated"]
    assert 0.7 < solid["solid-fraction, thermal"] / solid["limited"] < 0.9
    assert "only radiation" not in solid
    assert pictures == 3


@pytest.mark.slow
def test_the_notebook_finds_the_heat_transfer_that_made_its_curves():
    text, pictures = executed("identify_notebook.py")
    rows = re.findall(
        r"^h at \d+ s +([\d.]+) W/m²/K +\[([\d.]+), ([\d.]+)\], true ([\d.]+)", text, re.M
    )
    assert len(rows) == 4
    for row, within in zip(rows, (0.15, 0.08, 0.05, 0.08), strict=True):
        value, low, high, true = (float(number) for number in row)
        assert low < true < high and value == pytest.approx(true, rel=within)
    assert "6 of 6 bands hold the truth" in text and text.count(": noise.") == 2
    assert re.search(r"\d+ runs, \d+ of them made now in [\d:]+ of processor time", text)
    assert pictures == 2


@pytest.mark.slow
def test_the_notebook_explains_residual_stress():
    text, pictures = executed("residual_stress_notebook.py")

    def number(label, pattern=r"([-+]?[\d.]+)"):
        found = re.search(re.escape(label) + r"\s*" + pattern, text)
        assert found is not None, label
        return float(found[1])

    assert number("largest deviation of the stress:") < 5.0
    contraction = number("contraction from 1 to 10 s:")
    assert contraction == pytest.approx(number("exact:"), rel=0.01)
    elastic, plastic, creeping = (
        number(f"room temperature, thermo-{law}:")
        for law in ("elastic", "elasto-plastic", "elasto-viscoplastic")
    )
    assert creeping == pytest.approx(52.0, abs=3.0)
    assert plastic == pytest.approx(creeping, rel=0.03)
    assert elastic > 3.0 * creeping
    assert number("force of hoop stress over that of contact:") == pytest.approx(1.0, abs=0.005)
    # The thin ring: mean hoop stress = pressure times inner radius over wall.
    assert number("hoop stress, mean:") == pytest.approx(2.0 * creeping, rel=0.06)
    effect = {
        name: (number(f"\n{name} "), number(f"\n{name} ", r"[-+.\d]+ % +([-+.\d]+)"))
        for name in ("yield stress", "viscosity", "Young's modulus")
    }
    assert effect["yield stress"][1] > 5.0 * effect["Young's modulus"][1] > 0.0
    assert effect["viscosity"][0] > 4.0 > 1.0 > effect["viscosity"][1]
    for name, rule in FLOW_RULES.items():
        assert re.search(rf"^{name} +{re.escape(rule.formula)}", text, re.M)
    assert pictures == 5


@pytest.mark.slow
def test_the_ring_holds_its_core_and_keeps_residual_stress(tmp_path):
    folder = run(DEMOS / "stages.toml", output=tmp_path)
    record = json.loads((folder / "run.json").read_text())
    drawn = record["process"][0]["ejection"]["core"]
    assert 2.5e4 < drawn["force"] < 4.5e4 and record["process"][1]["time"] == 180.0
    probes, history = (read_series(folder / f"{name}.csv") for name in ("probes", "history"))
    after = history["time"] > 120.0
    assert np.isnan(probes["contact.contact_pressure"][after]).all()
    assert history["core.ejection_force"][~after].max() == pytest.approx(drawn["force"])
    assert history["energy_error"].max() < 1e-6
    # The bore was drawn out while it was hot, so that it is pressed in the end.
    assert -8e6 < probes["bore.stress.tt"][-1] < -2e6
    assert history["support_force"][-1] < 1e-6
    assert "force to draw core" in write_report(folder).read_text()


@pytest.mark.slow
def test_the_die_becomes_periodic(tmp_path):
    folder = run(DEMOS / "die_cycles.toml", output=tmp_path)
    ends = [e for e in json.loads((folder / "run.json").read_text())["process"] if "change" in e]
    assert [event["cycle"] for event in ends] == list(range(1, 9))
    assert [event["periodic"] for event in ends].index(True) in (3, 4, 5)
    probes = read_series(folder / "probes.csv")
    assert 330.0 < np.nanmax(probes["die_inside.temperature"]) < 450.0
    assert read_series(folder / "history.csv")["energy_error"].max() < 1e-6
    assert "periodic since cycle" in write_report(folder).read_text()


@pytest.mark.slow
def test_the_notebook_compares_the_contact_methods():
    text, pictures = executed("contact_notebook.py")

    def numbers(start):
        """Return the numbers that follow a text at the start of a line."""
        found = re.search(rf"^ *{re.escape(start)}(.*)$", text, re.M)
        assert found is not None, start
        return [float(n) for n in re.findall(r"(?<![\w.])[\d.]+(?:e[-+]\d+)?", found[1])]

    # The blocks: errors of the penalty and its springs in series, on both meshes.
    for penalty in ("1e+11 ", "1e+13 ", "1e+16 "):
        fine, formula, coarse = numbers(penalty)
        assert fine == pytest.approx(formula, rel=0.03) and coarse == pytest.approx(fine, rel=0.02)
    assert numbers("multipliers and condensed differ by")[0] < 1e-10
    assert numbers("order of convergence before the end:")[0] > 1.8
    for penalty in ("1e+11", "1e+12", "1e+13"):
        measured, formula = numbers(f"{penalty} Pa/m: each sweep leaves")
        assert 0.8 * formula < measured < formula
    sweeps = {h: numbers(f"{h} mm  1e+11 Pa/m") for h in ("5.00", "2.50", "1.25")}
    assert max(bodies for bodies, _ in sweeps.values()) <= 4
    assert sweeps["1.25"][1] > 1.5 * sweeps["2.50"][1] > 2.2 * sweeps["5.00"][1]
    assert numbers("5.00 mm  1e+13 Pa/m")[0] > 50
    # Costs: the augmented Lagrangian method pays for a soft penalty, sweeps for a hard one.
    dearest = {name: numbers(f"{name} costs")[1] for name in ("augmented Lagrangian", "penalty")}
    assert dearest["augmented Lagrangian"] > 1.5 * dearest["penalty"]
    assert numbers("block-iterative costs")[1] > 3.0 * dearest["penalty"]
    *rising, apart, stiffest = numbers("iterations with a penalty:")
    multipliers, condensed = numbers("iterations of multipliers and condensed:")
    assert rising == sorted(rising) and max(apart, stiffest) < rising[-1] < 50
    assert rising[-1] > 2.0 * condensed and condensed <= rising[0]
    assert multipliers < 2.0 * condensed
    # The casting: kelvins, micrometres at most and of nine in ten, penetration of each method.
    casting = {name: numbers(f"{name}  ")[:4] for name in (
        "multipliers", "augmented-lagrangian", "penalty", "penalty, 1e11 Pa/m",
        "blocks as preconditioner",
    )}  # fmt: skip
    assert casting["multipliers"][3] == 0.0
    for name in set(casting) - {"penalty, 1e11 Pa/m"}:
        kelvin, micron, _, penetration = casting[name]
        assert penetration < 0.08 and micron < 3.0 * penetration + 1e-3
        assert kelvin < 2.5 * penetration + 1e-2, "methods without penetration agree"
    kelvin, micron, of_nine, penetration = casting["penalty, 1e11 Pa/m"]
    assert kelvin > 2.0 and 0.5 * penetration < of_nine < penetration < micron
    assert pictures == 4
