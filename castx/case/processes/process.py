"""The casting processes that come with castx: `database/NAME.toml`.

Each number there is a table { value, unit, source }, and `[classes.zinc.KEY]` holds one that is
another for a class of alloys. A process releases the casting a multiple of its freezing time after
the pouring, or when it has cooled to a share of its solidus in °C; a strand leaves its mould when
it has gone through its length, `castx.case.processes.strand`. `[refuses]` says of options of
`castx new` that it cannot have why that is so.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

from castx.case.processes.names import FOLDER, process_names
from castx.errors import CaseError
from castx.input.problems import Problem, among, summary
from castx.input.sourced import file_content, item_problems, plain, text_problems

_ABOUT = ("summary", "alloy", "mould", "mould_law", "release")
_KEYS = ("value", "unit", "source")
ZONES = ("foot", "upper", "lower")
"""Spray zones below the mould of a strand, each with a length and its water."""
_UNITS = {
    "superheat": "K", "mould_temperature": "°C", "wall": "", "shell": "m",
    "outside_coefficient": "W/m²/K", "outside_emissivity": "", "ambient": "°C",
    "release_factor": "", "release_temperature": "", "ejection_delay": "s",
    "air_coefficient": "W/m²/K", "mould_length": "m", "speed_factor": "m²/s", "taper": "1/m",
    "machine_radius": "", "rolled_width": "m",
    **{f"{zone}_{key}": unit for zone in ZONES
       for key, unit in (("length", "m"), ("water", "L/m²/s"))},
}  # fmt: skip
_ALWAYS = ("superheat", "mould_temperature", "outside_coefficient", "ambient", "air_coefficient")
_EITHER = (("wall", "shell"), ("release_factor", "release_temperature", "mould_length"))
_OF_STRANDS = (
    "speed_factor", "taper", "machine_radius", "rolled_width",
    *(f"{zone}_{key}" for zone in ZONES for key in ("length", "water")),
)  # fmt: skip
"""What a process with `mould_length` needs beside it."""
OPTIONS = {"split": "--split", "top": "--top open"}
"""Options of `castx new` for a mould that is made, which a process may refuse."""
_OWN = {"density": "kg/m³", "heat_capacity": "J/kg/K", "conductivity": "W/m/K"}


@dataclass(frozen=True)
class CastingProcess:
    """A casting process with its usual numbers.

    Attributes:
        name: of its file.
        summary: in one line.
        alloy: that is cast unless another one is asked for.
        mould: its material unless another one is asked for.
        mould_law: constitutive law of the mould.
        release: what the mould does in the end, in words.
        interfaces: entries of the database of interfaces by class of alloy.
        numbers: in SI, by key.
        sources: of the numbers.
        material: properties of the mould where the database of materials does not have it.
        classes: numbers in SI with their sources, by key, that are others for a class of alloys.
        refuses: why it cannot have an option, by the names of `OPTIONS`.
    """

    name: str
    summary: str
    alloy: str
    mould: str
    mould_law: str
    release: str
    interfaces: Mapping[str, str]
    numbers: Mapping[str, float]
    sources: Mapping[str, str]
    material: Mapping[str, Any]
    classes: Mapping[str, Mapping[str, tuple[float, str]]]
    refuses: Mapping[str, str]

    @property
    def is_strand(self) -> bool:
        """Whether the casting runs through its mould."""
        return "mould_length" in self.numbers

    def of_class(self, name: str) -> CastingProcess:
        """Return the process with the numbers of a class of alloys."""
        own = self.classes.get(name, {})
        numbers = {key: value for key, (value, _) in own.items()}
        sources = {key: source for key, (_, source) in own.items()}
        return replace(
            self, numbers={**self.numbers, **numbers}, sources={**self.sources, **sources}
        )


def refuse_options(process: CastingProcess, given: Iterable[str]) -> None:
    """Refuse options that a process cannot have.

    Args:
        process: the process.
        given: names of `OPTIONS`.

    Raises:
        CaseError: one of them is refused; with the reason and the processes that have it.
    """
    for name in given:
        if name in process.refuses:
            others = [o for o in process_names() if name not in casting_process(o).refuses]
            raise CaseError(
                f"{OPTIONS[name]}: not with {process.name}: {process.refuses[name]}; leave it out, "
                f"or choose a process that has it: {', '.join(others)}"
            )


@cache
def casting_process(name: str) -> CastingProcess:
    """Return a process of the database.

    Raises:
        CaseError: there is none of this name, or its file is not right.
    """
    if name not in process_names():
        raise CaseError(f"no process {name!r}; {among(name, process_names())}")
    file = FOLDER / f"{name}.toml"
    return read_process(name, file_content(file), str(file))


def read_process(name: str, content: dict[str, Any], file: str) -> CastingProcess:
    """Return the process of a file.

    Args:
        name: of the process.
        content: of the file.
        file: its name, for messages.

    Raises:
        CaseError: a text, number, unit or source is missing or wrong; with all problems.
    """
    problems = [*text_problems(content, _ABOUT), *_missing(content)]
    own = content.get("material", {})
    given = {key: item for key, item in content.items() if key in _UNITS}
    for key, item in given.items():
        problems += item_problems((key,), item, _KEYS, _UNITS[key])
    for key, item in own.items():
        problems += item_problems(("material", key), item, _KEYS, _OWN.get(key))
    classes = content.get("classes", {})
    for of_class, key, item in _of_classes(classes):
        problems += item_problems(("classes", of_class, key), item, _KEYS, _UNITS.get(key))
        if key not in given or of_class not in content.get("interfaces", {}):
            text = "is of a number of the process, for a class that has an interface"
            problems.append(Problem(("classes", of_class, key), text))
    refuses = content.get("refuses", {})
    problems += _refusal_problems(refuses)
    unknown = set(content) - {*_ABOUT, *_UNITS, "interfaces", "material", "classes", "refuses"}
    problems += [Problem((key,), "unknown key") for key in sorted(unknown)]
    if problems:
        raise CaseError(summary(file, problems, content))
    return CastingProcess(
        name,
        content["summary"],
        content["alloy"],
        content["mould"],
        content["mould_law"],
        content["release"],
        content["interfaces"],
        {key: float(item["value"]) for key, item in given.items()},
        {key: item["source"] for key, item in given.items()},
        {key: plain(item) for key, item in own.items()},
        {
            of_class: {key: (float(item["value"]), item["source"]) for key, item in rows.items()}
            for of_class, rows in classes.items()
        },
        refuses,
    )


def _of_classes(classes: Mapping[str, Any]) -> Iterator[tuple[str, str, Any]]:
    """Yield the numbers that are others for a class of alloys, with class and key."""
    for name, rows in classes.items():
        yield from ((name, key, item) for key, item in rows.items())


def _refusal_problems(refuses: Mapping[str, Any]) -> Iterator[Problem]:
    for name, reason in refuses.items():
        if name not in OPTIONS:
            yield Problem(("refuses", name), f"no option; {among(name, tuple(OPTIONS))}")
        if not isinstance(reason, str) or not reason:
            yield Problem(("refuses", name), "the reason in quotes is needed")


def _missing(content: Mapping[str, Any]) -> list[Problem]:
    needed = [key for key in (*_ALWAYS, "interfaces") if key not in content]
    found = [Problem((key,), "missing; this key is needed") for key in needed]
    for first, *others in _EITHER:
        if sum(key in content for key in (first, *others)) != 1:
            found.append(Problem((first,), f"either this or {' or '.join(others)} is needed"))
    if "mould_length" in content:
        without = [key for key in _OF_STRANDS if key not in content]
        found += [Problem((key,), "missing; a strand needs it") for key in without]
    return found
