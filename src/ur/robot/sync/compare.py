"""Three-way comparison of two workspaces with their common state at the last sync, and the plan as text. Pure."""

from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from datetime import datetime, timezone, tzinfo

from ur.robot.sync.side import is_ignored
from ur.robot.sync.steps import SIDES, Agreed, Conflict, File, Identity, Manifest, Side, SyncPlan, SyncStep

BOTH = "changed on both sides"
FIRST = "different on both sides, and there was no sync before"
DELETED = "changed on one side, deleted on the other"
CLASH = "a file on one side, a folder on the other"


def compare(
    here: Manifest,
    there: Manifest,
    last: Mapping[str, Agreed],
    *,
    to: Collection[Side] = SIDES,
    prefer: Side | None = None,
    only: Sequence[str] = (),
) -> SyncPlan:
    """Plan a sync.

    A path that is unchanged on one side follows the other side; one changed on both sides is a conflict.

    `to` are the sides that may be changed. `only` limits the sync to these paths and those below. `prefer` resolves
    their conflicts in favour of one side; the other side's files are kept. Paths that either side cannot transfer are
    skipped. If one side has no path at all, nothing is deleted: that workspace is a new one.
    """
    sides: dict[Side, Mapping[str, File]] = {"here": here.files, "there": there.files}
    skipped = {path: f"there: {why}" for path, why in there.skipped.items()}
    skipped |= {path: f"here: {why}" for path, why in here.skipped.items()}
    notes = []
    for side in SIDES:
        if last and not sides[side] and any(sides.values()):
            notes.append(f"everything was deleted {side}: taken for a new workspace, so nothing is deleted")
            last = {}
    same: dict[str, Agreed] = {}
    steps: list[SyncStep] = []
    conflicts: list[Conflict] = []
    for path in sorted({*here.files, *there.files, *last}):
        if _is_below(path, skipped) or (only and not _is_below(path, only)):
            if path in last:
                same[path] = last[path]
            continue
        mine, yours = here.files.get(path), there.files.get(path)
        found = _compare_path(path, mine, yours, last.get(path), prefer)
        if isinstance(found, SyncStep):
            steps.append(found)
        elif isinstance(found, Conflict):
            conflicts.append(found)
        elif mine and yours:
            same[path] = Agreed(mine, yours)
        if found is not None and path in last:
            same[path] = last[path]
    waiting = [step for step in steps if step.to not in to]
    steps, clashes = _part_clashes(sides, [step for step in steps if step.to in to])
    return SyncPlan(
        tuple(steps),
        tuple(sorted([*conflicts, *clashes], key=lambda each: each.path)),
        tuple(waiting),
        same,
        skipped,
        tuple(notes),
    )


def _compare_path(
    path: str, here: File | None, there: File | None, last: Agreed | None, prefer: Side | None
) -> SyncStep | Conflict | None:
    mine, yours, old = (each.identity if each else None for each in (here, there, last))
    if mine == yours:
        return None
    if mine == old:
        return SyncStep(path, "here", here, there)
    if yours == old:
        return SyncStep(path, "there", there, here)
    if prefer == "here":
        return SyncStep(path, "there", there, here, keep=there is not None)
    if prefer == "there":
        return SyncStep(path, "here", here, there, keep=here is not None)
    return Conflict(path, here, there, _reason(mine, yours, old))


def _reason(mine: Identity | None, yours: Identity | None, old: Identity | None) -> str:
    if mine is None or yours is None:
        return DELETED
    return BOTH if old else FIRST


def _part_clashes(
    sides: Mapping[Side, Mapping[str, File]], steps: list[SyncStep]
) -> tuple[list[SyncStep], list[Conflict]]:
    """Remove steps that would put a file in place of the same side's folder, or the reverse; return the conflicts."""
    clashes: dict[str, Conflict] = {}
    while True:
        after = {side: dict(sides[side]) for side in SIDES}
        for step in steps:
            if step.after is None:
                after[step.to].pop(step.path, None)
            else:
                after[step.to][step.path] = step.after
        folders = {side: {parent for path in after[side] for parent in _parents(path)} for side in SIDES}
        bad = {
            step.path
            for step in steps
            if step.after is not None and _clashes(step.path, step.after, after[step.to], folders[step.to])
        }
        if not bad:
            return steps, list(clashes.values())
        for path in bad:
            clashes[path] = Conflict(path, sides["here"].get(path), sides["there"].get(path), CLASH)
        steps = [step for step in steps if step.path not in bad]


def _clashes(path: str, file: File, after: Mapping[str, File], folders: Collection[str]) -> bool:
    inside_a_file = any(each in after and after[each].kind != "folder" for each in _parents(path))
    return inside_a_file or (file.kind != "folder" and path in folders)


def _parents(path: str) -> list[str]:
    parts = path.split("/")
    return ["/".join(parts[:count]) for count in range(1, len(parts))]


def _is_below(path: str, places: Collection[str]) -> bool:
    return bool(places) and ("" in places or path in places or any(each in places for each in _parents(path)))


def drop_ignored(manifest: Manifest, patterns: Sequence[str]) -> Manifest:
    """Return a side without the paths that the other side ignores."""

    def ignored(path: str) -> bool:
        above = any(is_ignored(each, [*patterns], folder=True) for each in _parents(path))
        return above or is_ignored(path, [*patterns])

    return Manifest(
        {path: file for path, file in manifest.files.items() if not ignored(path)},
        {path: why for path, why in manifest.skipped.items() if not ignored(path)},
    )


def agree(plan: SyncPlan, done: Mapping[Side, Mapping[str, File | None]]) -> dict[str, Agreed]:
    """Return the common state after the steps in `done`, with the new state of the changed side (None: no file)."""
    agreed = dict(plan.same)
    for step in plan.steps:
        if step.path not in done[step.to]:
            continue
        now = done[step.to][step.path]
        if now is None or step.after is None:
            agreed.pop(step.path, None)
        else:
            pair = (now, step.after) if step.to == "here" else (step.after, now)
            agreed[step.path] = Agreed(*pair)
    return agreed


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
