"""Another name for each argument of each launch file below folders: every plan stays equal but for the name.

    .venv/bin/python -m tests.lsp.renames FOLDER...

The plans of all files that read a changed one are compared, whether the rename itself looked at them or not.
"""

import os
import sys
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field

from ur.check.cases import resolve_cases
from ur.check.rule import survey_launch_file
from ur.check.session import CheckSession
from ur.check.worlds import CachedWorld, make_world
from ur.launchfile.plan.specs import Plan
from ur.launchfile.world import World
from ur.launchfile.world.overlay import OverlayWorld
from ur.lsp.workspace import encode_text
from ur.source.diagnostic import UserError
from ur.tools.find.arguments import apply_rename, find_sharing_files, rename_argument
from ur.tools.format.run import describe_plan

NEW = "name_that_no_file_has"
Plans = list[tuple[object, object]]  # of each case: what is given, and what it means


@dataclass(slots=True)
class Renamed:
    """The outcome of renames: how many are equal, how many plans were compared, and why others were refused."""

    equal: int = 0
    plans: int = 0
    refused: Counter[str] = field(default_factory=Counter)
    different: list[str] = field(default_factory=list)


def rename_everything(folder: str, world: World) -> Renamed:
    """Rename each argument below a folder, one at a time."""
    session = CheckSession([folder], world)
    next(session.steps(), None)
    sources, done = session.sources, Renamed()
    views = {**sources.views, **sources.neighbours}
    programs = [text for path in sources.targets.programs if (text := sources.read_text(path)) is not None]
    cached = CachedWorld(world)
    before: dict[str, Plans] = {}
    reads: dict[str, set[str]] = {}
    for path in views:
        cached.noted = set()
        before[path] = list(plans_of(path, cached))
        reads[path] = {question[1] for question in cached.noted if question[0] == "read_bytes"}
    for path, view in views.items():
        for name in view.declared:
            try:
                texts = apply_rename(rename_argument(path, name, NEW, views, session.world, programs), NEW)
            except UserError as problem:
                done.refused[problem.diagnostics[0].message.replace(name, "NAME").removeprefix(path)] += 1
                continue
            files = find_sharing_files(path, name, views)
            after = CachedWorld(OverlayWorld(world, {each: encode_text(text) for each, text in texts.items()}))
            readers = [each for each in views if reads[each] & set(texts)]
            wrong = [each for each in readers if list(plans_of(each, after, files, name)) != before[each]]
            done.plans += sum(len(before[each]) for each in readers)
            done.equal += not wrong
            done.different += [f"{name} of {path}: {each}" for each in wrong]
    return done


def plans_of(
    path: str, world: CachedWorld, renamed: object = frozenset(), old: str = ""
) -> Iterator[tuple[object, object]]:
    """What a file means in each case; `renamed` files have NEW in place of the argument `old`."""
    assert isinstance(renamed, frozenset | set)
    for resolved in resolve_cases(survey_launch_file(path, None, world), world):
        given = tuple((old if name == NEW and path in renamed else name, value) for name, value in resolved.case.given)
        yield sorted(given), describe_plan(with_old_name(resolved.plan, renamed, old))


def with_old_name(plan: Plan, renamed: frozenset[str] | set[str], old: str) -> Plan:
    """A plan with what is passed to `renamed` files as it was called before; findings may speak of the new name."""
    includes = tuple(
        each._replace(arguments=tuple((old if name == NEW else name, value) for name, value in each.arguments))
        if each.file in renamed
        else each
        for each in plan.includes
    )
    return plan._replace(includes=includes, diagnostics=())


def main() -> int:
    """Print a line for each folder."""
    wrong = 0
    for folder in sys.argv[1:]:
        done = rename_everything(folder, make_world([folder], {"PATH": os.environ["PATH"]}))
        count = f"{done.equal} renames equal, {len(done.different)} not, {done.plans} plans compared"
        sys.stdout.write(f"{os.path.basename(folder.rstrip('/'))}: {count}, {done.refused.total()} refused\n")  # noqa: PTH119 - texts
        sys.stdout.writelines(f"  {number} times: {why}\n" for why, number in done.refused.most_common())
        sys.stdout.writelines(f"  different: {each}\n" for each in done.different)
        sys.stdout.flush()
        wrong += len(done.different)
    return 1 if wrong or len(sys.argv) < 2 else 0


if __name__ == "__main__":
    raise SystemExit(main())
