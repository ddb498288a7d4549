"""Description of mechanical contact on an interface: method and initial gap; no dolfinx."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
import numpy.typing as npt
from pydantic import PlainValidator

from castx.entries import Choice, Description, NotYet, PureNumber, Quantity, Tabulated
from castx.errors import CaseError
from castx.refusal import Refusal, among, refuse
from castx.tables import FloatArray, Table
from castx.units import LENGTH

_LENGTHS = Quantity(LENGTH)
_ALONG = ("x", "y", "z", "r")


@dataclass(frozen=True, eq=False)
class InitialGap:
    """Gap of an interface before anything moves [m]; negative is interference.

    Args:
        table: metres over the coordinate; constant where there is one number.
        along: coordinate of the table, "x", "y", "z" or "r".
    """

    table: Table
    along: str = "x"

    def at(self, points: npt.ArrayLike) -> FloatArray:
        """Return the gap at points of shape (n, gdim), in the coordinates of the model."""
        coordinates = np.asarray(points, dtype=np.float64)
        if self.along == "r" and coordinates.shape[1] == 3:
            return self.table(np.hypot(coordinates[:, 0], coordinates[:, 1]))
        return self.table(coordinates[:, {"x": 0, "r": 0, "y": 1, "z": -1}[self.along]])


def _initial_gap(value: Any) -> InitialGap:
    if isinstance(value, InitialGap):
        return value
    if not isinstance(value, dict):
        return InitialGap(Table.constant(_LENGTHS.read(value)))
    for key in value:
        if key not in ("along", "table"):
            raise refuse(f"unknown key; {among(key, ('along', 'table'), what='known keys')}", key)
    for key in ("along", "table"):
        if key not in value:
            raise refuse("missing; both along and table are needed", key)
    try:
        along = Choice(_ALONG).read(value["along"])
    except CaseError as error:
        raise refuse(str(error), "along") from None
    try:
        return InitialGap(Tabulated(_LENGTHS, _LENGTHS).read(value["table"]), along)
    except Refusal as error:
        raise error.inside("table") from None


class Contact(Description):
    """How two bodies touch, and the gap they start with."""

    method: Annotated[
        str,
        Choice(
            ("condensed", "multipliers", "none"),
            ("penalty", "augmented-lagrangian", "block-iterative", "rigid", "tied"),
        ),
    ] = "condensed"
    initial_gap: Annotated[InitialGap, PlainValidator(_initial_gap)] = InitialGap(
        Table.constant(0.0)
    )
    normals: Annotated[str, Choice(("averaged",), ("primary", "patches"))] = "averaged"
    pairing: Annotated[str, Choice(("node-to-node",), ("node-to-face",))] = "node-to-node"
    friction: Annotated[PureNumber, NotYet(0.0)] = 0.0
    penalty: Annotated[None, NotYet()] = None
    fallback: Annotated[Any, NotYet([])] = ()
