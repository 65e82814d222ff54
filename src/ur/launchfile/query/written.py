"""Names in launch files as they are written: found in the text, which may be half typed."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from ur.launchfile.load import describe_call
from ur.source.file import SourceFile, Span

WrittenKind = Literal["arg", "passed", "package", "program", "text"]
ENDINGS = (".py", ".launch.yaml", ".launch.yml", "_launch.yaml", "_launch.yml")
"""Endings of the names of launch files that are programs or YAML."""

_LITERAL = re.compile(r"""(?P<quote>['"])(?P<text>(?:\\.|(?!(?P=quote))[^\\\n])*)(?P=quote)?""")
_PIECE = re.compile(r"\$\((?P<command>[a-z-]+) +['\"]?(?P<name>[\w.-]*)")
_SCALAR = re.compile(r"(?<![\w-])(?P<key>[\w-]+):\s*['\"]?(?P<text>(?:\$\([^)\n]*\)?|[^\s'\"#])*)")
_ATTRIBUTE = re.compile(r"(?<![\w-])(?P<key>[\w-]+)\s*=\s*(?P<quote>['\"])(?P<text>[^'\"\n]*)")
_TAG = re.compile(r"<(/?)([a-z_-]+)[^<>]*?(/?)(?:>|\Z)")
_BEFORE: tuple[tuple[WrittenKind, re.Pattern[str]], ...] = (
    ("arg", re.compile(r"\b(?:DeclareLaunchArgument|LaunchConfig\w*)\(\s*(?:(?:variable_)?name\s*=\s*)?\Z")),
    ("arg", re.compile(r"\blaunch_configurations\s*(?:\[|\.get\()\s*\Z")),
    ("package", re.compile(r"\b(?:FindPackage\w*|get_package_\w+)\(\s*(?:package(?:_name)?\s*=\s*)?\Z")),
    ("package", re.compile(r"\bpackage\s*=\s*\Z")),
    ("program", re.compile(r"\bexecutable\s*=\s*\Z")),
)
_PASSED = re.compile(r"\blaunch_arguments\s*=\s*(?:dict\()?[\[{][^\]}]*\Z")
_COMMANDS: dict[str, WrittenKind] = {"var": "arg", "find-pkg-share": "package", "find-pkg-prefix": "package"}
_KEYS: dict[str, WrittenKind] = {"pkg": "package", "exec": "program"}
_HIDDEN = re.compile(rf"#[^\n]*|{_LITERAL.pattern}")
_NEAR = 3_000  # characters of one call


@dataclass(frozen=True, slots=True)
class WrittenName:
    """A name at a place. `around` is the offset of the include that passes it, or of the call that it belongs to."""

    kind: WrittenKind
    span: Span
    around: int = -1

    @property
    def name(self) -> str:
        """The name as it is written."""
        return self.span.text


def find_written(source: SourceFile, offset: int) -> WrittenName | None:
    """Return the name at an offset; None outside of texts."""
    if source.path.endswith(".py"):
        return _in_program(source, offset)
    number = source.position(offset).line
    start, line = source.offset_of_line(number), source.line(number)
    for found in _PIECE.finditer(line):
        first, last = start + found.start("name"), start + found.end("name")
        if first <= offset <= last and found["command"] in _COMMANDS:
            return WrittenName(_COMMANDS[found["command"]], Span(source, first, last))
    is_yaml = source.path.endswith(ENDINGS)
    for found in (_SCALAR if is_yaml else _ATTRIBUTE).finditer(line):
        span = Span(source, start + found.start("text"), start + found.end("text"))
        if span.start <= offset <= span.end:
            around = list(_parents(source, number) if is_yaml else _tags_around(source.text, span.start))
            key = found["key"]
            if key == "name" and around and around[0][0] in ("arg", "let"):
                include = next((at for name, at in around if name == "include"), None)
                return WrittenName("arg", span) if include is None else WrittenName("passed", span, include)
            return WrittenName(_KEYS.get(key, "text"), span, around[0][1] if around else -1)
    return None


def find_names(source: SourceFile, name: str) -> Iterator[WrittenName]:
    """Yield all places of an argument: where it is declared or used, and where it is passed."""
    for found in re.finditer(rf"(?<![\w]){re.escape(name)}(?![\w])", source.text):
        written = find_written(source, found.start())
        if written is not None and written.kind in ("arg", "passed") and written.name == name:
            yield written


def find_package_near(source: SourceFile, place: WrittenName) -> str:
    """Return the package of the node whose program is at a place; empty where it is not written as a text."""
    if source.path.endswith(".py"):
        near = source.text[max(place.around, 0) : place.span.end + _NEAR]
        found = re.search(r"\bpackage\s*=\s*['\"]([\w.-]+)", near.partition("executable")[0] or near)
        found = found or re.search(r"\A[^()]*?\bpackage\s*=\s*['\"]([\w.-]+)", source.text[place.span.end :][:_NEAR])
    else:
        near = source.text[max(place.around, 0) :][:_NEAR]
        found = re.search(r"\bpkg[:=]\s*['\"]?([\w.-]+)", near)
    return found[1] if found else ""


def _in_program(source: SourceFile, offset: int) -> WrittenName | None:
    line = source.position(offset).line
    start = source.offset_of_line(line)
    for found in _LITERAL.finditer(source.line(line)):
        first, last = start + found.start("text"), start + found.end("text")
        if first <= offset <= last:
            span = Span(source, first, last)
            before = source.text[max(first - _NEAR, 0) : first - 1].rstrip("rfbRFB")
            for kind, pattern in _BEFORE:
                if pattern.search(before):
                    return WrittenName(kind, span, _call_before(source.text, first))
            if _PASSED.search(before) and _is_key(before.rstrip(), source.line(line)[found.end() :].strip()):
                return WrittenName("passed", span, source.text.rfind("IncludeLaunchDescription", 0, first))
            return WrittenName("text", span, _call_before(source.text, first))
    return None


@dataclass(frozen=True, slots=True)
class Keyword:
    """An argument that a call may have. `span` is what is typed of it; `is_assigned`: a `=` follows."""

    name: str
    is_required: bool
    help: str
    span: Span
    is_assigned: bool


def find_keywords(source: SourceFile, offset: int) -> list[Keyword]:
    """Return the arguments that the call around an offset of a program may have beyond those that it has."""
    begin = max(offset - _NEAR, 0)
    text = _HIDDEN.sub(
        lambda found: (" " if found[0][0] == "#" else '"') * len(found[0]), source.text[begin : offset + _NEAR]
    )
    word = re.search(r"(?<!\w)\w*\Z", text[: offset - begin])
    start = word.start() if word is not None else offset - begin
    opened = _bracket_before(text, start)
    called = re.search(r"(?<!\w)(\w+)\s*\Z", text[: max(opened, 0)])
    known = describe_call(called[1]) if called is not None else {}
    if not known or text[:start].rstrip()[-1:] not in ("(", ","):
        return []
    rest = re.search(r"\A(\w*)(\s*=(?!=))?", text[offset - begin :])
    assert rest is not None
    given = set(re.findall(r"(?<!\w)(\w+)\s*=(?!=)", _outer(text[opened + 1 :])))
    typed = source.text[begin + start : offset]
    span = Span(source, begin + start, offset + len(rest[1]))
    return [
        Keyword(name, is_required, about, span, rest[2] is not None)
        for name, (is_required, about) in sorted(known.items(), key=lambda each: (not each[1][0], each[0]))
        if name.startswith(typed) and name not in given
    ]


def _bracket_before(text: str, offset: int) -> int:
    """Return the innermost bracket around an offset if it opens a call; -1 for any other."""
    depth = 0
    for at in range(offset - 1, -1, -1):
        if text[at] in ")]}":
            depth += 1
        elif text[at] in "([{":
            if depth == 0:
                return at if text[at] == "(" else -1
            depth -= 1
    return -1


def _outer(text: str) -> str:
    """Return the text up to the bracket that closes, without what is in brackets."""
    depth, kept = 0, []
    for each in text:
        depth += (each in "([{") - (each in ")]}")
        if depth < 0:
            break
        kept.append(each if depth == 0 else " ")
    return "".join(kept)


def _is_key(before: str, after: str) -> bool:
    """Return whether a text in a dict or list of pairs is a key: by what is around it, which may be half typed."""
    return after.startswith(":") or re.search(r"(?<!\w)\(\Z", before) is not None or (not after and before[-1] in "{,")


def _call_before(text: str, offset: int) -> int:
    """Return where the innermost call around an offset begins, by its brackets."""
    depth = 0
    for at in range(offset - 1, max(offset - _NEAR, -1), -1):
        if text[at] == ")":
            depth += 1
        elif text[at] == "(":
            if depth == 0:
                return at
            depth -= 1
    return -1


def _tags_around(text: str, offset: int) -> Iterator[tuple[str, int]]:
    """Yield the tags around an offset in XML, innermost first, with their offsets."""
    opened: list[tuple[str, int]] = []
    for found in _TAG.finditer(text[:offset]):
        if found[1]:
            while opened and opened.pop()[0] != found[2]:
                pass
        elif not found[3]:
            opened.append((found[2], found.start()))
    yield from reversed(opened)


def _parents(source: SourceFile, number: int) -> Iterator[tuple[str, int]]:
    """Yield the keys around a line, innermost first, with their offsets."""
    line = source.line(number)
    depth = len(line) - len(line.lstrip(" -"))
    for above in range(number - 1, 0, -1):
        line = source.line(above)
        found = re.match(r"[ -]*(?P<key>[\w-]+):\s*(?:#.*)?\Z", line)
        indent = len(line) - len(line.lstrip(" -"))
        if found and indent < depth:
            yield found["key"], source.offset_of_line(above) + found.start("key")
            depth = indent
