"""A first case file for a CAD part, from a coarse mesh of it."""

from __future__ import annotations

import math
import os
from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

from scipy.optimize import brentq

from castx.case.cad.geometry import SUFFIXES, CadGeometry, is_cad_file
from castx.case.cad.mould import AXES
from castx.case.cad.process_template import process_text
from castx.case.cad.template import NewCase, case_text
from castx.case.processes.plan import plan_of
from castx.case.processes.process import casting_process
from castx.case.reading.read import load_case
from castx.case.skin import MOST_GROWTH, skins
from castx.domain.cad.guarded import SizesError, meshed_apart
from castx.errors import CaseError, MeshError
from castx.input.entries import Quantity
from castx.input.toml_text import parse_toml
from castx.input.units import LENGTH
from castx.materials.database import database_entry
from castx.materials.lookup import find_material
from castx.meshes.cad.description import Box, CadFile, CadPart, Mould
from castx.meshes.cad.report import Report

MARGIN = 0.25
"""Thickness of the mould round a lone solid, in extents of the solid."""
GROWTH: float = CadGeometry.model_fields["growth"].default
"""By how much sizes grow over a distance if a case says nothing else."""
EDGES = 1.3
"""What edges of interfaces and the changes between sizes add to the cells of plane layers."""
BUDGET = 60.0
"""Time for the mesh with one cell across walls, and for reading a part before [s]."""
LAST_BUDGET = 600.0
"""Time for the coarsest mesh [s]."""
GUESSED = "AlSi7Mg"
"""Alloy of a case of no process."""
TOLERANCE = 1e-4
"""Width up to which faces are removed where small ones ask for too many cells [m]."""
NARROWEST = (1e-3, 3e-3)
"""Widths of the narrowest faces that are left in where the others ask for too many cells [m]."""
NEXT = (
    "walls as they come",
    f"without faces narrower than {1e3 * TOLERANCE:g} mm",
    *(f"without grooves, threads and roundings of less than {1e3 * x:g} mm" for x in NARROWEST),
)
"""What is tried after a mesh that is refused."""
CURE = (
    f"It is refused without what is narrower than {1e3 * NARROWEST[-1]:g} mm too, as far as that "
    "can be left out: suppress grooves, threads, roundings and slivers that are not cast in CAD, "
    "and export the part again"
)
"""What helps where nothing that is tried makes a mesh."""
FIRST_CELLS = 1e5
"""Cells of a first mesh, with which a step takes seconds."""
AFFORDABLE = 10_000
"""Cells of a first mesh beyond which those away from walls and faces grow faster; beyond twice as
many walls are taken as they come."""
GROWN = 1.0
"""By how much their sizes grow then over a distance."""
WORTH = 0.9
"""Share of the cells that a faster growth has to leave at most, else cells grow as usual."""


@dataclass(frozen=True)
class Wanted:
    """Wishes of a user for a new case.

    Attributes:
        process: one of `castx.case.processes`; None: none, choices are left to the user.
        alloy: of the database; None: that of the process.
        mould: material of the mould; None: that of the process.
        split: axis of the plane that divides the mould in the middle of the part, as "z", or the
            plane, as "z=12mm"; None: the mould is one body.
        open_top: whether the block ends at the top of the part, which is open to the air.
    """

    process: str | None = None
    alloy: str | None = None
    mould: str | None = None
    split: str | None = None
    open_top: bool = False


NOTHING = Wanted()


def _silent(text: str) -> None:
    """Say nothing."""


