"""One finding of the summary: a number with its unit, place and time, and a sentence."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from castx.input.units import plain_text, seconds_text
from castx.results.states.quantities import parts


@dataclass(frozen=True)
class Shown:
    """The picture that belongs to a finding.

    Args:
        field: that it shows; one that was not written is left out.
        bodies: in its colours, the others are grey.
        time: of the picture [s]; None: the end.
        moved: whether displacements are drawn, larger than they are.
        outside: whether the bodies are seen from outside, without those around.
    """

    field: str
    bodies: tuple[str, ...]
    time: float | None = None
    moved: bool = False
    outside: bool = False


@dataclass(frozen=True)
class Finding:
    """One number that a run has found.

    Args:
        topic: what it is, such as "Largest gap"; the first finding of a topic gets a card.
        of: the body or interface.
        value: in SI, temperatures in °C.
        unit: in which it is shown.
        sentence: what it means, in plain words.
        factor: from SI to the unit.
        place: where, (gdim,) [m]; None: everywhere, or unknown.
        time: when [s]; None: all the time.
        shown: its picture; None: it has none.
        error: how far it is off by mesh and steps, estimated; empty: unknown.
        of_mesh: whether it tells of the mesh itself, whose error no other mesh can tell.
    """

    topic: str
    of: str
    value: float
    unit: str
    sentence: str
    factor: float = 1.0
    place: Sequence[float] | None = None
    time: float | None = None
    shown: Shown | None = None
    error: str = ""
    of_mesh: bool = False

    @property
    def name(self) -> str:
        """Topic and owner: the same number of another run has the same name."""
        return f"{self.topic}: {self.of}"

    @property
    def number(self) -> str:
        """The value with its unit."""
        return f"{plain_text(self.factor * self.value)} {self.unit}".strip()

    def where(self, model: str) -> str:
        """Return place and time as a text.

        Args:
            model: geometric model, which names the axes.
        """
        texts = [] if self.place is None else [place_text(self.place, model)]
        texts += [] if self.time is None else [f"t = {seconds_text(self.time)}"]
        return ", ".join(texts)


def place_text(place: Sequence[float], model: str) -> str:
    """Return a place as text, such as "r 12.0, z 40.0 mm".

    Args:
        place: (gdim,) [m].
        model: geometric model, which names the axes.
    """
    axes = parts("displacement", model)
    found = (f"{axis} {millimetres_text(x)}" for axis, x in zip(axes, place, strict=False))
    return ", ".join(found) + " mm"


def millimetres_text(length: float) -> str:
    """Return a coordinate [m] in tenths of a millimetre, without the sign of a zero."""
    return f"{round(1e3 * length, 1) + 0.0:.1f}"
