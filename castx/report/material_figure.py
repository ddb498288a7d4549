"""Properties of a material over temperature as one figure, drawn with matplotlib off-screen."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes

from castx.arrays import FloatArray
from castx.errors import CaseError
from castx.materials.flow import VISCOPLASTIC, isotropic_hardening, law_problems, solid_flow
from castx.materials.granular import GranularData
from castx.materials.inelastic import FLOW_RULES
from castx.materials.material import Material
from castx.materials.thermal_strain import volumetric_thermal_strain
from castx.report.style import COLOURS, DOTS_PER_INCH, figure
from castx.tables import Table

FORMATS = (".png", ".svg", ".pdf")
COLUMNS = 3
POINTS = 600
RATES = (1e-6, 1e-4, 1e-2)
"""Strain rates for which the stress of flow is drawn [1/s]: stress relief, casting, quenching."""

STRAINS = (0.0, 0.02, 0.1)
"""Equivalent plastic strains for which the yield stress is drawn."""

LEGEND = "blue: freezing range, dots: rows of tables, dotted: beyond the range for which they hold"
FREEZING = "#dcecf7"
BESIDE = 0.12
"""Share of the freezing range that its own diagram shows on either side."""

Range = tuple[float, float]


@dataclass(frozen=True)
class Line:
    """One curve.

    Args:
        temperature: abscissae [°C].
        values: ordinates in the unit of the diagram.
        name: for the legend.
        valid: temperatures for which it is valid [°C]; dashed elsewhere, None: everywhere.
        marks: temperatures of the table behind it [°C].
    """

    temperature: FloatArray
    values: FloatArray
    name: str = ""
    valid: Range | None = None
    marks: Sequence[float] = ()


@dataclass(frozen=True)
class Diagram:
    """One set of axes.

    Args:
        label: of the ordinate, with its unit.
        lines: its curves.
        right: label, curve and limits of a second ordinate.
        heading: of the legend.
        levels: thin horizontal lines, by name.
        logarithmic: whether the ordinate is.
        within: temperatures to show [°C]; None: as in all diagrams.
    """

    label: str
    lines: Sequence[Line]
    right: tuple[str, Line, Range | None] | None = None
    heading: str = ""
    levels: Mapping[str, float] = field(default_factory=dict)
    logarithmic: bool = False
    within: Range | None = None


def write_figure(material: Material, path: Path) -> None:
    """Draw all properties of a material and write them as PNG, SVG or PDF.

    Raises:
        CaseError: another ending, a file that cannot be written, or nothing to draw.
    """
    if path.suffix.lower() not in FORMATS:
        raise CaseError(f"cannot draw {path}: the name must end in {', '.join(FORMATS)}")
    diagrams = list(material_diagrams(material))
    if not diagrams:
        raise CaseError(f"material {material.name!r} has no property to draw")
    columns = COLUMNS if len(diagrams) > 4 else min(2, len(diagrams))
    rows = -(-len(diagrams) // columns)
    with figure(4.3 * columns, 0.8 + 2.8 * rows) as (canvas, _):
        canvas.set_layout_engine("constrained", w_pad=0.12, h_pad=0.08)
        axes = canvas.subplots(rows, columns, squeeze=False).ravel()
        for axis, diagram in zip(axes, diagrams, strict=False):
            draw(axis, diagram, material)
        for axis in axes[len(diagrams) :]:
            axis.axis("off")
        canvas.suptitle(material.name, fontweight="bold")
        canvas.supxlabel(LEGEND if material.melts else LEGEND.partition(", ")[2], fontsize=8,
                         color="#5b5f66")  # fmt: skip
        try:
            canvas.savefig(path, dpi=DOTS_PER_INCH)
        except OSError as error:
            raise CaseError(f"cannot write {path}: {error.strerror}") from None


def material_diagrams(material: Material) -> Iterator[Diagram]:
    """Yield the diagrams for which a material has data."""
    ranges = {item.name: item.valid for item in material.properties()}
    shown = shown_range(material, [valid for valid in ranges.values() if valid is not None])
    description = material.description
    if None not in (description.density, description.heat_capacity, description.conductivity):
        yield from heat_diagrams(material, ranges, shown)
    if material.melts:
        yield freezing_diagram(material)
    temperature = abscissae(material, shown)
    if material.young_modulus is not None:
        young = tabled(material.young_modulus, temperature, 1e-9, ranges["young_modulus"], "E")
        right = None
        if material.poisson_ratio is not None:
            poisson = material.poisson_ratio
            line = tabled(poisson, temperature, 1.0, ranges["poisson_ratio"])
            right = ("Poisson's ratio", line, (0.0, 0.5))
        yield Diagram("Young's modulus [GPa]", [young], right)
    if material.expansion is not None:
        yield strain_diagram(material, temperature, ranges["expansion"])
    if description.yield_stress is not None:
        yield Diagram("yield stress [MPa]", yield_lines(material, temperature, ranges))
    if description.granular is not None:
        yield granular_diagram(description.granular, temperature, ranges)
    if not list(law_problems(description, VISCOPLASTIC)):
        lines = creep_lines(material, temperature, ranges)
        yield Diagram("stress of flow [MPa]", lines, heading="strain rate", logarithmic=True)


def granular_diagram(
    granular: GranularData, temperature: FloatArray, ranges: Mapping[str, Range | None]
) -> Diagram:
    """Return the diagram of what holds grains together.

    Args:
        granular: their yield surface.
        temperature: abscissae [°C].
        ranges: of validity by property.
    """
    tables = {"cohesion": granular.cohesion, "tension_cut_off": granular.tension_cut_off}
    lines = [
        tabled(table, temperature, 1e-6, ranges[f"granular.{key}"], key.replace("_", " "))
        for key, table in tables.items()
        if table is not None
    ]
    return Diagram("cohesion [MPa]", lines)


def abscissae(material: Material, shown: Range) -> FloatArray:
    """Return temperatures [°C] to draw at, with the rows of all tables."""
    tables = [item.value for item in material.properties() if isinstance(item.value, Table)]
    rows = np.concatenate([np.array(shown), *(table.arguments for table in tables)])
    inside = rows[(rows >= shown[0]) & (rows <= shown[1])]
    return np.union1d(np.linspace(*shown, POINTS, dtype=np.float64), inside)


def shown_range(material: Material, ranges: Sequence[Range]) -> Range:
    """Return the temperatures to draw [°C]: all ranges, but not far into the melt."""
    low = min([20.0, *(valid[0] for valid in ranges)])
    high = max([100.0, *(valid[1] for valid in ranges)])
    if material.liquidus is not None:
        high = min(high, 1.15 * material.liquidus) if ranges else 1.15 * material.liquidus
    return low, max(high, material.liquidus or high)


def heat_diagrams(
    material: Material, ranges: Mapping[str, Range | None], shown: Range
) -> Iterator[Diagram]:
    """Yield conductivity, heat capacity, diffusivity and enthalpy, through the freezing range."""
    curve = material.enthalpy
    first, last = curve.enthalpy(np.array(shown))
    inner = curve.enthalpies[(curve.enthalpies > first) & (curve.enthalpies < last)]
    enthalpy = np.union1d(np.linspace(first, last, POINTS), inner)
    temperature, fraction = curve.temperature(enthalpy), curve.solid_fraction(enthalpy)
    conductivity = material.conductivity(temperature, fraction)
    capacity = material.heat_capacity(temperature, fraction)

    def line(values: FloatArray, *names: str) -> Line:
        return Line(temperature, values, valid=common_range(ranges, names))

    yield Diagram("thermal conductivity [W/m/K]", [line(conductivity, "conductivity")])
    yield Diagram("heat capacity [J/kg/K]", [line(capacity, "heat_capacity")])
    diffusivity = np.asarray(1e6 * conductivity / (material.density * capacity))
    both = line(diffusivity, "conductivity", "heat_capacity")
    yield Diagram("thermal diffusivity [mm²/s]", [both])
    specific = line(np.asarray(1e-3 * enthalpy / material.density), "heat_capacity")
    yield Diagram("enthalpy [kJ/kg]", [specific])


def common_range(ranges: Mapping[str, Range | None], names: Sequence[str]) -> Range | None:
    """Return the temperatures for which all properties are valid, in solid and liquid together."""
    found = []
    for name in names:
        parts = [ranges[key] for key in (name, f"{name}.solid", f"{name}.liquid") if key in ranges]
        known = [part for part in parts if part is not None]
        if known:
            found.append((min(part[0] for part in known), max(part[1] for part in known)))
    return (max(v[0] for v in found), min(v[1] for v in found)) if found else None


def freezing_diagram(material: Material) -> Diagram:
    """Return the solid fraction, over the freezing range alone."""
    assert material.solidus is not None and material.liquidus is not None
    margin = max(BESIDE * (material.liquidus - material.solidus), 5.0)
    within = material.solidus - margin, material.liquidus + margin
    # The law without its ends, where eutectic that is left makes it jump.
    inside = np.linspace(material.solidus, material.liquidus, POINTS, dtype=np.float64)[:-1]
    melting = material.solid_fraction_at(inside[: POINTS * (material.solidus < material.liquidus)])
    temperature = [within[0], material.solidus, *inside[: melting.size], material.liquidus]
    fraction = [1.0, 1.0, *melting, 0.0]
    line = Line(np.array([*temperature, within[1]]), np.array([*fraction, 0.0]))
    levels = {} if material.liquid is None else {"coherency": material.liquid.coherency}
    return Diagram("solid fraction", [line], levels=levels, within=within)


def tabled(
    table: Table, temperature: FloatArray, factor: float, valid: Range | None, name: str = ""
) -> Line:
    """Return the curve of a table with its rows marked."""
    marks = () if table.is_constant else tuple(table.arguments)
    return Line(temperature, factor * table(temperature), name, valid, marks)


def strain_diagram(material: Material, temperature: FloatArray, valid: Range | None) -> Diagram:
    """Return the linear thermal strain from the stress-free temperature, and the mean expansion."""
    assert material.expansion is not None
    stress_free = material.stress_free_temperature(20.0)
    strain = 100.0 / 3.0 * volumetric_thermal_strain(material, temperature, stress_free)
    mean = tabled(material.expansion, temperature, 1e6, valid)
    lines = [Line(temperature, strain, f"from {stress_free:g} °C", valid)]
    return Diagram("thermal strain [%]", lines, ("mean expansion [µm/m/K]", mean, None))


def yield_lines(
    material: Material, temperature: FloatArray, ranges: Mapping[str, Range | None]
) -> list[Line]:
    """Return the yield stress at some plastic strains, the first one only without hardening."""
    table = material.description.yield_stress
    assert table is not None
    first = tabled(table, temperature, 1e-6, ranges["yield_stress"], "first yield")
    if not material.description.hardening.acts:
        return [first]
    flow = solid_flow(
        material, "thermo-elasto-plastic", np.ones_like(temperature), temperature, step=1.0
    )
    lines = [first]
    for strain in STRAINS[1:]:
        equivalent = np.full_like(temperature, strain)
        stress = flow.yield_stress + isotropic_hardening(flow, equivalent)
        name = f"after {100 * strain:g} % strain"
        lines.append(Line(temperature, 1e-6 * stress, name, ranges["yield_stress"]))
    return lines


def creep_lines(
    material: Material, temperature: FloatArray, ranges: Mapping[str, Range | None]
) -> list[Line]:
    """Return the stress at which the unhardened solid flows at some rates."""
    flow = solid_flow(material, VISCOPLASTIC, np.ones_like(temperature), temperature, step=1.0)
    valid = ranges.get(FLOW_RULES[material.description.law].keys[0].name)
    return [
        Line(
            temperature,
            1e-6 * (flow.yield_stress + flow.overstress(rate)),
            rf"$10^{{{np.log10(rate):.0f}}}$ 1/s",
            valid,
        )
        for rate in RATES
    ]


def draw(axis: Axes, diagram: Diagram, material: Material) -> None:
    """Draw one diagram."""
    for line, colour in zip(diagram.lines, COLOURS, strict=False):
        draw_line(axis, line, colour)
    for name, level in diagram.levels.items():
        axis.axhline(level, color="#8a8f98", linewidth=0.9, linestyle=(0, (6, 4)), zorder=1)
        axis.annotate(
            name, (0.02, level), xycoords=("axes fraction", "data"), xytext=(0, 3),
            textcoords="offset points", fontsize=8, color="#5b5f66",
        )  # fmt: skip
    if diagram.logarithmic:
        axis.set_yscale("log")
    if material.solidus is not None and material.liquidus is not None:
        ends = (material.solidus, material.liquidus)
        if ends[0] < ends[1]:
            axis.axvspan(*ends, color=FREEZING, linewidth=0, zorder=0)
        else:
            axis.axvline(ends[0], color="#9cc5e3", linewidth=1.0, zorder=0)
    if diagram.within is not None:
        axis.set_xlim(*diagram.within)
    axis.margins(x=0.02)
    axis.set_xlabel("temperature [°C]")
    axis.set_ylabel(diagram.label)
    if len(diagram.lines) > 1:
        axis.legend(loc="best", fontsize=8, title=diagram.heading, title_fontsize=8)
    if diagram.right is not None:
        label, line, limits = diagram.right
        right = axis.twinx()
        draw_line(right, line, COLOURS[1])
        right.grid(visible=False)
        right.spines["right"].set_visible(True)
        right.set_ylabel(label, color=COLOURS[1])
        if limits is not None:
            right.set_ylim(*limits)
        axis.yaxis.label.set_color(COLOURS[0])


def draw_line(axis: Axes, line: Line, colour: str) -> None:
    """Draw a curve: dotted where it is not valid, with dots at the rows of its table."""
    low, high = line.valid or (-np.inf, np.inf)
    inside = (line.temperature >= low) & (line.temperature <= high)
    axis.plot(line.temperature, line.values, color=colour, linewidth=1.0, linestyle=":")
    valid = np.where(inside, line.values, np.nan)
    axis.plot(line.temperature, valid, color=colour, label=line.name)
    if line.marks:
        at = np.array(line.marks)
        marked = np.interp(at, line.temperature, line.values)
        axis.plot(at, marked, "o", color=colour, markersize=3.5)
