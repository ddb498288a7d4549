"""Descriptions of the interfaces between bodies: contact and law of heat transfer."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from castx.case.contact import InterfaceContact
from castx.case.heat_transfer import InterfaceHeat
from castx.input.entries import Description, EntryName


class Interface(Description):
    """Two bodies that face each other: secondary (casting side), primary (mould side)."""

    bodies: Annotated[tuple[EntryName, ...], Field(min_length=2, max_length=2)]
    contact: InterfaceContact = InterfaceContact()
    heat: InterfaceHeat | None = None

    @property
    def secondary(self) -> str:
        """Body on the casting side."""
        return self.bodies[0]

    @property
    def primary(self) -> str:
        """Body on the mould side, whose outward normal is the normal of the pairs."""
        return self.bodies[1]

    @property
    def name(self) -> str:
        """Name as "secondary/primary"."""
        return "/".join(self.bodies)
