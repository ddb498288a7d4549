"""Names in the text of STEP files."""

from __future__ import annotations

import pytest

from demos.parts.step_names import names_of_solids, with_names

pytestmark = pytest.mark.serial

TEXT = """#7 = PRODUCT('whole','whole','',(#8));
#37 = PRODUCT('whole 1.1',
  'whole 1.1','',(#38));
#41 = MANIFOLD_SOLID_BREP('',#42);
#386 = PRODUCT('it''s','it''s','',(#387));
#390 = BREP_WITH_VOIDS('',#391,(#392));
#400 = PRODUCT_CONTEXT('',#2,'mechanical');
"""


def test_products_and_solids_are_named_in_their_order():
    named = with_names(TEXT, ["casting", "die-left"], "assembly")
    assert list(names_of_solids(named)) == ["casting", "die-left"]
    assert named == (
        "#7 = PRODUCT('assembly','assembly','',(#8));\n"
        "#37 = PRODUCT('casting',\n  'casting','',(#38));\n"
        "#41 = MANIFOLD_SOLID_BREP('casting',#42);\n"
        "#386 = PRODUCT('die-left','die-left','',(#387));\n"
        "#390 = BREP_WITH_VOIDS('die-left',#391,(#392));\n"
        "#400 = PRODUCT_CONTEXT('',#2,'mechanical');\n"
    )


@pytest.mark.parametrize("names", [["casting"], ["casting", "die", "core"]])
def test_another_number_of_solids_is_refused(names):
    with pytest.raises(ValueError, match=f"2 solids for {len(names)} names"):
        with_names(TEXT, names, "assembly")


@pytest.mark.parametrize("name", ["die's", "Käfig", "", "a/b"])
def test_names_that_no_text_should_hold_are_refused(name):
    with pytest.raises(ValueError, match="has a character"):
        with_names(TEXT, [name, "die"], "assembly")
