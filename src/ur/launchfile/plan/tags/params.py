"""`<param>` and `<rosparam>`."""

import errno

from ur.launchfile.plan.draft import Draft
from ur.launchfile.plan.names import canonical_name, is_private, join_names
from ur.launchfile.plan.problems import SPECIAL, TagRefused, refuse
from ur.launchfile.plan.scope import Scope
from ur.launchfile.plan.specs import Origin, ParamCommand, ParamSpec, ParamType, ParamValue
from ur.launchfile.plan.tags.attributes import (
    as_flag,
    check_attributes,
    explain_problem,
    missing_attribute,
    read_optional,
    resolve_value,
)
from ur.launchfile.plan.values.budget import Budget
from ur.launchfile.plan.values.convert import TYPE_NAMES, convert_scalar, read_type
from ur.launchfile.plan.values.substitute import substitute
from ur.launchfile.plan.values.yaml_values import Document, YamlProblem, read_yaml, read_yaml_once
from ur.launchfile.syntax import Element, SubstitutionProblem
from ur.source.file import SourceFile, Span
from ur.source.suggest import did_you_mean, suggest

PARAM_ATTRIBUTES = ("name", "value", "type", "textfile", "binfile", "command")
ROSPARAM_ATTRIBUTES = ("command", "ns", "file", "param", "subst_value")
_SOURCES = ("value", "textfile", "binfile", "command")
_LISTED = 8  # files of a folder that a message names


def resolve_param(element: Element, draft: Draft, scope: Scope, *, force_private: bool = False) -> None:
    """Set the parameter of a `<param>`: in the plan, or in the scope of later nodes. Raises TagRefused."""
    check_attributes(element, PARAM_ATTRIBUTES, draft, scope)
    type_name = element.attributes.get("type") or "auto"
    sources = [name for name in _SOURCES if name in element.attributes]
    if len(sources) != 1:
        raise _not_one_source(element, sources)
    raw_name = element.attributes.get("name")
    if raw_name is None:
        raise missing_attribute(element, "name")
    stripped = raw_name.strip()
    shift = len(raw_name) - len(raw_name.lstrip())
    name = resolve_value(stripped, element, "name", draft, scope, shift) if "$" in stripped else stripped
    type_ = read_type(type_name)
    source = sources[0]
    if type_ is None and source != "binfile":
        raise refuse(
            f"'type' of <param> is '{type_name}', expected one of {', '.join(TYPE_NAMES)}",
            element.value_span("type"),
            "bad-param-type",
            suggest(type_name, TYPE_NAMES),
        )
    text = read_optional(element, source, draft, scope) or ""
    command = text if source == "command" else None
    value = None if command is not None else _value(text, source, type_ or "auto", element, draft)
    private = force_private or is_private(name)
    full_name = canonical_name(name if private else join_names(scope.namespace, name))
    param = ParamSpec(full_name, value, draft.origin(element.span, scope), command, type_ or "auto")
    if command is not None:
        draft.programs.append(param)
    if private:
        scope.add_param(param)
    else:
        draft.add_param(param, scope)


def _not_one_source(element: Element, sources: list[str]) -> TagRefused:
    if sources:
        return refuse(
            f"<param> with {' and '.join(repr(name) for name in sources)}, expected one of them",
            element.name_span(sources[1]),
            "param-value",
            f"remove all but one of {', '.join(sources)}",
        )
    near = next((near for near in (did_you_mean(name, _SOURCES) for name in element.attributes) if near), None)
    return refuse(
        "<param> without a value, expected one of value, textfile, binfile, command",
        element.span,
        "param-value",
        f"did you mean {near}?" if near else 'add value="..."',
    )


def _value(text: str, source: str, type_: ParamType, element: Element, draft: Draft) -> ParamValue:
    if source == "binfile":
        return _read_file(text, element, source, draft)
    text = _read_text(text, element, source, draft) if source == "textfile" else text.strip()
    return convert_param(text, type_, element, source, draft.reads_angles, draft.budget)


def convert_param(
    text: str, type_: ParamType, element: Element, source: str, reads_angles: bool, budget: Budget | None = None
) -> ParamValue:
    """Convert a text to a value of a `<param>`. Raises TagRefused, which points at attribute `source`."""
    if type_ == "yaml":
        try:
            return read_yaml(text, reads_angles, budget).value
        except YamlProblem as problem:
            raise refuse(f"not valid YAML: {problem}", element.value_span(source), "bad-yaml") from None
    try:
        return convert_scalar(text, type_)
    except ValueError as problem:
        shown = f"'{text}'" if len(text) < 60 else f"'{text[:57]}...'"
        name = element.attributes.get("name", "")
        raise refuse(
            f"parameter {name} of type {type_} is {shown}, {problem}",
            element.value_span(source),
            "bad-param-value",
            f"write a value of type {type_}, or leave type away",
            kind=type_,
        ) from None


def _read_file(path: str, element: Element, attribute: str, draft: Draft) -> bytes:
    try:
        return draft.world.read_bytes(path)
    except OSError as problem:
        raise missing_file(path, problem, element, attribute, draft) from None


def missing_file(path: str, problem: OSError, element: Element, attribute: str, draft: Draft) -> TagRefused:
    """Return the exception for an unreadable file, with a similar name, or one in that folder."""
    reason = (problem.strerror or str(problem)).lower()
    folder, _, name = path.rpartition("/")
    near = did_you_mean(name, (each for each in draft.world.list_folder(folder or ".") if each != name))
    inside = sorted(draft.world.list_folder(path)) if path else []  # where it is a folder
    special = problem.errno == errno.EINVAL and not inside
    if 0 < len(inside) <= _LISTED:
        help_ = f"it contains {', '.join(inside)}"
    elif near and not special:
        help_ = f"did you mean {folder + '/' if folder else ''}{near}?"
    else:
        help_ = "check the path, or create the file"
    return refuse(
        f"{path or 'an empty path'}: {reason}, expected a file",
        element.value_span(attribute),
        "missing-file",
        help_,
        subject=path,
        kind=SPECIAL if special else "",
    )


