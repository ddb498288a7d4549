"""Description of the CAD files of a case, as input of the mesher."""

from __future__ import annotations

from collections.abc import Sequence
from math import radians

from castx.case.cad.geometry import CadGeometry
from castx.case.cad.mould import CadMould
from castx.case.cad.selectors import FaceSelector
from castx.domain.cad.size_map import read_size_map
from castx.meshes.cad.description import (
    CadFile,
    CadPart,
    Channel,
    Chill,
    Mould,
    Selector,
    SizeRule,
    SymmetryPlane,
)


def part_of(cad: CadGeometry, body_names: Sequence[str] | None) -> CadPart:
    """Return the description of a part for `castx.meshes.cad`.

    Args:
        cad: of the case.
        body_names: names that the solids must get; None: any.

    Raises:
        MeshError: sizes over space cannot be read.
    """
    finer, on_interface = cad.refinement, cad.interface_size
    return CadPart(
        files=tuple(CadFile(str(path), body, cad.unit) for path, body in cad.sources),
        size=cad.size / finer,
        bodies=None if body_names is None else tuple(body_names),
        names=dict(cad.names),
        tolerance=cad.tolerance,
        narrowest=cad.narrowest,
        selectors=tuple(selector_of(name, s, cad.tolerance) for name, s in cad.surfaces.items()),
        curvature=cad.curvature * finer,
        across=cad.across * finer,
        interface_size=None if on_interface is None else on_interface / finer,
        growth=cad.growth / finer,
        rules=tuple(SizeRule(s.size / finer, s.body, s.surface, s.within) for s in cad.sizes),
        size_map=None if cad.size_map is None else read_size_map(cad.size_map, finer),
        most_cells=cad.most_cells,
        mould=None if cad.mould is None else _mould(cad.mould),
        symmetry=tuple(SymmetryPlane(*plane) for plane in cad.symmetry),
    )


def selector_of(name: str, selector: FaceSelector, tolerance: float) -> Selector:
    """Return the selector of a named surface, as the mesher takes it.

    Args:
        name: of the surface.
        selector: of the case.
        tolerance: of lengths [m].
    """
    return Selector(
        name,
        body=selector.body,
        normal=selector.normal,
        angle=radians(selector.angle),
        within=selector.within,
        touches=selector.touches,
        radius=selector.radius,
        largest=selector.largest,
        tolerance=tolerance,
    )


def _mould(mould: CadMould) -> Mould:
    return Mould(
        mould.name,
        margin=mould.box if isinstance(mould.box, float) else 0.0,
        box=None if isinstance(mould.box, float) else mould.box,
        shell=mould.shell,
        split=mould.split,
        cores=mould.cores,
        chills=tuple(
            Chill(c.name, c.box, (c.line[0], c.line[1]) if c.line else None, c.diameter or 0.0)
            for c in mould.chills
        ),
        channels=tuple(Channel(c.name, c.line, c.diameter) for c in mould.cooling),
        plug=mould.plug,
    )
