"""Comments that suppress a finding, with a reason, and safe fixes of findings."""

import re
from collections.abc import Iterable, Iterator, Mapping
from typing import NamedTuple

from ur.check.rule import Rule, TextEdit
from ur.launchfile.syntax import Comment, Element, LaunchFile
from ur.source.diagnostic import Diagnostic
from ur.source.file import SourceFile, Span


class Repair(NamedTuple):
    """A file's new text, and the findings that it fixes."""

    path: str
    text: str
    findings: tuple[Diagnostic, ...]


def plan_repairs(findings: Iterable[Diagnostic], rules: Mapping[str, Rule]) -> list[Repair]:
    """Plan new texts for the files with fixable findings. Of two overlapping edits, the first is made."""
    edits: dict[str, list[tuple[TextEdit, Diagnostic]]] = {}
    for found in findings:
        rule = rules.get(found.rule)
        if rule is not None and rule.fix is not None and found.span is not None:
            for edit in rule.fix(found):
                edits.setdefault(edit.span.file.path, []).append((edit, found))
    return [_apply(path, group) for path, group in sorted(edits.items())]


def _apply(path: str, edits: list[tuple[TextEdit, Diagnostic]]) -> Repair:
    edits.sort(key=lambda pair: pair[0].span.start)
    source = edits[0][0].span.file.text
    parts, position, done = [], 0, []
    for edit, found in edits:
        if edit.span.start < position:
            continue
        parts += [source[position : edit.span.start], edit.text]
        position = edit.span.end
        done.append(found)
    return Repair(path, "".join(parts) + source[position:], tuple(done))


_XML = re.compile(r"\s*ur:\s*(.*?)\s*\Z", re.DOTALL)
_LINE = re.compile(r"#\s*ur:\s*([^\n]*)")
_WORDS = re.compile(r"(ignore|ignore-file)\s+([\w-]+(?:\s*,\s*[\w-]+)*)\s*(?::\s*(.*))?\Z", re.DOTALL)


class Suppression(NamedTuple):
    """A comment that hides findings of `rules` between two offsets of its file (None: in the whole file).

    A comment with a `problem` is invalid, and hides nothing.
    """

    span: Span
    rules: tuple[str, ...]
    start: int | None
    end: int
    reason: str
    problem: str | None = None


class Suppressions:
    """The suppressions of all files, and those that hid a finding."""

    def __init__(self, by_path: Mapping[str, tuple[Suppression, ...]]) -> None:
        self.by_path = by_path
        self.used: set[tuple[str, int, str]] = set()

    def hides(self, found: Diagnostic) -> bool:
        """Return whether a comment hides a finding, and record its use."""
        if found.span is None:
            return False
        hidden = False
        for each in self.by_path.get(found.span.file.path, ()):
            inside = each.start is None or each.start <= found.span.start < each.end
            if inside and not each.problem and found.rule in each.rules:
                self.used.add((found.span.file.path, each.span.start, found.rule))
                hidden = True
        return hidden

    def unused(self) -> Iterator[tuple[Suppression, str]]:
        """Yield comments that hid nothing, with the rule they name."""
        for path, suppressions in self.by_path.items():
            for each in suppressions:
                for rule in () if each.problem else each.rules:
                    if (path, each.span.start, rule) not in self.used:
                        yield each, rule


def read_xml_suppressions(tree: LaunchFile) -> tuple[Suppression, ...]:
    """Read the comments of a launch file.

    `<!--ur: ignore RULE: REASON-->` applies to the element that follows, `ignore-file` to the whole file.
    """
    found = [each for comment in tree.comments for each in _read_comment(comment, 0, len(tree.source.text))]
    stack = [tree.root] if tree.root is not None else []
    while stack:
        element = stack.pop()
        stack.extend(element.elements)
        for index, child in enumerate(element.children):
            if isinstance(child, Comment):
                following = next((each for each in element.children[index:] if isinstance(each, Element)), None)
                start, end = (following.start, _end_of(following)) if following else (child.span.end, element.end)
                found.extend(_read_comment(child, start, end))
    return tuple(sorted(found, key=lambda each: each.span.start))


def _end_of(element: Element) -> int:
    return max(element.end, element.tag_span.end)


def read_line_suppressions(source: SourceFile) -> tuple[Suppression, ...]:
    """Read the comments of a YAML file or program.

    `# ur: ignore RULE: REASON` applies to its own line; alone on a line, to the next one.
    """
    if "ur:" not in source.text:
        return ()
    found: list[Suppression] = []
    for match in _LINE.finditer(source.text):
        line = source.position(match.start()).line
        alone = not source.text[: match.start()].rpartition("\n")[2].strip()
        start = _line_start(source, line + 1 if alone else line)
        end = _line_start(source, line + 2 if alone else line + 1)
        found.extend(_read(match.group(1), Span(source, *match.span()), start, end))
    return tuple(found)


def _line_start(source: SourceFile, line: int) -> int:
    offset = 0
    for _ in range(line - 1):
        offset = source.text.find("\n", offset) + 1
        if offset == 0:
            return len(source.text) + 1
    return offset


def _read_comment(comment: Comment, start: int, end: int) -> Iterable[Suppression]:
    match = _XML.match(comment.text)
    return _read(match.group(1), comment.span, start, end) if match else ()


def _read(text: str, span: Span, start: int, end: int) -> Iterator[Suppression]:
    match = _WORDS.match(text.strip())
    if match is None:
        yield Suppression(span, (), start, end, "", "expected 'ignore RULE: REASON' or 'ignore-file RULE: REASON'")
        return
    rules = tuple(word.strip() for word in match.group(2).split(","))
    reason = (match.group(3) or "").strip()
    problem = None if reason else "no reason is given, expected 'ignore RULE: REASON'"
    yield Suppression(span, rules, None if match.group(1) == "ignore-file" else start, end, reason, problem)
