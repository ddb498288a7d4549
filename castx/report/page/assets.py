"""Scripts and styles inside a page, and data that no text of a user can break out of."""

from __future__ import annotations

import json
import re
from base64 import b64encode
from collections.abc import Sequence
from importlib.resources import files
from typing import Any

import jinja2
from markupsafe import Markup

SCRIPTS = ("data", "geometry", "gl", "camera", "view", "controls", "charts", "start")
"""Scripts of castx in the order in which they are loaded, behind uPlot."""
CURVES_ONLY = ("data", "charts", "start")
"""Those of a page without a view."""
_HERE = files("castx.report.page")


def page(template: str, scripts: Sequence[str], **content: Any) -> str:
    """Return a page that needs no other file, nor a network.

    Args:
        template: its name in templates/.
        scripts: those of castx that it needs.
        content: for the template; texts are escaped there.
    """
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("castx.report.page", "templates"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
    )
    environment.filters["data"] = data
    return environment.get_template(template).render(
        style=Markup(text("vendor/uPlot.min.css") + text("templates/style.css")),
        script=Markup("\n".join([uplot(), *(text(f"scripts/{name}.js") for name in scripts)])),
        licence=text("vendor/uPlot.LICENSE"),
        **content,
    )


def text(name: str) -> str:
    """Return the content of a file of this room."""
    return (_HERE / name).read_text(encoding="utf-8")


def uplot() -> str:
    """Return the library of the curves; its first comment loses the address of its home."""
    return re.sub(r"https?://\S+?/(\w+/uPlot)", r"\1", text("vendor/uPlot.iife.min.js"), count=1)


def data_uri(png: bytes) -> str:
    """Return a PNG as an address that holds it."""
    return "data:image/png;base64," + b64encode(png).decode("ascii")


def data(content: Any) -> Markup:
    """Return data as JSON for a script element: no text in it can end the element."""
    found = json.dumps(content, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    for letter in "<>&\u2028\u2029":
        found = found.replace(letter, f"\\u{ord(letter):04x}")
    return Markup(found)
