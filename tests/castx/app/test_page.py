"""The page needs nothing from elsewhere, and runs only its own scripts."""

import re

import pytest

from castx.app.page import OWN, STATIC, page

pytestmark = pytest.mark.serial


def test_its_policy_allows_its_own_scripts_and_no_others():
    (text, policy), (_, other) = page(), page()
    (nonce,) = re.findall(r"script-src 'nonce-([\w-]+)'", policy)
    assert policy != other and "unsafe" not in policy and "default-src 'none'" in policy
    assert text.count(f'nonce="{nonce}"') == len(re.findall("<script|<style", text)) == 2
    assert not re.search(r"\s(?:on\w+|style)=\"", text.split("<script")[0])
    assert "{{" not in text.split("<script")[0]


def test_it_loads_nothing_and_reads_no_text_as_html():
    text, _ = page()
    assert not re.search(r"""(?:src|href)\s*=\s*["']?(?:https?:)?//""", text)
    for name in OWN:
        script = (STATIC / f"{name}.js").read_text()
        assert not re.findall(
            r"innerHTML|outerHTML|insertAdjacent|document\.write|\beval\b", script
        )
