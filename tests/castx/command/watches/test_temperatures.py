"""Temperatures that nothing has end a run, and a heat balance that does not close is told once."""

from types import SimpleNamespace

import pytest

from castx.case.reading.read import load_case
from castx.command.cli import execute
from castx.command.watches.temperatures import TemperatureWatch
from castx.errors import ConvergenceError

CASE = load_case("demos/cylinder.toml")
ONE_TEMPERATURE = ["bodies.0.temperature=200", "bodies.1.temperature=200", "boundaries=[]"]


def state(**totals):
    named = {name.replace("__", "."): value for name, value in totals.items()}
    return SimpleNamespace(time=2.0, totals=named)


@pytest.mark.serial
@pytest.mark.parametrize(
    ("totals", "text"),
    [
        ({"mould__min_temperature": -273.2}, "mould is at -273.2 °C, below absolute zero, -273.15"),
        ({"casting__max_temperature": 10_001.0}, "casting is at 10001 °C, above 10000 °C, where"),
        ({"casting__min_temperature": -273.155, "mould__max_temperature": 9_999.0}, ""),
        ({}, ""),
    ],
)
def test_a_body_that_is_colder_or_hotter_than_can_be_ends_the_run(comm, totals, text):
    watch = TemperatureWatch(CASE, comm)
    if not text:
        return watch.check(state(**totals))
    with pytest.raises(ConvergenceError, match=f"^at t = 2 s {text}"):
        watch.check(state(**totals))


@pytest.mark.serial
def test_a_heat_balance_that_does_not_close_is_told_once(comm, caplog):
    watch = TemperatureWatch(CASE, comm)
    watch.check(state(energy_error=0.049))
    assert caplog.messages == []
    for error in (-0.051, 0.5):
        watch.check(state(energy_error=error))
    (text,) = caplog.messages
    assert "off by 5.1 % of the heat that has moved" in text and "mistaken unit" in text


@pytest.mark.serial
def test_a_body_colder_than_all_that_the_case_has_is_told_once(comm, caplog):
    """The demo has 200 to 670 °C: 4.7 K below are let pass."""
    watch = TemperatureWatch(CASE, comm)
    watch.check(state(mould__min_temperature=195.4))
    assert caplog.messages == []
    for coldest in (195.2, -20.0):
        watch.check(state(mould__min_temperature=coldest))
    (text,) = caplog.messages
    assert "at t = 2 s mould is at 195.2 °C, colder than all that the case has, 200 °C: its" in text


@pytest.mark.serial
def test_a_body_hotter_than_all_that_the_case_has_is_told_once(comm, caplog):
    """As melt that gets the latent heat of the skin beside it."""
    watch = TemperatureWatch(CASE, comm)
    watch.check(state(casting__max_temperature=674.6))
    assert caplog.messages == []
    for hottest in (674.8, 690.0):
        watch.check(state(casting__max_temperature=hottest, mould__min_temperature=195.0))
    hot, cold = sorted(caplog.messages)
    assert "casting is at 674.8 °C, hotter than all that the case has, 670 °C: its cells" in hot
    assert "mould is at 195 °C, colder than all" in cold


@pytest.mark.serial
def test_rounding_and_plastic_work_are_not_told_in_a_case_of_one_temperature(comm, caplog):
    """All of it is at 200 °C: a kelvin either way is let pass."""
    watch = TemperatureWatch(load_case("demos/cylinder.toml", ONE_TEMPERATURE), comm)
    watch.check(state(casting__min_temperature=200.0 - 1e-12, mould__max_temperature=200.003))
    watch.check(state(casting__min_temperature=199.1, mould__max_temperature=200.9))
    assert caplog.messages == []
    watch.check(state(casting__min_temperature=198.9, mould__max_temperature=201.1))
    cold, hot = caplog.messages
    assert "casting is at 198.9 °C, colder than all that the case has, 200 °C: its cells" in cold
    assert "mould is at 201.1 °C, hotter than all that the case has, 200 °C: its cells" in hot


@pytest.mark.serial
@pytest.mark.parametrize(
    "given",
    [
        'boundaries=[{ on = "mould/outside", heat = { type = "flux", value = -1e3 } }]',
        'bodies.1.temperature={ formula = "150 + 1000*r" }',
        'boundaries=[{ on = "mould/outside", heat = { type = "temperature", value = 20 } }]',
    ],
)
def test_nothing_is_told_where_heat_is_drawn_or_other_temperatures_are_named(comm, caplog, given):
    watch = TemperatureWatch(load_case("demos/cylinder.toml", [given]), comm)
    watch.check(state(mould__min_temperature=100.0))
    assert caplog.messages == []


@pytest.mark.serial
def test_a_source_may_heat_beyond_all_that_the_case_names(comm, caplog):
    given = "bodies.0.heat_source=1e6"
    TemperatureWatch(load_case("demos/cylinder.toml", [given]), comm).check(
        state(casting__max_temperature=900.0)
    )
    assert caplog.messages == []


def test_a_flux_that_draws_more_than_there_is_ends_the_run(comm, shared_tmp_path, capsys):
    change = 'boundaries=[{ on = "mould/outside", heat = { type = "flux", value = -1e8 } }]'
    given = [
        change,
        'output.fields=["temperature"]',
        'coupling.scheme="thermal"',
        "geometry.size=1e-2",
        "probes=[]",
    ]
    arguments = ["run", "demos/cylinder.toml", "--output", str(shared_tmp_path / "out")]
    assert execute([*arguments, *(f"--set={one}" for one in given)], comm) == 3
    if comm.rank == 0:
        said = " ".join(capsys.readouterr().err.split())
        assert "mould is at -" in said and "look at fluxes, heat sources" in said
