"""Answers about places in launch files that are programs or YAML: values, definitions, candidates, uses."""

import re
from collections.abc import Iterable, Iterator
from contextlib import suppress

from ur.complete.launch import complete_packages
from ur.launchfile.plan.specs import ArgumentStep, IncludeSpec, ParameterFile, ValueStep
from ur.launchfile.query.written import ENDINGS, WrittenName, find_keywords, find_package_near, find_written
from ur.launchfile.world.protocol import PackageNotFound
from ur.lsp.convert import move_span
from ur.lsp.cursor import Candidate
from ur.lsp.workspace import Workspace
from ur.source.file import SourceFile, Span
from ur.tools.find.arguments import find_argument_texts

_ASSIGNED = r"^[ \t]*{}[ \t]*(?::[^=\n]*)?=[ \t]*"
_WORD = re.compile(r"[A-Za-z_]\w*")
_JOINED = re.compile(
    r"(?<!\w)(?:FindPackage\w*|get_package_\w+)\(\s*['\"]([\w.-]+)['\"]\s*\)(?:\s*,\s*(?P<parts>(?:['\"][^'\"\n]*['\"]\s*,\s*)*)|"
    r"\s*\+\s*)['\"]\Z"
)
_IN_PATH = re.compile(r"\$\(find-pkg-share ([\w.-]+)\)/([^\s'\"]*)\Z")


def is_launch_text(workspace: Workspace, path: str) -> bool:
    """Return whether a launch file is a program or YAML, or has tags without a tree."""
    view = workspace.view(path) if path.endswith(".xml") else None
    if view is None:
        return path.endswith(ENDINGS)
    return view.tree.for_other_launcher or (view.tree.root is None and "$(var " in view.tree.source.text)


def describe_text(workspace: Workspace, path: str, offset: int) -> tuple[str, Span] | None:
    """Markdown about the name or the expression at a place, with its value where the file is started alone."""
    source = workspace.source(path)
    written = find_written(source, offset)
    if written is not None and written.kind in ("arg", "passed"):
        for step in _arguments(workspace, source, written):
            return _describe_argument(step), written.span
        return f"argument `{written.name}` is not declared", written.span
    if written is not None and written.kind in ("package", "program"):
        verb = "package in" if written.kind == "package" else "runs"
        found = _folders(written, workspace) if written.kind == "package" else _programs(source, written, workspace)
        return ("\n".join(f"{verb} `{each}`" for each in found), written.span) if found else None
    if written is not None and (files := _files(workspace, written)):
        return "\n".join(f"`{each}`" for each in files), written.span
    return _describe_value(workspace, source, offset)


def _describe_value(workspace: Workspace, source: SourceFile, offset: int) -> tuple[str, Span] | None:
    """The value of the smallest substitution or expression around a place, or of the variable at it."""
    spans: list[tuple[int, Span, str]] = []
    assigned = _assigned_at(source, offset)
    for step in _steps(workspace, source.path):
        span = move_span(step.origin.span, source) if isinstance(step, ValueStep) and not step.origin.includes else None
        if span is None or not isinstance(step, ValueStep):
            continue
        if span.start <= offset <= span.end:
            spans.append((span.end - span.start, span, step.value))
        elif assigned is not None and span.start == assigned[1]:
            spans.append((span.end - span.start, assigned[0], step.value))
    if not spans:
        return None
    _, place, value = min(spans, key=lambda each: each[0])
    return f"value: `{value}`", place


def _assigned_at(source: SourceFile, offset: int) -> tuple[Span, int] | None:
    """Return the variable at an offset of a program, and the offset of what is assigned to it."""
    if not source.path.endswith(".py"):
        return None
    line = source.position(offset).line
    start = source.offset_of_line(line)
    for word in _WORD.finditer(source.line(line)):
        if word.start() <= offset - start <= word.end():
            found = re.search(_ASSIGNED.format(word[0]), source.text, re.MULTILINE)
            span = Span(source, start + word.start(), start + word.end())
            return (span, found.end()) if found is not None else None
    return None


def define_text(workspace: Workspace, path: str, offset: int) -> list[Span]:
    """The declaration of the name at a place, or the top of the file that it names."""
    source = workspace.source(path)
    written = find_written(source, offset)
    if written is None:
        return []
    if written.kind in ("arg", "passed"):
        spans = [step.origin.span for step in _arguments(workspace, source, written)]
        return [moved for span in spans if (moved := move_span(span, workspace.source(span.file.path))) is not None]
    if written.kind == "package":
        files = [f"{folder}/package.xml" for folder in _folders(written, workspace)]
    else:
        files = _programs(source, written, workspace) if written.kind == "program" else _files(workspace, written)
    return [Span(SourceFile(each, ""), 0, 0) for each in files]


def refer_text(workspace: Workspace, path: str, offset: int) -> list[Span]:
    """The places of the argument at a place, over the workspace."""
    source = workspace.source(path)
    written = find_written(source, offset)
    if written is None or written.kind not in ("arg", "passed"):
        return []
    file = declaring_file(workspace, source, written)
    return [each.span for each in find_argument_texts(file, written.name, workspace.views)] if file else []


def declaring_file(workspace: Workspace, source: SourceFile, written: WrittenName) -> str | None:
    """Return the file whose argument is named at a place."""
    if written.kind == "arg":
        return source.path
    return next((each.file for each in _includes(workspace, source, written.around)), None)


