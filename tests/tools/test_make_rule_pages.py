"""The rule pages are those that the rules make."""

import runpy
from pathlib import Path

ROOT = Path(__file__).parents[2]


def test_committed_pages_are_what_the_rules_say() -> None:
    tool = runpy.run_path(str(ROOT / "tools" / "make_rule_pages.py"))
    made: dict[str, str] = tool["make_pages"]()
    committed = {path.name: path.read_text(encoding="utf-8") for path in tool["FOLDER"].glob("*.md")}
    assert sorted(committed) == sorted(made)
    stale = [name for name in made if made[name] != committed[name]]
    assert not stale, f"run tools/make_rule_pages.py: {', '.join(stale)}"
