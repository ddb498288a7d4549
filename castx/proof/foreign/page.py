"""foreign.html: one offline page with the numbers of other programs, of castx and of solutions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

import jinja2

from castx.environment import versions
from castx.proof.foreign.declaration import ForeignCase, Number
from castx.results.files.folder import write_whole

PAGE = "foreign.html"


@dataclass(frozen=True)
class Ran:
    """A case that was run.

    Attributes:
        case: the case.
        numbers: of it; none where it failed.
        seconds: that it took.
        failure: why it has no numbers, or nothing.
    """

    case: ForeignCase
    numbers: tuple[Number, ...]
    seconds: float
    failure: str = ""

    @property
    def met(self) -> bool:
        """Whether castx is within all tolerances."""
        return not self.failure and all(number.met for number in self.numbers)

    @property
    def worst(self) -> Number | None:
        """The number nearest to its tolerance, or beyond it."""
        if not self.numbers:
            return None
        return max(self.numbers, key=lambda number: number.error / number.tolerance)


def write_page(folder: Path, ran: Sequence[Ran], ranks: int) -> Path:
    """Write foreign.html into a folder and return its path.

    Args:
        folder: created if it does not exist.
        ran: all cases that were run.
        ranks: on which they ran.
    """
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("castx.proof.foreign", "templates"), autoescape=True,
        undefined=jinja2.StrictUndefined,
    )  # fmt: skip
    environment.filters |= {"value": value_text, "share": share_text}
    text = environment.get_template("foreign.html.j2").render(
        ran=ran, ranks=ranks, missed=[one.case.number for one in ran if not one.met],
        when=datetime.now(UTC).strftime("%Y-%m-%d"), versions=versions(),
        seconds=sum(one.seconds for one in ran),
    )  # fmt: skip
    folder.mkdir(parents=True, exist_ok=True)
    write_whole(folder / PAGE, text)
    return folder / PAGE


def value_text(number: float | None, unit: str) -> str:
    """Return a number with its unit."""
    return "–" if number is None else f"{number:.6g} {unit}".strip()


def share_text(error: float | None) -> str:
    """Return an error as a share."""
    return "–" if error is None else f"{100 * error:.2g} %"
