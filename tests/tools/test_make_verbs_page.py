"""The page of verbs is made of their help."""

import runpy
from pathlib import Path

ROOT = Path(__file__).parents[2]
TOOL = runpy.run_path(str(ROOT / "tools" / "make_verbs_page.py"))


def test_committed_page_is_made_of_the_help() -> None:
    committed = TOOL["PAGE"].read_text(encoding="utf-8")
    assert committed == TOOL["make_page"](), "run tools/make_verbs_page.py"


def test_every_verb_has_a_heading_that_its_link_leads_to() -> None:
    from ur.cli.verbs import VERBS

    lines = TOOL["make_page"]().splitlines()
    for name in VERBS:
        assert f"## `ur {name}`" in lines
        assert any(f"(#ur-{name})" in line for line in lines)


def test_markup_in_help_is_kept_as_text() -> None:
    assert TOOL["_escape"]("a <b> `x<y` c_d") == r"a \<b> `x<y` c\_d"


def test_options_that_many_verbs_have_are_described_once() -> None:
    page = TOOL["make_page"]()
    assert page.count("- `--all`: All robots") == 1
    assert "`--all`" in page.partition("## `ur sync`\n")[2].partition("\n## ")[0]
