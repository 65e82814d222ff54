"""Candidates for what is typed: tags, attributes, packages, programs, files, arguments and values."""

import re
from collections.abc import Iterator
from contextlib import suppress

from ur.check.rule import LaunchView
from ur.complete.completions import Completion
from ur.complete.launch import complete_packages, complete_paths
from ur.launchfile.query.vocabulary import ATTRIBUTES, CONDITIONS, DOCUMENTS, INSIDE, REQUIRED, find_choices
from ur.launchfile.syntax.substitution import COMMANDS
from ur.launchfile.world.protocol import PackageNotFound
from ur.lsp.cursor import Candidate, CursorPosition, OpenTag, find_cursor
from ur.lsp.documents import document_of
from ur.lsp.launch_texts import complete_text, is_launch_text
from ur.lsp.names import expand_everywhere, find_files
from ur.lsp.programs.parameters import know_parameters
from ur.lsp.programs.starts import programs_of_tag
from ur.lsp.programs.yaml_keys import complete_yaml, is_yaml
from ur.lsp.workspace import Workspace

_OPEN = re.compile(r"\$\((\w*)(?:\s+([^)\s]*))?\Z")
_FOUND = re.compile(r"(\$\(find\s+([\w.-]+)\s*\)|\$\(dirname\))((?:/[^/$]*)*)\Z")


def complete(workspace: Workspace, path: str, offset: int) -> list[Candidate]:
    """The candidates at a place of a file, best first."""
    if is_launch_text(workspace, path):
        return complete_text(workspace, path, offset)
    if not path.endswith((".launch", ".xml", ".test")):
        try:
            text = workspace.source(path).text
        except OSError:
            return []
        return complete_yaml(workspace, path, text, offset) if is_yaml(path) else []
    view = workspace.view(path)
    if view is None:
        return []
    text = view.tree.source.text
    place = find_cursor(text, offset)
    if place.kind in ("tag", "text"):
        return [*_tags(place, text)]
    if place.kind == "attribute" and place.tag is not None:
        return [*_attributes(place, place.tag, text)]
    if place.kind == "value" and place.tag is not None:
        return [*_values(place, place.tag, view, workspace)]
    return []


def _tags(cursor: CursorPosition, text: str) -> Iterator[Candidate]:
    bracket = "" if text[: cursor.start].endswith("<") else "<"
    inside = cursor.inside
    if inside and not cursor.begin and bracket == "":
        yield Candidate(f"/{inside}>", "tag", f"/{inside}>", cursor.start, cursor.end, f"closes <{inside}>")
    for tag in INSIDE.get(inside, ()):
        if tag.startswith(cursor.begin):
            needed = " ".join(f'{name}=""' for name in REQUIRED.get(tag, ()))
            end = "></launch>" if tag == "launch" else "></group>" if tag == "group" else "/>"
            insert = f"{bracket}{tag}{' ' if needed else ''}{needed}{end}"
            yield Candidate(tag, "tag", insert, cursor.start, max(cursor.end, cursor.start), "", DOCUMENTS.get(tag, ""))


def _attributes(cursor: CursorPosition, tag: OpenTag, text: str) -> Iterator[Candidate]:
    written = text[cursor.end : cursor.end + 1] == "="
    known = [each for each in (*ATTRIBUTES.get(tag.name, ()), *CONDITIONS) if each.startswith(cursor.begin)]
    needed = REQUIRED.get(tag.name, ())
    for name in sorted(known, key=lambda each: each not in needed):
        if name not in tag.values or name == text[cursor.start : cursor.end]:
            insert = name if written else f'{name}=""'
            document = DOCUMENTS.get(name, "")
            yield Candidate(
                name, "attribute", insert, cursor.start, cursor.end, "required" if name in needed else "", document
            )


def _values(cursor: CursorPosition, tag: OpenTag, view: LaunchView, workspace: Workspace) -> Iterator[Candidate]:
    opened = _OPEN.search(cursor.begin)
    if opened is not None:
        yield from _substitutions(cursor, opened, view, workspace)
        return
    for choice in find_choices(tag.name, cursor.attribute):
        if choice.startswith(cursor.begin):
            yield Candidate(choice, "value", choice, cursor.start, cursor.end)
    if cursor.attribute in ("pkg", "type") and tag.name in ("node", "test"):
        yield from _programs(cursor, tag, view, workspace)
    elif tag.name == "arg" and cursor.attribute == "name" and cursor.inside == "include":
        yield from _passed(cursor, view, workspace)
    elif tag.name == "arg" and cursor.attribute == "value" and cursor.inside == "include":
        name = view.tree.source.text[slice(*tag.values.get("name", (0, 0)))]
        if name in view.declared:
            yield Candidate(f"$(arg {name})", "argument", f"$(arg {name})", cursor.start, cursor.end, "of this file")
    elif tag.name == "param" and cursor.inside in ("node", "test"):
        yield from _parameters(cursor, tag, view, workspace)
    elif cursor.attribute == "machine":
        machines = {each.name for _, plan, _ in workspace.cases(view) for each in plan.machines}
        yield from (Candidate(each, "value", each, cursor.start, cursor.end) for each in sorted(machines))
    yield from _files(cursor, view, workspace)


