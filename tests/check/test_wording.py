"""The wording of the diagnostics: what each rule prints for its own bad examples, in one file.

`UR_UPDATE_GOLDEN=1` writes it anew. Other tests assert rule, place and subject.
"""

import os
from pathlib import Path

from ur.check.catalogue import load_rules
from ur.check.render.pages import FOLDER, check_example
from ur.check.render.text import shorten_paths
from ur.check.rule import Rule

GOLDEN = Path(__file__).parent / "golden" / "wording.txt"


def describe(rule: Rule) -> str:
    lines = [f"{rule.id}\n"]
    for example in rule.bad:
        for found in shorten_paths(check_example(example), FOLDER).findings:
            lines.append(f"  {found.severity.value}: {found.message}\n")
            lines += [f"    note: {note.message}\n" for note in found.notes]
            lines += [f"    help: {found.help}\n"] if found.help else []
    return "".join(lines)


def test_wording_of_each_rule_is_as_agreed() -> None:
    made = "\n".join(describe(rule) for rule in load_rules().values() if rule.bad)
    if os.environ.get("UR_UPDATE_GOLDEN"):
        GOLDEN.write_text(made, encoding="utf-8")
    assert made == GOLDEN.read_text(encoding="utf-8"), "read the difference, then run this with UR_UPDATE_GOLDEN=1"
