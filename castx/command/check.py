"""The command `castx check`: contents of a case and its mesh, before anything is solved."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from mpi4py import MPI

import numpy as np
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from castx.case.boundaries import Boundary, ClampCondition
from castx.case.cad.cost import first_run_time
from castx.case.case import Case
from castx.case.caveats import caveats, shut_in
from castx.case.coherency import coherencies, sensitivity_command
from castx.case.feeding import feeding_texts
from castx.case.heat_transfer import InterfaceHeat
from castx.case.interfaces import Interface
from castx.case.reading.read import load_case
from castx.case.soak import Soak, soaks
from castx.case.unusual import unusual
from castx.command.cad_report import show_cad
from castx.command.watches.ranges import material_remarks, material_warnings
from castx.command.watches.skins import skin_errors
from castx.contact.kinematics.hidden_pairs import hidden_pair_warnings
from castx.coupling.building import formulation_of, laws_above_solidus
from castx.coupling.loose_parts import loose_parts
from castx.coupling.thin_walls import thin_walls
from castx.domain.memory import refuse_too_large
from castx.domain.mesh import CastingMesh, build_mesh
from castx.domain.pairs.areas import area_text, area_warnings
from castx.domain.pairs.node_pairs import NodePairs
from castx.domain.pairs.pairing import case_pairs
from castx.domain.summary import InterfaceSummary, MeshSummary, mesh_summary
from castx.errors import CaseError, MeshError
from castx.heat.building import heat_exchange, initial_temperatures
from castx.input.units import plain_text
from castx.materials.lookup import find_material
from castx.meshes.model import SYMMETRY
from castx.process.building import stage_cases
from castx.ranks import on_first_rank
from castx.report.stages import cycle_text, stage_table
from castx.results.files.measurements import measured_curves
from castx.results.probes import readings_of


def check_case(
    case: Case, comm: MPI.Intracomm, console: Console, picture: Path | None = None
) -> None:
    """Build the mesh of a case, find surfaces, pairs and probes in it, and show all; collective.

    Args:
        case: the case.
        comm: the ranks to share the mesh.
        console: where to show what was found.
        picture: a file to draw bodies, surfaces and interfaces into; None: none.

    Raises:
        CaseError: a probe lies outside its body, cells or metal do not suit a formulation, an
            initial temperature cannot be read, a patch of an interface has no node, a stage cannot
            be run as described, or the picture cannot be drawn.
        MeshError: the mesh lacks what the case asks of it.
    """
    if picture is not None:
        from castx.report.exploded import refuse_format  # loads what draws, see draw_case

        refuse_format(picture)
    names = [body.name for body in case.bodies]
    refuse_too_large(case.geometry, names, comm, solved=False)
    mesh = build_mesh(case.geometry, names, comm)
    if picture is not None:  # before anything that a picture may help to mend
        draw_case(case, mesh, picture)
        console.print(f"written: {picture}", markup=False)
    pairs = case_pairs(mesh, case.interfaces)
    stages = stage_cases(case, mesh)
    formulations = _formulations(case, mesh, pairs)
    counts = {name: comm.allreduce(len(found.secondary_local)) for name, found in pairs.items()}
    summary = mesh_summary(mesh)
    _show_mesh(case, summary, formulations, counts, console)
    for line in skin_texts(case, summary):
        console.print(line, markup=False)
    if mesh.report is not None:
        show_cad(mesh.report, [interface.name for interface in case.interfaces], console)
    for described in case.interfaces:
        if described.contact.pairing == "node-to-face":
            console.print(faces_text(described, pairs[described.name], comm), markup=False)
    _show_course(case, stages, console)
    for line in (*coherency_texts(case), *feeding_texts(case)):
        console.print(line, markup=False)
    areas = area_warnings(case.interfaces, pairs, comm)
    hidden = hidden_pair_warnings(case.interfaces, pairs, case.rigid_bodies, comm)
    shut = shut_in(case, free_areas(case, summary))
    thin = [walls.text for walls in thin_walls(case, mesh)]
    loose = loose_parts(case, mesh, pairs)
    for text in material_remarks(case):
        console.print(text, markup=False)
    of_case = (*material_warnings(case), *caveats(case), *unusual(case))
    warnings = (*areas, *hidden, *of_case, *shut, *loose, *thin)
    for warning in warnings:
        console.print(f"warning: {warning}", markup=False, style="yellow")
    console.print("the case can be run", markup=False)


def draw_case(case: Case, mesh: CastingMesh, picture: Path) -> None:
    """Draw bodies, surfaces and interfaces of a case into a file; collective.

    Raises:
        CaseError: the picture cannot be drawn or written.
    """
    # Half a second that no check without a picture should wait for.
    from castx.report.exploded import Mark, write_picture
    from castx.report.shells import shells_of

    shells = shells_of(mesh, [interface.name for interface in case.interfaces])
    flat = case.geometry.model != "3d"
    first = {interface.name: interface.bodies[0] for interface in case.interfaces}
    marks = [Mark(p.name, p.body or first[str(p.interface)], p.at) for p in case.probes]
    on_first_rank(mesh.comm, lambda: write_picture(shells, flat, picture, marks))


def draw_new_case(case_file: Path, comm: MPI.Intracomm, console: Console) -> None:
    """Draw a case that was just written beside its file, or say why not; collective."""
    picture = case_file.with_suffix(".png")
    try:
        if comm.bcast(picture.exists()):
            raise CaseError(f"{picture} exists; castx check {case_file} --picture FILE draws it")
        case = load_case(case_file)
        mesh = build_mesh(case.geometry, [b.name for b in case.bodies], comm)
        for remark in () if mesh.report is None else mesh.report.remarks:
            console.print(remark, markup=False, style="yellow")
        summary = mesh_summary(mesh)
        for text in shut_in(case, free_areas(case, summary)):
            console.print(text, markup=False, style="yellow")
        cells = sum(body.cells for body in summary.bodies)
        console.print(
            f"{cells} cells: a run takes {first_run_time(cells)} on one processor; cells of half "
            "the size are eight times as many, for results",
            markup=False, highlight=False,
        )  # fmt: skip
        poured = {
            body.name
            for body in case.bodies
            if body.is_poured(find_material(body.material, case.materials))
        }
        for walls in thin_walls(case, mesh):
            if walls.body in poured:  # castx check tells those of the mould too
                console.print(walls.text, markup=False, style="yellow")
        found = list(_soaks(case, summary))
        worst = max(found, key=lambda each: each[0].error(each[1]), default=None)
        early = None if worst is None else worst[0].text(worst[1])
        if early is not None:  # castx check tells all of them
            console.print(early, markup=False, style="yellow")
        draw_case(case, mesh, picture)
    except (CaseError, MeshError) as error:
        console.print(f"no picture: {error}", markup=False, style="yellow")
    else:
        console.print(f"written: {picture}", markup=False)


def _formulations(case: Case, mesh: CastingMesh, pairs: Mapping[str, NodePairs]) -> list[str]:
    """Return the formulations of the bodies, and refuse unsuitable cells; collective."""
    columns = [
        column
        for probe in case.probes
        for reading in readings_of(probe, mesh, pairs)
        for column in reading.columns
    ]
    measured_curves(case.measurements, columns, mesh.comm)
    for body in case.bodies:
        if body.temperature.table is None:
            initial_temperatures(body.temperature, mesh.bodies[body.name], mesh.comm)
    for described in case.interfaces:
        heat_exchange(described, pairs[described.name], mesh)
    laws_above_solidus(case, mesh)  # refuses metals that a formulation cannot have
    return [formulation_of(mesh, body) for body in case.bodies]


def _show_mesh(
    case: Case,
    summary: MeshSummary,
    formulations: Sequence[str],
    pairs: Mapping[str, int],
    console: Console,
) -> None:
    box = f"from {corner_text(summary.lowest)} to {corner_text(summary.highest)} m"
    console.print(f"{case.name}: {case.geometry.model}, {box}", markup=False)
    console.print(body_table(case, summary, formulations))
    console.print(surface_table(case, summary))
    console.print(size_text(case.geometry.model), markup=False)
    for interface in summary.interfaces:
        console.print(interface_text(case, interface, pairs), markup=False)


def _show_course(case: Case, stages: Sequence[Case], console: Console) -> None:
    if len(stages) > 1:
        console.print(stage_table(case, stages))
    if case.stages and case.stages[-1].repeat is not None:
        console.print(cycle_text(case), markup=False)


def skin_texts(case: Case, summary: MeshSummary) -> Iterator[str]:
    """Yield lines about the cells on both sides of interfaces, as far as it is foreseen.

    They lie in the skin of a casting that carries a gap, and in what takes up its heat.
    """
    yield from (text for _, text in skin_errors(case, summary))
    for soak, size in _soaks(case, summary):
        text = soak.text(size)
        if text is not None:
            yield text


def _soaks(case: Case, summary: MeshSummary) -> Iterator[tuple[Soak, float]]:
    """Yield the heat that moulds take up, and the sizes of their cells there [m], if known."""
    for soak in soaks(case, summary.moduli):
        size = summary.height(soak.mould, soak.casting)
        if size:
            yield soak, size


def coherency_texts(case: Case) -> Iterator[str]:
    """Yield a line about each coherency on which the answers hang, then how to see how much."""
    found = coherencies(case)
    yield from (coherency.text for coherency in found)
    if found:
        command = sensitivity_command(str(case.path))
        yield f"freezing time and gaps hang on coherency; {command} shows how much"


def corner_text(corner: Sequence[float]) -> str:
    """Return a corner of the bounding box, such as "(0, 0.05)"."""
    return f"({', '.join(f'{value:g}' for value in corner)})"


def body_table(case: Case, summary: MeshSummary, formulations: Sequence[str]) -> Table:
    """Return a table of the bodies with their materials and sizes.

    Args:
        case: the case.
        summary: of its mesh.
        formulations: of the bodies, in words.
    """
    table = Table(box=SIMPLE_HEAD, collapse_padding=True)
    for heading in ("body", "material", "initially", "law", "nodes", "cells", "volume, cm³"):
        whole = heading in ("material", "law")  # a word that is cut says nothing
        table.add_column(heading, overflow="fold", no_wrap=whole)
    rows = zip(case.bodies, summary.bodies, formulations, strict=True)
    for body, sizes, formulation in rows:
        table.add_row(
            body.name,
            body.material,
            body.temperature.text,
            f"{body.law}\n{formulation}".replace("-", "-\n"),
            str(sizes.nodes),
            str(sizes.cells),
            plain_text(1e6 * sizes.volume),
        )
    return table


def free_areas(case: Case, summary: MeshSummary) -> dict[str, float]:
    """Return the area of the faces of each body that no other body shares [m²]."""
    names = [body.name for body in case.bodies]
    return {
        body.name: body.unnamed
        + sum(
            area
            for name, area in body.surfaces.items()
            if name not in names and not name.startswith(SYMMETRY)
        )
        for body in summary.bodies
    }


def size_text(model: str) -> str:
    """Return in words to which part of a casting volumes, areas and forces refer in a model."""
    match model:
        case "axisymmetric":
            return "volumes, areas and forces are those of the full turn"
        case "3d":
            return "volumes, areas and forces are those of the meshed part"
        case _:
            return "volumes, areas and forces are those of one metre of depth"


def surface_table(case: Case, summary: MeshSummary) -> Table:
    """Return the named surfaces with their areas and boundary conditions."""
    table = Table("surface", "area, cm²", "conditions", box=SIMPLE_HEAD)
    names = [body.name for body in case.bodies]
    for body in summary.bodies:
        for surface, area in body.surfaces.items():
            if surface not in names:
                on = f"{body.name}/{surface}"
                given = [boundary for boundary in case.boundaries if boundary.on == on]
                told = [conditions_text(boundary, area) for boundary in given]
                text = ", ".join(told) if told else free_text(surface)
                table.add_row(on, plain_text(1e4 * area), text)
        if body.unnamed > 0.0:
            table.add_row(f"{body.name}, unnamed", plain_text(1e4 * body.unnamed), free_text(""))
    return table


def conditions_text(boundary: Boundary, area: float) -> str:
    """Return the conditions on a surface of an area [m²] in words."""
    found = [item.type for item in boundary.heat]
    found += [f"displacement {item.direction}" for item in boundary.displacement]
    found += [key for key in ("pressure", "traction") if getattr(boundary, key) is not None]
    if boundary.clamp is not None:
        found.append(clamp_text(boundary.clamp, area))
    return ", ".join(found)


def clamp_text(clamp: ClampCondition, area: float) -> str:
    """Return force, pressure on an area [m²] and stiffness of a clamp in words."""
    parts = []
    if clamp.force is not None:
        force = float(clamp.force.values.max())
        most = "" if clamp.force.is_constant else "at most "
        parts.append(f"{most}{force:.4g} N ({force / area / 1e6:.4g} MPa)")
    if clamp.stiffness is not None:
        parts.append(f"{clamp.stiffness:.4g} N/m")
    along = "" if clamp.direction is None else f" along {clamp.direction}"
    along = " in all directions" if clamp.is_frame else along
    return f"clamp{along} {', '.join(parts)}"


def free_text(surface: str) -> str:
    """Return the conditions on a surface without any in the case."""
    if surface.startswith(SYMMETRY):
        return "insulated, displacement normal (symmetry)"
    return "insulated, free"


def interface_text(case: Case, summary: InterfaceSummary, pairs: Mapping[str, int]) -> str:
    """Return a line of text about two bodies that touch.

    Args:
        case: the case.
        summary: of the surface they share.
        pairs: how many node pairs each interface of the case has; a node at an edge has one on
            each side of it.
    """
    sizes = f"{summary.nodes} nodes, {plain_text(1e4 * summary.area)} cm²"
    for interface in case.interfaces:
        if set(interface.bodies) == set(summary.bodies):
            sizes = f"{pairs[interface.name]} pairs, {plain_text(1e4 * summary.area)} cm²"
            laws = f"contact {interface.contact.method}, heat {heat_text(interface.heat)}"
            return f"interface {interface.name}: {sizes}, {laws}"
    return f"no interface between {' and '.join(summary.bodies)} ({sizes}): nothing passes there"


def faces_text(interface: Interface, pairs: NodePairs, comm: MPI.Intracomm) -> str:
    """Return a line of text about an interface of non-matching meshes; collective.

    Args:
        interface: its description.
        pairs: its nodes with the facets they face.
        comm: the ranks.
    """
    count = comm.allreduce(len(pairs.areas), op=MPI.SUM)
    least = comm.allreduce(float(pairs.meshed_gap.min(initial=np.inf)), op=MPI.MIN)
    most = comm.allreduce(float(pairs.meshed_gap.max(initial=-np.inf)), op=MPI.MAX)
    areas = area_text(pairs, comm)
    sizes = f"{count} nodes face facets, {areas}, meshed gap {least:.3g} to {most:.3g} m"
    laws = f"contact {interface.contact.method}, heat {heat_text(interface.heat)}"
    return f"interface {interface.name}: {sizes}, {laws}"


def heat_text(heat: InterfaceHeat | None) -> str:
    """Return in words how heat crosses an interface."""
    if heat is None:
        return "none"
    radiation = " and radiation" if heat.radiation is not None else ""
    patches = f", other on {len(heat.patches)} of its parts" if heat.patches else ""
    origin = f" of {heat.entry}" if heat.entry else ""
    return f"{heat.law}{origin}{radiation}{patches}"
