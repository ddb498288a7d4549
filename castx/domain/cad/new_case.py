"""A first case file for a CAD part, from a coarse mesh of it."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from castx.case.cad.geometry import SUFFIXES, is_cad_file
from castx.case.cad.mould import AXES, plane
from castx.case.cad.process_template import process_text
from castx.case.cad.strand_template import strand_text
from castx.case.cad.template import MOULD, PLUG, NewCase, case_text
from castx.case.processes.plan import ShellSize, chosen, plan_of, rounded
from castx.case.processes.process import CastingProcess, casting_process, refuse_options
from castx.case.processes.strand import strand_plan_of
from castx.domain.cad.first_mesh import (
    BUDGET,
    Say,
    affordable,
    as_case,
    part_as_it_comes,
    survey,
)
from castx.domain.cad.first_sizes import with_interface_size, with_soaked_cells
from castx.domain.cad.guarded import seen_apart
from castx.domain.cad.strand import new_slice
from castx.errors import CaseError, MeshError
from castx.materials.database import database_entry
from castx.materials.lookup import find_material
from castx.meshes.cad.description import Box, Mould

MARGIN = 0.25
"""Thickness of the mould round a lone solid, in extents of the solid."""
NEAR = 0.05
"""Share of its extent by which a mould parts beside the middle of a part, to part at a face."""
BESIDE = 0.01
"""Share of its extent that a part may seem to end before the plane that its mould parts at."""
FLAT = 1e-8
"""Extent across itself up to which a face is flat [m]."""
GUESSED = "AlSi7Mg"
"""Alloy of a case of no process."""


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

    @property
    def of_mould(self) -> list[str]:
        """Names of the options that are given for a mould that is made."""
        given = {"split": self.split is not None, "top": self.open_top}
        return [name for name, wanted in given.items() if wanted]


NOTHING = Wanted()


def _silent(_: str) -> None:
    """Say nothing."""


def write_new_case(
    cad_file: Path, target: Path, wanted: Wanted = NOTHING, say: Say = _silent
) -> None:
    """Write a case file for a CAD file; call it on one rank only.

    Args:
        cad_file: with solids.
        target: the case file, which must not exist.
        wanted: process, alloy and mould.
        say: gets lines about what goes on, and the dimensions of the castings.

    Raises:
        CaseError: the file is no CAD file, the case file exists or cannot be written, or what is
            wanted is not known or not for the process.
        MeshError: the CAD file cannot be meshed.
    """
    if not is_cad_file(cad_file):
        raise CaseError(f"{cad_file}: a CAD file is needed: {', '.join(SUFFIXES)}")
    if target.exists():
        raise CaseError(f"{target} exists; give another one with --output, or remove it")
    if wanted.process is None and (wanted.alloy or wanted.mould):
        raise CaseError("--alloy and --mould need --process, which says how they meet")
    process = None if wanted.process is None else casting_process(wanted.process)
    if process is not None:  # refused before anything is meshed
        chosen(process, wanted.alloy, wanted.mould)
        refuse_options(process, wanted.of_mould)
    if process is not None and process.is_strand:
        text, lines = _strand(cad_file, target, process, wanted, say)
    else:
        text, lines = _mould_casting(cad_file, target, process, wanted, say)
    for line in lines:
        say(line)
    try:
        target.write_text(text)
    except OSError as error:
        raise CaseError(f"cannot write {target}: {error.strerror}") from None


def _mould_casting(
    cad_file: Path, target: Path, process: CastingProcess | None, wanted: Wanted, say: Say
) -> tuple[str, list[str]]:
    """Return the case file of a casting in its mould, and what is to be said of it."""
    case = with_interface_size(new_case(cad_file, target, wanted, say))
    if process is None:
        text, alloy = case_text(case), GUESSED
    else:
        modulus = max(case.modulus(name) for name in case.castings)
        plan = plan_of(process, wanted.alloy, wanted.mould, modulus, shell_of(case))
        of_class = database_entry(plan.alloy).material_class
        case = with_soaked_cells(case, process_text(case, plan, of_class), say)
        text = process_text(case, plan, of_class)
        alloy = plan.alloy
    return text, [*case.taken_for(), *case.dimensions(find_material(alloy, {}).density)]


def shell_of(case: NewCase) -> ShellSize | None:
    """Return volume and outer surface of a mould that is made round castings, by their area.

    None: none is made.
    """
    if case.margin is None:
        return None
    volumes, role = dict(case.bodies), case.roles
    area = sum(volumes[name] / case.modulus(name) for name in case.castings)
    made = [name for name in volumes if role[name] == MOULD]
    free = sum(size for on, size in case.surfaces if on.partition("/")[0] in made)
    return ShellSize(sum(volumes[name] for name in made) / area, free / area)


def _strand(
    cad_file: Path, target: Path, process: CastingProcess, wanted: Wanted, say: Say
) -> tuple[str, list[str]]:
    """Return the case file of a slice of a strand, and what is to be said of it."""
    cut = new_slice(cad_file, target, process.numbers["shell"], say)
    plan = strand_plan_of(process, wanted.alloy, wanted.mould, cut.section)
    density = find_material(plan.plan.alloy, {}).density
    return strand_text(cut, plan), list(cut.dimensions(plan, density))


def new_case(cad_file: Path, target: Path, wanted: Wanted = NOTHING, say: Say = _silent) -> NewCase:
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
    part = part_as_it_comes(cad_file)
    found = survey(part, say)
    file = os.path.relpath(cad_file.resolve(), target.resolve().parent)
    drawn = as_case(found, file)
    lone = len(drawn.bodies) == 1
    if lone or (not drawn.has_mould and drawn.bare()):
        margin = _margin(found.report.extent, wanted)
        split = _split(cad_file, wanted, _around(drawn, wanted), say)
        mould = _mould(_around(drawn, wanted), margin, wanted, split)
        say(f"meshing it again, in {'its' if lone else 'a'} mould")
        found = survey(replace(part, mould=mould), say, found.attempt)
        plugged = any(body.name == PLUG for body in found.report.bodies)
        text = _mould_text(replace(mould, plug=PLUG if plugged else None))
        return as_case(affordable(found, say), file, margin, text)
    if wanted.of_mould:
        names = ", ".join(name for name, _ in drawn.bodies)
        raise CaseError(
            "--split and --top act on a mould that castx new makes, where a file has none; "
            f"{cad_file} has the bodies {names}"
        )
    return as_case(affordable(found, say), file)


def _around(case: NewCase, wanted: Wanted) -> Box:
    """Return the box round all solids; an open top is that of the castings."""
    lows, highs = zip(*case.boxes.values(), strict=True)
    low = [min(values) for values in zip(*lows, strict=True)]
    high = [max(values) for values in zip(*highs, strict=True)]
    if wanted.open_top:
        high[2] = max(case.boxes[name][1][2] for name in case.castings)
    return (low[0], low[1], low[2]), (high[0], high[1], high[2])


def _margin(extent: float, wanted: Wanted) -> float:
    """Return the thickness of a mould round a part of an extent [m]."""
    return _shell(wanted) or rounded(_numbers(wanted).get("wall", MARGIN) * extent)


def _numbers(wanted: Wanted) -> Mapping[str, float]:
    """Return the numbers of a process, none if none is wanted."""
    return {} if wanted.process is None else casting_process(wanted.process).numbers


def _shell(wanted: Wanted) -> float | None:
    """Return the thickness of the shell that a process pours into [m]; None: a block."""
    return _numbers(wanted).get("shell")


def _split(cad_file: Path, wanted: Wanted, box: Box, say: Say) -> tuple[int, float] | None:
    """Return axis and place of the plane between the halves of a mould [m], if there are any.

    A plane in the middle that misses a flat face by little leaves a sliver of the mould between
    them, and moves to the face.
    """
    if wanted.split is None:
        return None
    axis, place = _plane(wanted.split, box)
    if "=" in wanted.split:
        return axis, place
    low, high = box[0][axis], box[1][axis]
    try:
        with TemporaryDirectory() as folder:
            faces = seen_apart(part_as_it_comes(cad_file), Path(folder), BUDGET).faces
    except MeshError:  # what cannot be seen may be meshed all the same
        return axis, place
    levels = [face.points[:, axis] for face in faces if np.ptp(face.points[:, axis]) < FLAT]
    off = min((float(level.mean()) - place for level in levels), key=abs, default=0.0)
    if FLAT < abs(off) <= NEAR * (high - low):
        place = round(place + off, 9)
        say(f"the mould parts at {AXES[axis]} = {1e3 * place:.5g} mm, a face near its middle")
    return axis, place


def _mould(box: Box, margin: float, wanted: Wanted, split: tuple[int, float] | None) -> Mould:
    """Return the mould round the solids.

    Args:
        box: of the solids [m].
        margin: of the block, or thickness of the shell [m].
        wanted: process and top.
        split: axis and place of the plane between its halves [m]; None: it has none.
    """
    mould = Mould(margin=margin, split=split, plug=PLUG, shell=_shell(wanted))
    if not wanted.open_top:
        return mould
    low, high = ([round(x, 7) for x in corner] for corner in box)
    lowest, highest = [x - mould.room for x in low], [x + mould.room for x in high]
    highest[2] = high[2]
    block = (lowest[0], lowest[1], lowest[2]), (highest[0], highest[1], highest[2])
    return replace(mould, margin=0.0, box=block)


def _mould_text(mould: Mould) -> str:
    """Return the line of a mould in the case file."""
    parts = []
    if mould.box is not None:
        corners = (", ".join(f"{x:.7g}" for x in corner) for corner in mould.box)
        parts.append(f"box = [{', '.join(f'[{corner}]' for corner in corners)}]")
    elif mould.shell is None:
        parts.append(f'box = "{1e3 * mould.margin:.3g} mm"')
    if mould.shell is not None:
        parts.append(f'shell = "{1e3 * mould.shell:.3g} mm"')
    if mould.split is not None:
        parts.append(f'split = "{AXES[mould.split[0]]} = {1e3 * mould.split[1]:.5g} mm"')
    if mould.plug is not None:
        parts.append(f'plug = "{mould.plug}"')
    what = "a block round the part" if mould.shell is None else "a shell that follows the part"
    return f"mould = {{ {', '.join(parts)} }}      # {what}\n"


def _plane(wanted: str, box: Box) -> tuple[int, float]:
    """Return axis and place [m] of a plane such as "z", in the middle of a box, or "z=12mm".

    Raises:
        CaseError: it is no plane, or misses the box.
    """
    axis, sign, place = (part.strip() for part in wanted.partition("="))
    if axis not in AXES or (sign and not place):
        raise CaseError(f'--split: a plane across x, y or z is needed: z or "z=12mm", got {wanted}')
    number = AXES.index(axis)
    low, high = box[0][number], box[1][number]
    if not sign:
        # The box is that of a mesh, which cuts round corners: a plane that misses the seam of a
        # cylinder by hundredths of a millimetre leaves slivers.
        step = 10.0 ** math.floor(math.log10(high - low) - 2.0)
        return number, round(0.5 * (low + high) / step) * step
    try:
        _, _, given = plane(f"{axis} = {place}", ("=",))
    except CaseError:
        raise CaseError(f'--split: {wanted}: {place} is no length; write "{axis}=12mm"') from None
    if max(low - given, given - high) > BESIDE * (high - low):
        raise CaseError(
            f"--split: {wanted} lies at {1e3 * given:.5g} mm and misses the part, from {axis} = "
            f"{1e3 * low:.5g} to {1e3 * high:.5g} mm; lengths without a unit are metres"
        )
    return number, given