def _read_text(path: str, element: Element, attribute: str, draft: Draft) -> str:
    data = _read_file(path, element, attribute, draft)
    try:
        return data.decode("utf-8").replace("\r\n", "\n").replace("\r", "\n")
    except UnicodeDecodeError as problem:
        raise refuse(
            f"{path}: byte {problem.start} is not UTF-8, expected a text",
            element.value_span(attribute),
            "unreadable-file",
        ) from None


def resolve_rosparam(element: Element, draft: Draft, scope: Scope) -> None:
    """Set the parameters of a `<rosparam>`, or record its dump or delete. Raises TagRefused."""
    check_attributes(element, ROSPARAM_ATTRIBUTES, draft, scope)
    command, namespace, file, param, substitutes = (
        read_optional(element, name, draft, scope) for name in ROSPARAM_ATTRIBUTES
    )
    with_substitutions = as_flag(substitutes, element, "subst_value") if substitutes is not None else False
    name = join_names(namespace or "", param or "")
    full_name = join_names(scope.namespace, name) if name else scope.namespace
    command = command or "load"
    if command == "load":
        _load(element, file, name, full_name, with_substitutions, draft, scope)
    elif command in ("dump", "delete"):
        if command == "delete" and file is not None:
            raise refuse("<rosparam> deletes with a 'file', expected none", element.name_span("file"), "rosparam-file")
        draft.commands.append(
            ParamCommand("dump" if command == "dump" else "delete", full_name, file, draft.origin(element.span, scope))
        )
    else:
        raise refuse(
            f"'command' of <rosparam> is '{command}', expected load, dump or delete",
            element.value_span("command"),
            "bad-choice",
            suggest(command, ("load", "dump", "delete")),
            expected=("load", "dump", "delete"),
        )


def _load(
    element: Element, file: str | None, name: str, full_name: str, substitutes: bool, draft: Draft, scope: Scope
) -> None:
    text = _read_text(file, element, "file", draft) if file is not None else element.text
    written = text
    if substitutes and "$" in text:
        text = _substitute_text(text, file, element, draft, scope)
    draft.reads_angles = True
    source = SourceFile(file, text) if file is not None else None
    try:
        document = read_yaml_once(text, reads_angles=True, budget=draft.budget)
    except YamlProblem as problem:
        same = text == written
        help_ = problem.help
        offset = problem.offset
        if source is not None:
            span = Span(source, min(offset, len(source.text)), min(offset + 1, len(source.text)))
        elif same:
            start = element.text_offset(min(offset, len(element.text)))
            span = Span(element.source, start, start + 1)
        else:
            span = element.span
        raise refuse(f"not valid YAML: {problem}", span, "bad-yaml", help_) from None
    if document.value is None:
        document = Document({}, None)
    if not name and not isinstance(document.value, dict):
        kind = "a list" if isinstance(document.value, list) else "a single value"
        raise refuse(
            f"<rosparam> holds {kind} and has no 'param', expected names with values",
            element.span,
            "rosparam-not-a-mapping",
            'add param="NAME", or write NAME: VALUE',
        )
    _Unroller(document, source, element, same=text == written, draft=draft, scope=scope).add(
        full_name, document.value, ()
    )


def _substitute_text(text: str, file: str | None, element: Element, draft: Draft, scope: Scope) -> str:
    try:
        return substitute(text, scope, draft.world, draft.budget)
    except SubstitutionProblem as problem:
        if file is not None:
            span = Span(SourceFile(file, text), problem.start, problem.end)
        else:
            span = Span(element.source, element.text_offset(problem.start), element.text_offset(problem.end))
        raise explain_problem(problem, span, scope) from None


class _Unroller:
    # Turns nested mappings into single parameters; each gets the place of its key.
    def __init__(
        self, document: Document, source: SourceFile | None, element: Element, *, same: bool, draft: Draft, scope: Scope
    ) -> None:
        self.document = document
        self.source = source
        self.element = element
        self.same = same
        self.draft = draft
        self.scope = scope

    def add(self, name: str, value: ParamValue, path: tuple[str, ...]) -> None:
        if not isinstance(value, dict):
            if name == "/":
                raise refuse(
                    "'/' is set to a single value, expected names with values", self.origin(path).span, "bad-yaml-key"
                )
            self.draft.add_param(ParamSpec(canonical_name(name), value, self.origin(path)), self.scope)
            return
        if len(path) > 100:
            raise refuse("mappings nested more than 100 deep", self.origin(path).span, "nested-too-deep")
        for key, inner in value.items():
            if not isinstance(key, str):
                raise refuse(
                    f"key {key!r} of {name} is no text, expected a parameter's name",
                    self.origin((*path, key)).span,
                    "bad-yaml-key",
                    f"put it in quotes: '{key}'",
                    subject=str(key),
                )
            self.add(join_names(name, key), inner, (*path, key))

    def origin(self, path: tuple[str, ...]) -> Origin:
        start, end = self.document.place_of(path)
        if self.source is not None:
            return self.draft.origin(Span(self.source, start, end), self.scope)
        if self.same and path:
            start, end = (self.element.text_offset(offset) for offset in (start, end))
            return self.draft.origin(Span(self.element.source, start, end), self.scope)
        return self.draft.origin(self.element.span, self.scope)
