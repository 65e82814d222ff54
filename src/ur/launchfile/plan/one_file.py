"""Resolution of a single launch file: the files that it includes are named, but not resolved.

A check of many files in many cases resolves each file once per arguments, and combines the results.
"""

from collections.abc import Mapping

from ur.launchfile.plan.draft import Draft, TooMuch
from ur.launchfile.plan.scope import Scope
from ur.launchfile.plan.specs import Plan
from ur.launchfile.plan.tags.body import resolve_file
from ur.launchfile.syntax import LaunchFile
from ur.launchfile.world.protocol import World
from ur.source.diagnostic import error, error_about
from ur.source.suggest import suggest

# A letter that no launch file uses: names that start with it are relative to the including file's namespace.
HERE = "/ǁ/"


def load_one_file(
    path: str, arguments: Mapping[str, str], world: World, trees: dict[str, LaunchFile], *, passes_all: bool = False
) -> Plan:
    """Return the nodes, parameters and includes of one file with these arguments. Never raises for its content.

    Names are relative to `HERE` if they depend on the namespace in which the file is included. Everything that depends
    on more than the arguments is ignored: `<machine>` tags, remaps and `~` parameters of the including files. Every
    argument has to be declared, as in an `<include>`; `passes_all` as with `pass_all_args`. See load_plan for `trees`.
    """
    draft = Draft(world, trees=trees, follow=False)
    try:
        _load(path, arguments, draft, passes_all)
    except TooMuch:
        pass
    except RecursionError:
        draft.diagnostics.append(error("nested too deep", rule="nested-too-deep", help="nest groups less"))
    return draft.finish()


def _load(path: str, arguments: Mapping[str, str], draft: Draft, passes_all: bool) -> None:
    try:
        parsed = draft.parse(path)
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        draft.add_diagnostic(error_about(path, f"{reason}, expected a launch file", rule="missing-file"), ())
        return
    scope = Scope(HERE, path, dict(arguments))
    scope.pass_all_args = passes_all
    if resolve_file(parsed, draft, scope) and not passes_all:
        for name in arguments:
            if name not in scope.declared:
                declared = ", ".join(sorted(scope.declared)) or "none"
                draft.add_diagnostic(
                    error(
                        f"argument '{name}' is passed, but {path} does not declare it",
                        rule="unknown-argument",
                        help=suggest(name, set(scope.declared) - set(arguments)) or f"that file declares: {declared}",
                        subject=name,
                    ),
                    (),
                )