def complete_text(workspace: Workspace, path: str, offset: int) -> list[Candidate]:
    """The candidates at a place, best first."""
    source = workspace.source(path)
    written = find_written(source, offset)
    if written is None and path.endswith(".py"):
        return [
            Candidate(each.name, "attribute", each.name if each.is_assigned else f"{each.name}=", each.span.start,
                      each.span.end, "required" if each.is_required else "", each.help)
            for each in find_keywords(source, offset)
        ]  # fmt: skip
    if written is None:
        return []
    start, end = written.span.start, max(written.span.end, offset)
    begin = source.text[start:offset]
    if written.kind == "package":
        found = complete_packages(begin, workspace.world)
        return [Candidate(each.text, "package", each.text, start, end) for each in found]
    if written.kind == "program":
        names: set[str] = set()
        with suppress(PackageNotFound, OSError, ValueError):
            names.update(workspace.world.executable_names(find_package_near(source, written)))
        return [Candidate(each, "program", each, start, end) for each in sorted(names) if each.startswith(begin)]
    if written.kind == "text":
        return list(_complete_path(source, start, offset, end, workspace))
    file = declaring_file(workspace, source, written)
    steps = [step for step in _steps(workspace, path) if isinstance(step, ArgumentStep)]
    known = {each.name: each for each in reversed(steps) if each.origin.span.file.path == file}
    return [
        Candidate(name, "argument", name, start, end, _help(step), step.doc)
        for name, step in sorted(known.items())
        if name.startswith(begin)
    ]


def _complete_path(source: SourceFile, start: int, offset: int, end: int, workspace: Workspace) -> Iterator[Candidate]:
    joined = _JOINED.search(source.text, max(start - 500, 0), start)
    inside = _IN_PATH.search(source.text, max(start - 100, 0), offset)
    if joined is not None:
        parts = re.findall(r"['\"]([^'\"]*)['\"]", joined["parts"] or "")
        package, written = joined[1], "/".join((*parts, source.text[start:offset].lstrip("/")))
    elif inside is not None:
        package, written = inside[1], inside[2]
    else:
        return
    folder, _, begin = written.rpartition("/")
    with suppress(PackageNotFound, OSError, ValueError):
        top = "/".join(filter(None, (workspace.world.find_package(package), folder)))
        for name in workspace.world.list_folder(top):
            if name.startswith(begin):
                is_file = workspace.world.is_file(f"{top}/{name}")
                insert = name if is_file else f"{name}/"
                kind = "file" if is_file else "folder"
                yield Candidate(insert, kind, insert, offset - len(begin), end, more=not is_file)  # type: ignore[arg-type]


def _help(step: ArgumentStep) -> str:
    return "required" if step.kind == "required" else f"default {step.value!r}"


def _describe_argument(step: ArgumentStep) -> str:
    choices = f"one of {', '.join(step.choices)}" if step.choices else ""
    value = f"value: `{step.value}`" if step.value is not None else ""
    head = f"**{step.name}**" + (" (required)" if step.kind == "required" else "")
    return "\n\n".join(filter(None, (head, step.doc, choices, value)))


def _steps(workspace: Workspace, path: str) -> Iterable[object]:
    view = workspace.view(path)
    return [step for case in workspace.cases(view) for step in case[2]] if view is not None else []


def _arguments(workspace: Workspace, source: SourceFile, written: WrittenName) -> list[ArgumentStep]:
    file = declaring_file(workspace, source, written)
    steps = (each for each in _steps(workspace, source.path) if isinstance(each, ArgumentStep))
    return [each for each in steps if each.name == written.name and each.origin.span.file.path == file][:1]


def _includes(workspace: Workspace, source: SourceFile, start: int) -> Iterator[IncludeSpec]:
    view = workspace.view(source.path)
    for _, plan, _ in workspace.cases(view) if view is not None else ():
        for include in plan.includes:
            span = move_span(include.origin.span, source) if not include.origin.includes else None
            if span is not None and span.start == start:
                yield include


def _folders(written: WrittenName, workspace: Workspace) -> list[str]:
    with suppress(PackageNotFound, OSError, ValueError):
        return [workspace.world.find_package(written.name)]
    return []


def _programs(source: SourceFile, written: WrittenName, workspace: Workspace) -> list[str]:
    with suppress(PackageNotFound, OSError, ValueError):
        return list(workspace.world.find_executables(find_package_near(source, written), written.name))
    return []


def _files(workspace: Workspace, written: WrittenName) -> list[str]:
    """The files of the plan whose paths end as a text does."""
    end = written.name.rpartition(")")[2].lstrip("/")
    view = workspace.view(written.span.file.path)
    found: dict[str, None] = {}
    for _, plan, trace in workspace.cases(view) if view is not None and "." in end else ():
        sources = (each for node in plan.nodes for each in node.sources)
        paths = [each.file for each in plan.includes]
        paths += [each.path for each in sources if isinstance(each, ParameterFile)]
        paths += [each.value for each in trace if isinstance(each, ValueStep)]
        paths += [each.value for each in trace if isinstance(each, ArgumentStep) and each.value]
        found.update(dict.fromkeys(path for path in paths if path.endswith(f"/{end}")))
    return [path for path in found if workspace.world.is_file(path)]
