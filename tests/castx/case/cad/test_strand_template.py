"""The first case of a strand is accepted, and says what its process says."""

from __future__ import annotations

import tomllib
from dataclasses import replace

import pytest

from castx.case.cad.strand_template import Slice, strand_text
from castx.case.cad.template import NewCase
from castx.case.output import Output
from castx.case.processes.process import casting_process
from castx.case.processes.strand import StrandSection, strand_plan_of
from castx.case.reading.read import load_case

pytestmark = pytest.mark.serial

SECTION = StrandSection(2, 0.0169, 0.52, (0.13, 0.13))
QUARTER = Slice(
    NewCase(
        "billet.step", 0.013, 0.012,
        (("billet", 1.4e-5), ("mould", 6e-6)), (("billet", "mould", 4e-4),),
        (("billet/cut", 4e-3), ("mould/cut", 2e-3), ("mould/outside", 5e-4)),
        across=0, growth=0.6, boxes={"billet": ((0.0, 0.0, 0.0), (0.065, 0.065, 0.0033))},
    ),
    SECTION,
    ((-0.077, -0.077, 0.0), (0.077, 0.077, 0.2)),
    ((2, 0.0033, False), (0, 0.0, True), (1, 0.0, True)),
    True,
    {
        "core": (0.0, 0.0, 0.00165), "face-x": (0.065, 0.0, 0.00165),
        "face-y": (0.0, 0.065, 0.00165), "edge": (0.0632, 0.0632, 0.00165),
    },
)  # fmt: skip
CONTINUOUS = casting_process("continuous")


def case_of(cut, alloy=None):
    plan = strand_plan_of(CONTINUOUS, alloy, None, cut.section)
    return plan, load_case(tomllib.loads(strand_text(cut, plan)))


@pytest.mark.parametrize("alloy", ["316L", "G20Mn5"])
def test_a_quarter_of_a_slice_runs_through_mould_and_sprays(alloy):
    plan, case = case_of(QUARTER, alloy)
    strand, mould = case.bodies
    assert (strand.material, strand.feeding, mould.law) == (alloy, "darcy", "rigid")
    assert case.interfaces[0].heat.entry == "steel-copper-cooled"
    cut, outside = case.boundaries
    assert cut.on == "billet/cut" and cut.displacement[0].uniform
    assert float(cut.pressure(21.0)) == pytest.approx(49e3, rel=0.05)  # 7 t/m³ over 0.7 m
    assert case.foundry.feeders == ("billet/cut",)
    assert case.foundry.passing_times == (0.7, 1.0)
    assert case.output.fields == (*Output.model_fields["fields"].default, "passing_times")
    assert [(d.direction, float(d.value(21.0))) for d in outside.displacement] == [
        ("x", pytest.approx(-4.09e-4, rel=1e-3)), ("y", pytest.approx(-4.09e-4, rel=1e-3)),
    ]  # fmt: skip
    starts = [zone.start for zone in plan.zones]
    assert [stage.at for stage in case.stages] == [*starts, plan.air]
    assert [stage.remove for stage in case.stages] == [("mould",), (), (), ()]
    for stage, zone in zip(case.stages, plan.zones, strict=False):
        ((heat,),) = (boundary.heat for boundary in stage.boundaries)
        table = heat.coefficient.table
        assert tuple(table.values) == zone.coefficients and heat.coefficient.over == "temperature"
    assert {heat.type for heat in case.stages[-1].boundaries[0].heat} == {
        "radiation", "convection",
    }  # fmt: skip
    assert case.time.end == plan.plan.end
    planes = case.geometry.cad.symmetry
    assert planes == ((2, 0.0033, False), (0, 0.0, True), (1, 0.0, True))
    assert case.geometry.cad.interface_size == pytest.approx(0.0033)


def test_probes_stand_in_the_core_at_the_walls_and_at_the_edge():
    _, case = case_of(QUARTER)
    places = {probe.name: tuple(probe.at) for probe in case.probes}
    assert places["core"] == QUARTER.places["core"]
    for name in ("face-x", "face-y", "edge"):
        assert places[name] == places[f"gap-{name}"] == QUARTER.places[name]
    of = {probe.name: (probe.body, probe.below, probe.interface) for probe in case.probes}
    assert of["edge"] == ("billet", "billet/mould", None)
    assert of["gap-edge"][2] == "billet/mould"


SLAB = replace(
    QUARTER, section=StrandSection(2, 0.09, 1.5, (0.6, 0.15)),
    block=((-0.312, -0.087, 0.0), (0.312, 0.087, 0.2)),
)  # fmt: skip


