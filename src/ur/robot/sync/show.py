"""Text of a sync's plan for display. Pure."""

from collections import Counter
from collections.abc import Iterator, Sequence
from datetime import datetime, timezone, tzinfo

from ur.robot.sync.compare import CLASH
from ur.robot.sync.steps import Conflict, File, Side, SyncPlan, SyncStep

MANY = 60  # steps: above that number, they are displayed by folder


def describe_plan(plan: SyncPlan, robot: str, *, zone: tzinfo | None = None) -> Iterator[str]:
    """Yield lines that describe the steps, the conflicts with their reasons, and the skipped paths."""
    yield from (f"note: {note}" for note in plan.notes)
    yield from _describe_steps(plan.steps, robot)
    if plan.waiting:
        yield f"{_count(plan.waiting, 'change')} in the other direction left as they are"
    if plan.skipped:
        yield "left out:"
        yield from (f"  {path or '.'}: {why}" for path, why in sorted(plan.skipped.items()))
    if plan.conflicts:
        yield "conflicts, left as they are on both sides:"
        for conflict in plan.conflicts:
            yield from _describe_conflict(conflict, robot, zone)
        yield f"  help: {_advise(plan.conflicts, robot)}"


def _describe_steps(steps: Sequence[SyncStep], robot: str) -> Iterator[str]:
    if len(steps) <= MANY:
        for step in steps:
            yield f"  {_arrow(step.to, robot)}  {_what(step):<7}  {step.path}{_size(step)}"
        return
    groups = Counter((step.to, _what(step), step.path.partition("/")[0]) for step in steps)
    for (to, what, folder), number in sorted(groups.items()):
        yield f"  {_arrow(to, robot)}  {what:<7}  {folder}: {number} {'file' if number == 1 else 'files'}"


def _describe_conflict(conflict: Conflict, robot: str, zone: tzinfo | None) -> Iterator[str]:
    yield f"  {conflict.path}: {conflict.reason}"
    for name, file in (("here", conflict.here), (robot, conflict.there)):
        yield f"    {name}: {describe_file(file, zone)}"


def _advise(conflicts: Sequence[Conflict], robot: str) -> str:
    if all(conflict.reason == CLASH for conflict in conflicts):
        return "move one of the two away"
    path = next(conflict.path for conflict in conflicts if conflict.reason != CLASH)
    return f"choose one: ur sync {robot} --take here {path} (or --take there); the other one is kept"


def describe_file(file: File | None, zone: tzinfo | None = None) -> str:
    """Return one line: size and time of change, in the time zone of this computer unless another is given."""
    if file is None:
        return "not there"
    if file.kind == "link":
        return f"a link to {file.content}"
    if file.kind == "folder":
        return "an empty folder"
    when = datetime.fromtimestamp(file.time / 1e9, timezone.utc).astimezone(zone)
    return f"{describe_size(file.size)}, changed {when:%Y-%m-%d %H:%M:%S}" + (", executable" if file.executable else "")


def describe_size(size: int) -> str:
    """Format a number of bytes with two or three digits."""
    value, units = float(size), ["B", "kB", "MB", "GB"]
    while value >= 999.5 and len(units) > 1:
        value /= 1000
        units.pop(0)
    return f"{value:.0f} {units[0]}" if units[0] == "B" or value >= 10 else f"{value:.1f} {units[0]}"


def summarise(plan: SyncPlan, robot: str) -> str:
    """Return one line: the number of changes in each direction, and of conflicts."""
    parts = [
        f"{_count([step for step in plan.steps if step.to == side], 'change')} {where}"
        for side, where in (("there", f"to {robot}"), ("here", f"from {robot}"))
        if any(step.to == side for step in plan.steps)
    ]
    if plan.conflicts:
        parts.append(_count(plan.conflicts, "conflict"))
    return ", ".join(parts) or f"in step with {robot}"


def _arrow(to: Side, robot: str) -> str:
    text = f"-> {robot}" if to == "there" else "<- here"
    return text.ljust(3 + max(len("here"), len(robot)))


def _what(step: SyncStep) -> str:
    if step.after is None:
        return "deleted"
    return "new" if step.before is None else "changed"


def _size(step: SyncStep) -> str:
    return f"  ({describe_size(step.after.size)})" if step.after and step.after.kind == "file" else ""


def _count(items: Sequence[object], noun: str) -> str:
    return f"{len(items)} {noun}{'' if len(items) == 1 else 's'}"