def write_new_case(
    cad_file: Path, target: Path, wanted: Wanted = NOTHING, say: Callable[[str], None] = _silent
) -> None:
    """Write a case file for a CAD file; call it on one rank only.

    Args:
        cad_file: with solids.
        target: the case file, which must not exist.
        wanted: process, alloy and mould.
        say: gets lines about what goes on, and the dimensions of the castings.

    Raises:
        CaseError: the file is no CAD file, the case file exists or cannot be written, or what is
            wanted is not known.
        MeshError: the CAD file cannot be meshed.
    """
    if not is_cad_file(cad_file):
        raise CaseError(f"{cad_file}: a CAD file is needed: {', '.join(SUFFIXES)}")
    if target.exists():
        raise CaseError(f"{target} exists; give another one with --output, or remove it")
    if wanted.process is None and (wanted.alloy or wanted.mould):
        raise CaseError("--alloy and --mould need --process, which says how they meet")
    case = with_interface_size(new_case(cad_file, target, wanted, say))
    alloy = GUESSED
    if wanted.process is None:
        text = case_text(case)
    else:
        process = casting_process(wanted.process)
        modulus = max(case.modulus(name) for name in case.castings)
        plan = plan_of(process, wanted.alloy, wanted.mould, modulus)
        text = process_text(case, plan, database_entry(plan.alloy).material_class)
        alloy = plan.alloy
    for line in case.taken_for():
        say(line)
    for line in case.dimensions(find_material(alloy, {}).density):
        say(line)
    try:
        target.write_text(text)
    except OSError as error:
        raise CaseError(f"cannot write {target}: {error.strerror}") from None


def new_case(
    cad_file: Path, target: Path, wanted: Wanted = NOTHING, say: Callable[[str], None] = _silent
) -> NewCase:
    """Return the data of a new case, found by a coarse mesh of a CAD file.

    Args:
        cad_file: with solids; a lone one gets a mould, and so does a casting that lies bare.
        target: the case file to which its path is relative.
        wanted: process and mould.
        say: gets lines about what goes on.

    Raises:
        CaseError: a mould is wanted of a part that has one, or a plane is none.
    """
    say(f"meshing {cad_file.name}, coarsely, to see its bodies and faces")
    report, attempt = _survey(cad_file, None, say)
    file = os.path.relpath(cad_file.resolve(), target.resolve().parent)
    drawn = _as_case(report, file, _tries(cad_file)[attempt], None, None)
    lone = len(drawn.bodies) == 1
    if lone or (not drawn.has_mould and drawn.bare()):
        margin = _margin(report.extent, wanted)
        mould, text = _mould(_around(drawn, wanted), margin, wanted)
        say(f"meshing it again, in {'its' if lone else 'a'} mould")
        report, attempt = _survey(cad_file, mould, say, attempt)
        report, made = _affordable(report, _tries(cad_file, mould)[attempt], say)
        return _as_case(report, file, made, margin, text)
    if wanted.split is not None or wanted.open_top:
        names = ", ".join(name for name, _ in drawn.bodies)
        raise CaseError(
            "--split and --top act on a mould that castx new makes, where a file has none; "
            f"{cad_file} has the bodies {names}"
        )
    report, made = _affordable(report, _tries(cad_file)[attempt], say)
    return _as_case(report, file, made, None, None)


def _affordable(
    report: Report, made: CadPart, say: Callable[[str], None]
) -> tuple[Report, CadPart]:
    """Return a mesh with fewer cells where there are many, and its part.

    Cells away from walls and faces grow faster first. Where that leaves twice as many as a first
    run can afford, walls are taken as they come: they have one cell across all the same, and bend
    no worse with one that is longer.

    Args:
        report: of the mesh as it is.
        made: its part.
        say: gets lines about what goes on.
    """
    if report.quality.cells > AFFORDABLE:
        text = "by which walls and faces keep theirs, and those in the mould are larger"
        report, made = _with_fewer(report, made, replace(made, growth=GROWN), say, text)
    if report.quality.cells > 2 * AFFORDABLE and made.across > 0:
        text = "by which walls have one across all the same, but longer ones"
        report, made = _with_fewer(report, made, replace(made, across=0), say, text)
    return report, made