@pytest.mark.parametrize(
    "planes, section, wide, narrow, split",
    [
        ((), (0.6, 0.15), "mould-high", "mould-low", (1, 0.075)),
        (((2, 0.0025, False), (0, 0.0, True), (1, 0.0, False)), (0.6, 0.15),
         "mould-low", "mould-high", (1, -0.075)),
        ((), (0.15, 0.6), "mould-high", "mould-low", (0, 0.075)),
    ],
)  # fmt: skip
def test_rolls_hold_the_wide_face_of_a_quarter(planes, section, wide, narrow, split):
    """From the mould on, of which its wall is a body, until the strand is solid."""
    cut = replace(
        SLAB, planes=planes or SLAB.planes, section=replace(SLAB.section, extents=section)
    )
    plan, case = case_of(cut)
    assert [body.name for body in case.bodies] == ["billet", "mould-low", "mould-high"]
    assert case.geometry.cad.mould.split == pytest.approx(split)
    assert [interface.primary for interface in case.interfaces] == ["mould-low", "mould-high"]
    assert len([b for b in case.boundaries if b.on.endswith("outside") and b.displacement]) == 2
    first, *_, air, last = case.stages
    assert first.remove == ("mould-low", "mould-high") and first.at == plan.plan.release
    assert [(b.on, float(b.pressure(50.0))) for b in first.boundaries if b.pressure] == [
        ("billet/cut", 0.0)
    ]
    held = [(b.on, d.direction, d.uniform) for b in first.boundaries for d in b.displacement]
    assert held == [(f"billet/{wide}", "normal", True)]
    for stage in case.stages[:-1]:
        cooled = {boundary.on for boundary in stage.boundaries if boundary.heat}
        assert cooled == {f"billet/{wide}", f"billet/{narrow}"}
    assert air.at == plan.air and last.at == plan.rolls_end < case.time.end
    freed = [(b.on, d.direction) for b in last.boundaries for d in b.displacement]
    assert freed == [(f"billet/{wide}", "free")]
    at = {probe.name: probe.interface for probe in case.probes if probe.interface}
    across = f"gap-face-{'xyz'[split[0]]}"
    assert at.pop(across) == f"billet/{wide}"
    assert set(at.values()) == {f"billet/{narrow}"}


def test_a_wide_section_without_like_quarters_has_no_face_that_rolls_hold():
    whole = replace(SLAB, planes=QUARTER.planes[:1], quarter=False)
    plan, case = case_of(whole)
    assert "# No rolls hold a face" in strand_text(whole, plan)
    assert [body.name for body in case.bodies] == ["billet", "mould"]
    assert [stage.at for stage in case.stages] == [*(zone.start for zone in plan.zones), plan.air]
    assert not any(b.displacement for stage in case.stages for b in stage.boundaries)
    assert float(case.stages[0].boundaries[0].pressure(50.0)) == 0.0


def test_a_whole_section_has_no_taper():
    whole = replace(QUARTER, planes=QUARTER.planes[:1], quarter=False)
    plan, case = case_of(whole)
    assert not case.boundaries[1].displacement
    assert "# No taper" in strand_text(whole, plan)
    assert list(whole.dimensions(plan, 7955.0))[-1].startswith("its quarters are not alike")


def test_along_another_axis_walls_come_inwards_along_the_other_two():
    lying = StrandSection(0, 0.02, 0.6, (0.1, 0.2))
    cut = replace(
        QUARTER, section=lying, planes=((0, 0.0025, False), (1, 0.0, True), (2, 0.0, True)),
        block=((0.0, -0.062, -0.112), (0.1, 0.062, 0.112)),
    )  # fmt: skip
    plan, case = case_of(cut)
    moved = {d.direction: float(d.value(1e3)) for d in case.boundaries[1].displacement}
    assert moved == {
        "y": pytest.approx(-0.1 * plan.taper, rel=5e-3),
        "z": pytest.approx(-0.2 * plan.taper, rel=5e-3),
    }
    assert case.geometry.cad.surfaces["cut"].normal == (-1.0, 0.0, 0.0)


def test_what_a_strand_is_is_told():
    plan = strand_plan_of(CONTINUOUS, None, None, SECTION)
    what, times = QUARTER.dimensions(plan, 7955.0)
    assert what == "billet: a strand of 130 × 130 mm along z, 169 cm², 134 kg/m"
    assert times == (
        "2 m/min: 21 s in the mould, sprays to 135 s and 4.5 m, solid after some 380 s and 13 m"
    )
