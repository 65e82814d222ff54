"""The table of bench/urdf: a line for each robot."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from bench.urdf_parts.bases import Made

_FIGURES = 8
HEAD = f"{'robot':26} {'read':>5} {'check':>6} {'world':>7} {'goals':>7} {'path':>6} {'error':>6} {'hits':>5}  asked"


@dataclass(frozen=True, slots=True)
class Row:
    """A robot, the base made of it, and the figures of its drive ({} without one)."""

    name: str
    made: Made
    drive: Mapping[str, Any] = field(default_factory=dict)

    def is_good(self, *, driven: bool) -> bool:
        """Whether the base was made and accepted and, where it was `driven`, reached all goals and touched nothing."""
        if self.made.problem or self.made.findings or self.drive.get("breaches"):
            return False
        figures = self.drive
        return not driven or (
            bool(figures.get("goals")) and figures.get("reached") == figures.get("goals") and not figures["collisions"]
        )


def print_row(row: Row) -> None:
    """Print its line, and lines with what went wrong."""
    print(render_row(row), flush=True)


def render_row(row: Row) -> str:
    """The line of a robot, and a line for each thing that went wrong."""
    made, drive = row.made, row.drive
    breaches = list(drive.get("breaches", ()))
    check = "-" if made.problem else "found" if made.findings or breaches else "ok"
    goals = path = wrong = hits = "-"
    if "goals" in drive:
        goals = f"{drive['reached']}/{drive['goals']}"
        path, wrong, hits = f"{drive['path']:.3f}", f"{drive['final_error']:.3f}", str(drive["collisions"])
    line = f"{row.name[:26]:26} {made.read:3}/{_FIGURES} {check:>6} {drive.get('world', '-'):>7} {goals:>7} {path:>6}"
    line += f" {wrong:>6} {hits:>5}  {', '.join(made.asked) or '-'}"
    troubles = [made.problem, *made.findings.splitlines(), drive.get("problem", ""), *drive.get("failures", ())]
    troubles += [f"not published: {breach}" for breach in breaches]
    return "\n".join([line, *(f"    {trouble}" for trouble in troubles if trouble)])
