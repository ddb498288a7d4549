"""Names of the solids in the text of a STEP file, which gmsh writes without them.

A solid is a MANIFOLD_SOLID_BREP or a BREP_WITH_VOIDS, and belongs to the PRODUCT before it
(ISO 10303-21 for the text, 10303-41 for products).
"""

import re
from collections.abc import Iterator, Sequence

SOLID = re.compile(r"(=\s*(?:MANIFOLD_SOLID_BREP|BREP_WITH_VOIDS)\s*\(\s*)'(?:[^']|'')*'")
PRODUCT = re.compile(r"(=\s*PRODUCT\s*\(\s*)'(?:[^']|'')*'(\s*,\s*)'(?:[^']|'')*'")


def with_names(text: str, names: Sequence[str], assembly: str) -> str:
    """Return the text of a STEP file in which every solid and its product have a name.

    Args:
        text: of a STEP file with one product for each solid, as gmsh writes it.
        names: of the solids, in their order.
        assembly: name of the product that holds the solids.

    Raises:
        ValueError: the file has another number of solids, or a name is no plain text.
    """
    for name in (*names, assembly):
        if not re.fullmatch(r"[\w .+-]+", name, re.ASCII):
            raise ValueError(f"the name {name!r} has a character other than letters, digits, .+-_")
    found = [match.start() for match in SOLID.finditer(text)]
    if len(found) != len(names):
        raise ValueError(f"the file has {len(found)} solids for {len(names)} names")
    starts = [match.start() for match in PRODUCT.finditer(text)]
    owners = {max(start for start in starts if start < place): n for n, place in enumerate(found)}
    of_products = iter([names[owners[s]] if s in owners else assembly for s in starts])
    text = PRODUCT.sub(lambda match: product(match, next(of_products)), text)
    of_solids = iter(names)
    return SOLID.sub(lambda match: f"{match[1]}'{next(of_solids)}'", text)


def product(match: re.Match[str], name: str) -> str:
    """Return the beginning of a record PRODUCT with a name as its identifier and as its name."""
    return f"{match[1]}'{name}'{match[2]}'{name}'"


def names_of_solids(text: str) -> Iterator[str]:
    """Yield the names of the solids of a STEP file, in their order."""
    for match in SOLID.finditer(text):
        yield match[0].split("'", 1)[1][:-1]