def _with_fewer(
    report: Report, made: CadPart, other: CadPart, say: Callable[[str], None], text: str
) -> tuple[Report, CadPart]:
    """Return the mesh of another part with its part, if that has far fewer cells."""
    cells = report.quality.cells
    try:
        with TemporaryDirectory() as folder:
            found = meshed_apart(other, Path(folder) / "mesh.msh", BUDGET)
    except SizesError:
        return report, made
    if found.quality.cells > WORTH * cells:
        return report, made
    key = "growth = 1" if other.growth != made.growth else "across = 0"
    say(f"{cells} cells; {found.quality.cells} with {key}, {text}")
    return found, other


def _around(case: NewCase, wanted: Wanted) -> Box:
    """Return the box round all solids; an open top is that of the castings."""
    lows, highs = zip(*case.boxes.values(), strict=True)
    low = [min(values) for values in zip(*lows, strict=True)]
    high = [max(values) for values in zip(*highs, strict=True)]
    if wanted.open_top:
        high[2] = max(case.boxes[name][1][2] for name in case.castings)
    return (low[0], low[1], low[2]), (high[0], high[1], high[2])


def _as_case(
    report: Report, file: str, made: CadPart, margin: float | None, text: str | None
) -> NewCase:
    """Return the data of a new case by the report of its coarse mesh.

    Args:
        report: of the mesh.
        file: as the case names it.
        made: of which the mesh is.
        margin: of a mould that is made [m].
        text: of such a mould.
    """
    between = [(measure.name.split("/"), measure.cad) for measure in report.interfaces]
    return NewCase(
        file,
        _rounded(report.size),
        margin,
        tuple((measure.name, measure.cad) for measure in report.bodies),
        tuple((bodies[0], bodies[1], area) for bodies, area in between),
        tuple((measure.name, measure.cad) for measure in report.surfaces),
        round(made.across),
        mould=text,
        tolerance=made.tolerance if made.tolerance == TOLERANCE else None,
        narrowest=made.narrowest or None,
        growth=None if made.growth == GROWTH else made.growth,
        boxes=report.boxes,
    )


def _margin(extent: float, wanted: Wanted) -> float:
    """Return the thickness of a mould round a part of an extent [m]."""
    numbers = {} if wanted.process is None else casting_process(wanted.process).numbers
    return numbers.get("shell", _rounded(numbers.get("wall", MARGIN) * extent))


def _mould(box: Box, margin: float, wanted: Wanted) -> tuple[Mould, str]:
    """Return the mould round the solids, and its line in the case file.

    Args:
        box: of the solids [m].
        margin: of the block [m].
        wanted: planes and top.
    """
    split = None if wanted.split is None else _plane(wanted.split, box)
    text = f'"{1e3 * margin:.3g} mm"'
    block: Box | None = None
    if wanted.open_top:
        low, high = ([round(x, 7) for x in corner] for corner in box)
        lowest, highest = [x - margin for x in low], [x + margin for x in high]
        highest[2] = high[2]
        block = (lowest[0], lowest[1], lowest[2]), (highest[0], highest[1], highest[2])
        text = ", ".join(f"[{', '.join(f'{x:.7g}' for x in corner)}]" for corner in block)
        text = f"[{text}]"
    parts = [f"box = {text}"]
    if split is not None:
        parts.append(f'split = "{AXES[split[0]]} = {1e3 * split[1]:.5g} mm"')
    process = None if wanted.process is None else casting_process(wanted.process)
    what = "a block round the part"
    if process is not None and "shell" in process.numbers:
        what += "; a shell is lighter in pockets and cools sooner: draw it in CAD for results"
    line = f"mould = {{ {', '.join(parts)} }}      # {what}\n"
    return Mould(margin=0.0 if block else margin, box=block, split=split), line


