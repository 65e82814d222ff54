"""Whatever the resolver reports about a file has a rule, and so a page and a name to hide it by."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

from ur.check.catalogue import load_rules

LAUNCHFILE = Path(__file__).parents[2] / "src" / "ur" / "launchfile"
# Where the rule's id stands among the arguments of what reports a finding.
POSITIONS = {"refuse": 2, "warn": 3, "stop": 2, "SubstitutionProblem": 3}
NOT_ABOUT_A_FILE = {"ambiguous-file", "bad-argument", "param-command", "unknown-name", "unknown-node"}


def ids_in(path: Path) -> Iterator[str]:
    for call in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if not isinstance(call, ast.Call):
            continue
        name = getattr(call.func, "id", getattr(call.func, "attr", ""))
        candidates = [keyword.value for keyword in call.keywords if keyword.arg == "rule"]
        if name in POSITIONS:
            candidates += call.args[POSITIONS[name] : POSITIONS[name] + 1]
        for node in candidates:
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                yield node.value


def test_every_id_of_the_resolver_is_a_rule() -> None:
    found = {id_ for path in LAUNCHFILE.rglob("*.py") for id_ in ids_in(path)}
    assert len(found) > 40
    assert all(re.fullmatch(r"[a-z]+(-[a-z]+)+", id_) for id_ in found)
    assert found - NOT_ABOUT_A_FILE <= set(load_rules())
