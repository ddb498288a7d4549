"""Actions on CAD parts: their view, names and conditions of faces, the first case of a part."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from castx.app.faces import REST, PartViews, selectors_of, tolerance_of
from castx.app.selectors import Words, chosen, proposed
from castx.app.text.arguments import Asked, number_of, text_of, word_of
from castx.app.text.editing import content_of, value_of, with_value
from castx.app.text.on_surfaces import (
    said_of,
    with_condition,
    with_feeder,
    with_surface_moved,
)
from castx.app.workplace import Workplace
from castx.case.cad.geometry import is_cad_file
from castx.case.processes.names import process_names
from castx.case.processes.process import casting_process
from castx.errors import CaseError
from castx.input.entries import Name
from castx.input.toml_written import toml_value
from castx.input.units import plain_text
from castx.materials.database import database_entry, database_names
from castx.materials.lookup import find_material
from castx.transfer.conditions.registry import heat_conditions
from castx.transfer.declaration import HeatKey

Answer = dict[str, Any]
HELD = "held"
"""Kind of the condition that a face does not move along its normal."""
FEEDER = "feeder"
"""Kind by which a free face is one through which metal is fed."""
OPTIONS = ("process", "alloy", "mould", "split", "top")
"""Options of castx new that are given with a value."""


class PartActions:
    """The actions of a page on CAD parts.

    Args:
        workplace: the folder.
    """

    def __init__(self, workplace: Workplace) -> None:
        self._workplace = workplace
        self._views = PartViews(workplace)

    def view(self, asked: Asked) -> Answer:
        """Return faces, triangles and surfaces of a part or of the part of a case."""
        return self._views.view(text_of(asked, "path"), text_of(asked, "text"))

    def surfaces(self, asked: Asked) -> Answer:
        """Return the faces of the named surfaces of a text."""
        return self._views.surfaces(text_of(asked, "path"), text_of(asked, "text"))

    def proposed(self, asked: Asked) -> Answer:
        """Return the selector of a face, the faces found by it, and its name."""
        name, text = text_of(asked, "path"), text_of(asked, "text")
        faces = self._views.of(name, text).faces
        number = number_of(asked, "face")
        if number >= len(faces):
            raise CaseError(f"there is no face {number}")
        face = faces[number]
        words = proposed(number, faces)
        found = self._views.surfaces(name, text)["surfaces"]
        own = next((surface for surface, inside in found.items() if number in inside), None)
        known = selectors_of(text).get(own or "")
        shown = words if known is None else known
        on = f"{face.bodies[0]}/{own or REST}"
        return {
            "selector": toml_value(shown), "faces": chosen(shown, faces, tolerance_of(text)),
            "name": own, "proposal": toml_value(words), "text": face.text,
            "free": len(face.bodies) == 1, "body": face.bodies[0], "on": on,
            "said": said_of(content_of(text), on) if text else "",
        }  # fmt: skip

    def selected(self, asked: Asked) -> Answer:
        """Return the faces that the words of a selector find."""
        name, text = text_of(asked, "path"), text_of(asked, "text")
        faces = self._views.of(name, text).faces
        words = words_of(text_of(asked, "selector"))
        return {"faces": chosen(words, faces, tolerance_of(text))}

    def named(self, asked: Asked) -> str:
        """Return the text of a case in which a face has a name and perhaps a condition.

        Raises:
            CaseError: name, selector or condition cannot be accepted.
        """
        path, text = text_of(asked, "path"), text_of(asked, "text")
        seen = self._views.of(path, text)
        surface = Name().read(text_of(asked, "name"))
        words = words_of(text_of(asked, "selector"))
        numbers = chosen(words, seen.faces, tolerance_of(text))
        found = [seen.faces[number] for number in numbers]
        if surface not in seen.made:
            text = self._called(path, text, surface, words, numbers)
        kind = word_of(asked, "kind")
        if kind is None:
            return text
        if any(len(face.bodies) > 1 for face in found):
            raise CaseError(
                "a face between two bodies has no condition of its own: their interface says what "
                "passes there; the name alone can be given"
            )
        for body in dict.fromkeys(face.bodies[0] for face in found):
            on = f"{body}/{surface}"
            if kind == FEEDER:
                text = with_feeder(text, on)
            elif kind == HELD:
                text = with_condition(text, on, "displacement", {"normal": 0})
            else:
                heat = {"type": kind, **numbers_of(asked, kind)}
                text = with_condition(text, on, "heat", heat)
        return text

    def _called(self, path: str, text: str, surface: str, words: Words, numbers: list[int]) -> str:
        """Return the text of a case in which faces have a name, with the conditions they had.

        A name that had these very faces is given up for the new one. Where a body keeps no face
        without a name, its conditions of `outside` would be refused, and go on to the new name.
        """
        selectors = selectors_of(text)
        before = self._views.surfaces(path, text)
        old = next(
            (name for name, found in before["surfaces"].items()
             if name in selectors and name != surface and set(found) == set(numbers)), None,
        )  # fmt: skip
        if old is not None:
            text = with_value(text, ("geometry", "surfaces", old), None)
        text = with_value(text, ("geometry", "surfaces", surface), words)
        left = set(self._views.surfaces(path, text)["known"])
        for on in before["known"]:
            body, _, name = on.partition("/")
            new = f"{body}/{surface}"
            if name in (REST, old) and on not in left and new in left - set(before["known"]):
                text = with_surface_moved(text, on, new)
        return text


def words_of(text: str) -> Words:
    """Return the keys and values of a selector as the case file writes them.

    Raises:
        CaseError: the text is no table.
    """
    found = content_of(f"it = {text}").get("it")
    if not isinstance(found, dict):
        raise CaseError('a selector is needed, such as { normal = "+z" }')
    return found


def numbers_of(asked: Asked, kind: str) -> dict[str, Any]:
    """Return the numbers of a condition as the case file writes them.

    Raises:
        CaseError: the condition is not known, or a number is none.
    """
    if kind in (HELD, FEEDER):
        return {}
    if kind not in heat_conditions():
        raise CaseError(f"no condition {kind!r}")
    given = asked.get("numbers")
    given = given if isinstance(given, Mapping) else {}
    found = {}
    for key in heat_conditions()[kind].keys:
        text = given.get(key.name)
        if isinstance(text, str) and text.strip():
            found[key.name] = value_of(text.strip())
    return found


def choices() -> Answer:
    """Return processes, materials and conditions that can be chosen, for JSON."""
    processes = [casting_process(name) for name in process_names()]
    materials = [(name, database_entry(name)) for name in database_names()]
    conditions = [
        {
            "name": kind.name, "summary": kind.summary,
            "keys": [{"name": key.name, "text": key.text, "meaning": key.meaning,
                      "usual": usual_of(key), "needed": key.default is None}
                     for key in kind.keys],
        }
        for kind in heat_conditions().values()
    ]  # fmt: skip
    held = {"name": HELD, "summary": "The face does not move along its normal.", "keys": []}
    feeder = {
        "name": FEEDER, "keys": [],
        "summary": "Metal is fed through the face: it is listed in foundry.feeders, and free faces "
        "that are not listed there feed no more.",
    }  # fmt: skip
    return {
        "processes": [
            {key: getattr(p, key) for key in ("name", "summary", "alloy", "mould", "refuses")}
            for p in processes
        ],
        "materials": [
            {"name": name, "class": entry.material_class, "melts": find_material(name, {}).melts}
            for name, entry in materials
        ],
        "conditions": [*conditions, held, feeder],
    }


def usual_of(key: HeatKey[Any]) -> str:
    """Return the usual range of a key in words, "" where it is no single range.

    Args:
        key: of a condition.
    """
    match key.usual:
        case (float(low), float(high)) if isinstance(key.usual, tuple):
            return f"{plain_text(low)} to {plain_text(high)}"
        case _:
            return ""


def new_arguments(workplace: Workplace, asked: Asked) -> list[str]:
    """Return the arguments of castx new for a part.

    Raises:
        CaseError: the part is none of the folder, or the case file exists.
    """
    part = text_of(asked, "path")
    if not is_cad_file(part) or not workplace.path(part).is_file():
        raise CaseError(f"{part} is no CAD file of this folder")
    target = word_of(asked, "output") or f"{part.rpartition('.')[0]}.toml"
    if workplace.case_path(target).exists():
        raise CaseError(f"{target} exists; choose another name for the new case file")
    arguments = ["new", part, "--output", target]
    for option in OPTIONS:
        value = word_of(asked, option)
        if value is not None:
            arguments += [f"--{option}", value]
    return arguments
