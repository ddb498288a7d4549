"""What castx adds to Sphinx: plain docstrings, links to files, a search without code objects."""

from __future__ import annotations

import re
from collections.abc import Iterator
from enum import Enum
from typing import Any

from docutils import nodes
from pydantic import BaseModel
from sphinx.application import Sphinx
from sphinx.domains.python import PythonDomain
from sphinx.util.nodes import make_refnode

from docs.generator.docstrings import restructured_lines

PLACE = re.compile(r"((?:castx|forms|meshes)/[\w/]+)\.py:([\w.]+)")
_BEFORE_NAPOLEON = 400
_NEVER_FOUND = -1
"""Priority of objects that the search leaves out."""


class UnsearchedPythonDomain(PythonDomain):
    """The objects of the code, which links and the index have and the search has not.

    A search shows objects before pages, and "castx" is in all of their names.
    """

    def get_objects(self) -> Iterator[tuple[str, str, str, str, str, int]]:
        """Yield the objects as Sphinx does, with a priority of their own."""
        for *found, _ in super().get_objects():
            name, shown, kind, page, anchor = found
            yield name, shown, kind, page, anchor, _NEVER_FOUND


def escape_docstring(
    app: Sphinx, what: str, name: str, obj: object, options: object, lines: list[str]
) -> None:
    """Turn the plain text of a docstring into reStructuredText."""
    lines[:] = restructured_lines(lines)


def hide_signature(
    app: Sphinx, what: str, name: str, obj: object, options: object, signature: str, result: str
) -> tuple[str, str | None] | None:
    """Leave out signatures that say nothing: of case-file descriptions, enumerations, protocols."""
    empty = isinstance(obj, type) and issubclass(obj, BaseModel | Enum)
    if empty or getattr(obj, "_is_protocol", False):
        return "", None
    return None


def link_places(app: Sphinx, tree: nodes.document, page: str) -> None:
    """Let texts such as `forms/momentum.py:traction_work` link to the docstring of the object."""
    objects: Any = app.env.get_domain("py").objects  # type: ignore[attr-defined]
    for literal in list(tree.findall(nodes.literal)):
        place = PLACE.fullmatch(literal.astext())
        if place is None:
            continue
        module = place[1].replace("/", ".")
        name = f"{module if module.startswith('castx') else 'castx.' + module}.{place[2]}"
        if name in objects:
            target = objects[name]
            literal.replace_self(
                make_refnode(app.builder, page, target.docname, target.node_id, literal.deepcopy())
            )


def setup(app: Sphinx) -> dict[str, bool]:
    """Connect the functions of this module."""
    app.add_domain(UnsearchedPythonDomain, override=True)
    app.connect("autodoc-process-docstring", escape_docstring, _BEFORE_NAPOLEON)
    app.connect("autodoc-process-signature", hide_signature)
    app.connect("doctree-resolved", link_places)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
