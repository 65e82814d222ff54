"""The includes of one launch file: what is written, and which files that means in which case."""

from __future__ import annotations

from collections.abc import Callable

from ur.check.model import LaunchView
from ur.docs.cases.resolve import Outcome, find_include, list_switches
from ur.docs.model import Case, IncludeDoc, TargetDoc, TargetState
from ur.docs.repository.bases import match_paths
from ur.docs.repository.world import is_elsewhere, is_unknown
from ur.docs.words import Words
from ur.launchfile.syntax import Element


def describe_include(
    element: Element,
    conditions: tuple[str, ...],
    view: LaunchView,
    outcomes: tuple[Outcome, ...],
    words: Words,
    show_path: Callable[[str], str],
) -> IncludeDoc:
    """An `<include>`. Where its file depends on what only the user knows, every file that fits is named."""
    found = [(o, w, spec) for o in outcomes for w in o.resolutions if (spec := find_include(w, element.start))]
    targets: dict[tuple[str, str, str], dict[Case, None]] = {}
    for outcome, _, spec in found:
        if is_elsewhere(spec.file):
            key = (words.show(spec.file, dict(outcome.given)), "", "elsewhere")
        elif is_unknown(spec.file):
            continue
        else:
            path = show_path(spec.file)
            key = (path.rpartition("/")[2], path, "found" if spec.found else "missing")
        targets.setdefault(key, {})[outcome.case] = None
    written = element.attributes.get("file", "")
    every = len(outcomes)
    docs = [
        TargetDoc(name, path, state, () if len(cases) == every else tuple(case for case in cases if case.base))  # type: ignore[arg-type]  # a state, see above
        for (name, path, state), cases in targets.items()
    ]
    if not found or any(is_unknown(spec.file) and not is_elsewhere(spec.file) for _, _, spec in found):
        known = {doc.path for doc in docs}
        paths = (show_path(path) for path in match_paths(written, view))
        fitting = [path for path in paths if path not in known]
        state: TargetState = "found" if not docs and len(fitting) == 1 else "candidate"
        docs += [TargetDoc(path.rpartition("/")[2], path, state) for path in fitting]
    return IncludeDoc(
        written=" ".join(written.split()),
        targets=tuple(docs),
        conditions=conditions,
        only_with=list_switches((outcome, resolution) for outcome, resolution, _ in found),
        passes=tuple(_list_passed(element)),
        line=element.span.position.line,
    )


def _list_passed(element: Element) -> list[tuple[str, str]]:
    passed = [
        (inner.attributes.get("name", ""), " ".join((inner.attributes.get("value") or "").split()))
        for inner in element.elements
        if inner.name == "arg"
    ]
    if element.attributes.get("pass_all_args", "").strip().lower() in ("true", "1"):
        passed.insert(0, ("pass_all_args", ""))
    return passed