def _substitutions(
    cursor: CursorPosition, opened: re.Match[str], view: LaunchView, workspace: Workspace
) -> Iterator[Candidate]:
    command, word = opened.group(1), opened.group(2)
    start = cursor.start + opened.start(1)
    close = "" if view.tree.source.text[cursor.end - 1 : cursor.end] == ")" and cursor.end > start else ")"
    if word is None:
        for each in (*COMMANDS, "eval"):
            if each.startswith(command):
                yield Candidate(
                    each, "value", each if each == "dirname" else f"{each} ", start, start + len(command), more=True
                )
        return
    start = cursor.start + opened.start(2)
    end = start + len(word)
    if command == "arg":
        for name in view.declared:
            if name.startswith(word):
                yield Candidate(name, "argument", f"{name}{close}", start, end, "", document_of(name, view))
    elif command == "find":
        found = complete_packages(word, workspace.world)
        yield from (Candidate(each.text, "package", f"{each.text}{close}", start, end) for each in found)
    elif command in ("env", "optenv"):
        known = sorted(each for each in workspace.world.environment if each.startswith(word))
        yield from (Candidate(each, "value", f"{each}{close}", start, end) for each in known)


def _programs(cursor: CursorPosition, tag: OpenTag, view: LaunchView, workspace: Workspace) -> Iterator[Candidate]:
    if cursor.attribute == "pkg":
        found = complete_packages(cursor.begin, workspace.world)
        yield from (Candidate(each.text, "package", each.text, cursor.start, cursor.end) for each in found)
        return
    written = view.tree.source.text[slice(*tag.values.get("pkg", (0, 0)))]
    names: set[str] = set()
    for package in expand_everywhere(written, view, cursor.start, workspace):
        with suppress(PackageNotFound, OSError, ValueError):
            names.update(workspace.world.executable_names(package))
    known = sorted(each for each in names if each.startswith(cursor.begin))
    yield from (Candidate(each, "program", each, cursor.start, cursor.end) for each in known)


def _passed(cursor: CursorPosition, view: LaunchView, workspace: Workspace) -> Iterator[Candidate]:
    include = cursor.parents[-1]
    span = include.values.get("file", (0, 0))
    for file in find_files(view.tree.source.text[slice(*span)], view, span[0], workspace):
        included = workspace.view(file)
        for name, elements in included.declared.items() if included is not None else ():
            if name.startswith(cursor.begin) and not any("value" in each.attributes for each in elements):
                assert included is not None
                default = elements[0].attributes.get("default")
                help_ = "required" if default is None else f"default {default!r}"
                yield Candidate(name, "argument", name, cursor.start, cursor.end, help_, document_of(name, included))


def _parameters(cursor: CursorPosition, tag: OpenTag, view: LaunchView, workspace: Workspace) -> Iterator[Candidate]:
    node, text = cursor.parents[-1], view.tree.source.text
    written = text[slice(*tag.values.get("name", (0, 0)))].lstrip("~")
    given = set(re.findall(r"""<param[^>]{0,500}?\bname=["']~?([^"'<>]*)""", text[node.start : tag.start]))
    known = know_parameters(programs_of_tag(node, view, workspace), workspace)
    for name, found in known.items():
        values = [each for each in found.values if "$" not in each]
        if cursor.attribute == "name" and name.startswith(cursor.begin) and name not in given:
            yield Candidate(name, "attribute", name, cursor.start, cursor.end, ", ".join(values[:1]), found.document)
        elif cursor.attribute == "value" and name == written:
            fitting = (each for each in values if each.startswith(cursor.begin))
            yield from (
                Candidate(each, "value", each, cursor.start, cursor.end, "", found.document) for each in fitting
            )


def _files(cursor: CursorPosition, view: LaunchView, workspace: Workspace) -> Iterator[Candidate]:
    found = _FOUND.search(cursor.begin)
    if found is not None and found.group(3):
        folders = expand_everywhere(found.group(1), view, cursor.start, workspace)
        start = cursor.start + found.start(3)
        prefixes = [(folder, found.group(3)) for folder in folders]
    elif cursor.attribute in ("file", "textfile", "binfile") and "$" not in cursor.begin:
        start, prefixes = cursor.start, [("", cursor.begin)]
    else:
        return
    for folder, begin in prefixes:
        for each in complete_paths(f"{folder}{begin}", workspace.world, every=True):
            yield _file(each, folder, start, cursor.end)


def _file(each: Completion, folder: str, start: int, end: int) -> Candidate:
    insert = each.text.removeprefix(folder)
    name = insert.rstrip("/").rpartition("/")[2] + ("/" if each.open else "")
    return Candidate(name, "folder" if each.open else "file", insert, start, end, each.help, "", each.open)
