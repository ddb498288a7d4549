"""The fields that are shown: their names in plain words, units and colours."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from castx.case.fields.registry import output_fields
from castx.results.states.quantities import MARGINS, PASSING, UNITS


@dataclass(frozen=True)
class Topic:
    """A field as it is shown.

    Args:
        field: its name.
        title: heading.
        caption: what is seen; {front} is where gradients are taken.
        unit: in which it is shown.
        colours: name of the colour map.
        factor: from SI to the unit.
        melting: whether only the bodies that freeze show it; else the others have colours of
            their own, `beside`.
        beside: name of the colour map of bodies that do not freeze.
        final: whether it is shown at the end only.
        front: whether the line f_s = 0.5 is drawn.
        share: of the values inside the colours.
    """

    field: str
    title: str
    caption: str
    unit: str
    colours: str
    factor: float = 1.0
    melting: bool = False
    beside: str = "cividis"
    final: bool = False
    front: bool = False
    share: float = 1.0

    @property
    def label(self) -> str:
        """Name and unit."""
        return f"{self.title} [{self.unit}]" if self.unit else self.title


def _topics() -> Iterator[Topic]:
    shown = [(field, field.shown) for field in output_fields().values() if field.shown is not None]
    for field, how in sorted(shown, key=lambda pair: pair[1].rank):
        yield Topic(
            field.name, field.title, how.caption, how.unit, how.colours, how.factor, how.melting,
            how.beside, how.final, how.front, how.share,
        )  # fmt: skip


TOPICS = tuple(_topics())
LEFT_OUT = ("body", "displacement", "stress")
"""Arrays that are not shown as colours: the number of a body, and what has several parts."""


def plain(name: str) -> str:
    """Return the name of an array as a heading."""
    return name.replace("_", " ").capitalize()


def topics_of(names: Iterable[str]) -> Iterator[Topic]:
    """Yield the topics of fields in the order of `TOPICS`, then those of other fields.

    Args:
        names: of the arrays of scalars that were written.
    """
    written = set(names)
    yield from (topic for topic in TOPICS if topic.field in written)
    for name in sorted(written - {topic.field for topic in TOPICS} - set(LEFT_OUT)):
        if name.startswith(PASSING):
            fraction = float(name.removeprefix(PASSING))
            yield Topic(name, f"Time of solid fraction {fraction:g}",
                        "From when the casting was poured.", "s", "cividis", melting=True,
                        final=True)  # fmt: skip
        elif name.startswith(MARGINS):
            cut_off = float(name.removeprefix(MARGINS))
            yield Topic(name, f"Tearing margin, cut off at g_c = {cut_off:g}",
                        "Strain rate across the gradient over the critical one of Rappaz, Drezet "
                        "and Gremaud; above 1 it tears. The answer hangs on g_c: judge the band of "
                        "all cut-offs.", "", "YlOrRd", melting=True, final=True,
                        share=0.9)  # fmt: skip
        else:
            title = output_fields()[name].title if name in UNITS else plain(name)
            unit = UNITS.get(name, "")
            yield Topic(name, title, "", "" if unit == "1" else unit, "viridis", share=0.99)