def _plane(wanted: str, box: Box) -> tuple[int, float]:
    """Return axis and place [m] of a plane such as "z", in the middle of a box, or "z=12mm"."""
    axis, sign, place = (part.strip() for part in wanted.partition("="))
    if axis not in AXES or (sign and not place):
        raise CaseError(f'--split: a plane across x, y or z is needed: z or "z=12mm", got {wanted}')
    number = AXES.index(axis)
    if not sign:
        low, high = box[0][number], box[1][number]
        # The box is that of a mesh, which cuts round corners: a plane that misses the seam of a
        # cylinder by hundredths of a millimetre leaves slivers.
        step = 10.0 ** math.floor(math.log10(high - low) - 2.0)
        return number, round(0.5 * (low + high) / step) * step
    return number, Quantity(LENGTH).read(place)


def with_interface_size(case: NewCase) -> NewCase:
    """Return a new case with cells that resolve its skins, if they have to be finer for that.

    The number of cells grows at most to `MOST_GROWTH` of what the largest size alone would make.
    """
    areas: dict[str, float] = defaultdict(float)
    for first, second, area in case.interfaces:
        areas[first] += area
        areas[second] += area
    for on, area in case.surfaces:
        areas[on.partition("/")[0]] += area
    moduli = {body: v / areas[body] for body, v in case.bodies if areas[body] > 0.0}
    foreseen = skins(load_case(parse_toml(case_text(case))), moduli)
    wanted = min((skin.proposal for skin in foreseen), default=case.size)
    size = max(wanted, _finest(case))
    return replace(case, interface_size=_rounded(size)) if size < case.size else case


def _finest(case: NewCase) -> float:
    """Return the size at interfaces with which a mesh has as many cells as it may [m]."""
    growth = case.growth or GROWTH
    least = sum(volume for _, volume in case.bodies) / case.size**3
    area = 2.0 * sum(area for *_, area in case.interfaces)  # both sides

    def excess(size: float) -> float:
        layers = 0.5 * (size**-2 - case.size**-2) - (case.size - size) / case.size**3
        return EDGES * area * layers / growth - (MOST_GROWTH[3] - 1.0) * least

    least_size = 1e-3 * case.size
    if excess(least_size) <= 0.0:
        return least_size
    return float(brentq(excess, least_size, case.size, xtol=1e-3 * case.size))


def _survey(
    cad_file: Path, mould: Mould | None, say: Callable[[str], None], attempt: int = 0
) -> tuple[Report, int]:
    """Return the report of a coarse mesh and which of `_tries` has made it.

    Args:
        cad_file: with solids.
        mould: made round them.
        say: gets lines about what goes on.
        attempt: to begin with.
    """
    tries = _tries(cad_file, mould)
    with TemporaryDirectory() as folder:
        mesh = Path(folder) / "mesh.msh"
        for number in range(attempt, len(tries) - 1):
            try:
                return meshed_apart(tries[number], mesh, BUDGET), number
            except SizesError:
                say(f"that makes no first mesh; next: {NEXT[number]}")
        try:
            return meshed_apart(tries[-1], mesh, LAST_BUDGET), len(tries) - 1
        except SizesError as error:
            raise MeshError(f"{error}. {CURE}") from None


def _tries(cad_file: Path, mould: Mould | None = None) -> list[CadPart]:
    """Return the parts that are meshed, coarsely, until one makes a mesh.

    One cell across each wall is tried first, then walls as they come, then without small faces,
    then without all that narrow faces bound.
    """
    part = CadPart((CadFile(str(cad_file)),), math.inf, across=0, curvature=8.0, mould=mould)
    coarse = replace(part, most_cells=FIRST_CELLS)
    return [
        replace(coarse, across=1), coarse, replace(coarse, tolerance=TOLERANCE),
        *(replace(coarse, narrowest=width) for width in NARROWEST[:-1]),
        replace(part, narrowest=NARROWEST[-1]),
    ]  # fmt: skip


def _rounded(length: float) -> float:
    """Return a length with two digits [m]."""
    return float(f"{length:.2g}")
