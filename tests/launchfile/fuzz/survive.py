"""What has to hold for any file at all."""

from __future__ import annotations

from pathlib import Path

from ur.launchfile import SystemWorld, dump_plan, load_plan
from ur.launchfile.plan.commands import refuse_command
from ur.source import render_human

CORPUS = Path(__file__).parents[1] / "corpus"


def read_corpus() -> list[bytes]:
    """Every launch file of the corpus."""
    return [path.read_bytes() for path in sorted(CORPUS.rglob("*.launch*"))]


def check_survives(path: Path, environment: dict[str, str]) -> None:
    """Raise whatever a file makes us raise; every finding has a place that can be shown, and the plan is JSON."""
    plan = load_plan([str(path)], ["a:=1"], SystemWorld(environment))
    text = render_human(plan.diagnostics)
    assert "Traceback" not in text
    dump_plan(plan, with_origins=True, run=refuse_command)
