"""Changes that a place offers: the fixes of findings, hiding them, and adding what is missing."""

import re
from collections.abc import Iterator
from dataclasses import dataclass

from ur.check.inclusion import list_includes
from ur.check.rule import LaunchView, TextEdit
from ur.check.survey import walk_elements
from ur.lsp.symbols import whole_of
from ur.lsp.workspace import Workspace
from ur.source.diagnostic import Diagnostic, UserError
from ur.source.file import Span
from ur.tools.format.run import format_file

_MEANT = re.compile(r"did you mean ['\"]?([^\s?'\"]+?)['\"]?(?::=\.\.\.)?\?")


@dataclass(frozen=True, slots=True)
class Action:
    """A change with a title; `fixes` is the finding that ends by it."""

    title: str
    edits: tuple[TextEdit, ...]
    fixes: Diagnostic | None = None


def list_actions(workspace: Workspace, path: str, start: int, end: int) -> list[Action]:
    """The changes that are offered for the characters `start` to `end` of a file."""
    view = workspace.view(path)
    found = [
        each
        for each in workspace.findings_of(path)
        if each.span is not None and each.span.start <= end and start <= max(each.span.end, each.span.start + 1)
    ]
    return [action for each in found for action in _for_finding(each, view, workspace)]


def _for_finding(found: Diagnostic, view: LaunchView | None, workspace: Workspace) -> Iterator[Action]:
    assert found.span is not None
    rules = workspace.session.rules if workspace.session is not None else {}
    rule = rules.get(found.rule)
    edits = rule.fix(found) if rule is not None and rule.fix is not None else ()
    if edits:
        yield Action(f"Repair: {found.rule}", tuple(edits), found)
    elif near := _replacement(found):
        yield Action(f"Change to '{near}'", (TextEdit(found.span, near),), found)
    if view is not None and found.span.file.text == view.tree.source.text:
        yield from _add_missing(found, view)
        yield from _hide(found, view)


def _replacement(found: Diagnostic) -> str | None:
    # The help names what was meant; the span may hold more than the name that is wrong.
    match = _MEANT.search(found.help or "")
    if match is None or found.span is None:
        return None
    written, meant = found.span.text, match.group(1)
    if not written or any(letter in written for letter in "<>\n"):
        return None
    if found.subject and found.subject != written and written.count(found.subject) == 1:
        return written.replace(found.subject, meant)
    return meant if "$" not in written and "/" not in written else None


def _add_missing(found: Diagnostic, view: LaunchView) -> Iterator[Action]:
    launch = view.tree.launch
    if launch is None or found.span is None:
        return
    if found.rule == "undeclared-argument" and (name := found.subject or found.span.text):
        at = launch.tag_span.end
        edit = TextEdit(Span(view.tree.source, at, at), f'\n  <arg name="{name}"/>')
        yield Action(f"Declare the argument '{name}'", (edit,), found)
    if found.rule == "missing-argument" and found.subject:
        element = next(
            (e for e in list_includes(view) if e.start <= found.span.start < max(e.end, e.tag_span.end)), None
        )
        if element is not None:
            tag = element.tag_span
            indent = " " * (element.span.position.column - 1)
            passed = f'<arg name="{found.subject}" value="$(arg {found.subject})"/>'
            if found.subject not in view.declared:
                passed = f'<arg name="{found.subject}" value=""/>'
            if tag.text.endswith("/>"):
                edit = TextEdit(Span(tag.file, tag.end - 2, tag.end), f">\n{indent}  {passed}\n{indent}</include>")
            else:
                edit = TextEdit(Span(tag.file, tag.end, tag.end), f"\n{indent}  {passed}")
            yield Action(f"Pass the argument '{found.subject}'", (edit,), found)


def _hide(found: Diagnostic, view: LaunchView) -> Iterator[Action]:
    assert found.span is not None
    source = view.tree.source
    holding = [e for e, _ in walk_elements(view.tree.launch) if e.start <= found.span.start < whole_of(e).end]
    if not holding or holding[-1] is view.tree.launch:
        return
    start = holding[-1].start
    line = source.text.rfind("\n", 0, start) + 1
    indent = source.text[line:start] if not source.text[line:start].strip() else ""
    comment = f"<!--ur: ignore {found.rule}: REASON-->\n{indent}"
    yield Action(f"Hide '{found.rule}' here", (TextEdit(Span(source, start, start), comment),), found)


def format_text(workspace: Workspace, path: str) -> str | None:
    """A launch file in conventional layout; None where it is so already, or cannot be laid out."""
    try:
        data = workspace.world.read_bytes(path)
        package = workspace.session.sources.targets.package_of(path) if workspace.session is not None else None
        formatted = format_file(path, data, workspace.world, package)
    except (OSError, UserError):
        return None
    return formatted.text if formatted.changed else None
