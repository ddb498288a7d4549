"""The page as one file: its scripts and styles inside, allowed by a number used once."""

from __future__ import annotations

import secrets
from importlib.resources import files

from castx.report.page.assets import text as of_report
from castx.report.page.assets import uplot

STATIC = files("castx.app") / "static"
SHARED = ("data", "geometry", "gl", "camera", "charts")
"""Scripts of the report that the page uses too."""
OWN = ("server", "editor", "run", "view", "part", "forms", "mesh", "moment", "start")
STYLES = ("vendor/uPlot.min.css",)


def page() -> tuple[str, str]:
    """Return the page and its Content-Security-Policy."""
    nonce = secrets.token_urlsafe(16)
    scripts = [uplot(), *(of_report(f"scripts/{name}.js") for name in SHARED)]
    scripts += [static(f"{name}.js") for name in OWN]
    style = "".join(of_report(name) for name in STYLES) + static("page.css")
    text = (
        static("page.html")
        .replace("{{nonce}}", nonce)
        .replace("{{style}}", style)
        .replace("{{script}}", "\n".join(scripts))
        .replace("{{licence}}", of_report("vendor/uPlot.LICENSE"))
    )
    policy = (
        f"default-src 'none'; script-src 'nonce-{nonce}'; style-src 'nonce-{nonce}'; "
        "img-src data:; connect-src 'self'; base-uri 'none'; form-action 'none'; "
        "frame-ancestors 'none'"
    )
    return text, policy


def static(name: str) -> str:
    """Return the content of a file of the page."""
    return (STATIC / name).read_text(encoding="utf-8")
