"""The command line that all parts have: parameters in, STEP, numbers, mesh and picture out."""

import argparse
from collections.abc import Callable, Sequence
from dataclasses import fields
from pathlib import Path
from typing import TypeVar

from demos.parts.assembly import (
    Assembly,
    contacts,
    fill_mesh,
    joined,
    mesh_quality,
    volumes,
    write_gmsh,
    write_step,
)
from demos.parts.picture import draw
from demos.parts.solids import drawing

Parameters = TypeVar("Parameters")


def main(
    build: Callable[[Parameters], Assembly],
    kind: type[Parameters],
    about: str | None,
    given: Sequence[str] | None = None,
) -> None:
    """Draw a part, write what is asked for and print its volumes and contacts.

    Args:
        build: draws the part.
        kind: dataclass of its parameters, each of which becomes an option.
        about: what the part is.
        given: arguments; None: those of the command line.
    """
    parser = argparse.ArgumentParser(
        description=about, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("step", type=Path, help="STEP file to be written")
    parser.add_argument("--mesh", type=Path, help="gmsh mesh to be written, in metres")
    parser.add_argument("--size", type=float, default=6.0, help="size of its cells [mm]")
    parser.add_argument("--picture", type=Path, help="exploded view to be written")
    for item in fields(kind):  # type: ignore[arg-type]
        option = f"--{item.name.replace('_', '-')}"
        convert = int if isinstance(item.default, int) else float
        parser.add_argument(option, type=convert, default=item.default)
    options = vars(parser.parse_args(given))
    parameters = kind(**{item.name: options[item.name] for item in fields(kind)})  # type: ignore[arg-type]
    with drawing(kind.__name__):
        assembly = build(parameters)
        write_step(assembly, options["step"])
        tell_volumes(assembly)
        assembly = joined(assembly)
        tell_contacts(assembly)
        if options["picture"]:
            draw(assembly, options["size"], options["picture"])
        if options["mesh"]:
            fill_mesh(assembly, options["size"])
            write_gmsh(options["mesh"])
            count, least, mean = mesh_quality()
            print(f"{count} tetrahedra, quality {least:.3f} at least, {mean:.3f} in the mean")


def tell_volumes(assembly: Assembly) -> None:
    """Print the volume of each solid."""
    for name, volume in volumes(assembly).items():
        print(f"{name:16} {volume:14.3f} mm³")


def tell_contacts(assembly: Assembly) -> None:
    """Print the area of each contact."""
    for (first, second), area in contacts(assembly).items():
        print(f"{first + '/' + second:32} {area:12.3f} mm²")
