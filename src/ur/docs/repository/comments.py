"""Documentation in launch files and programs: summary, overview, needs, arguments, what a program starts."""

import inspect
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from ur.check.queries.layout import comments_after, heading_of
from ur.check.rule import LaunchView
from ur.launchfile.syntax import Comment, Element
from ur.source.file import SourceFile

_COMMAND = re.compile(r"^[^#\n]*\b(?:ros)?launch\b(?:[^\n]*\\\n)*[^\n]*", re.MULTILINE)
_FILE = re.compile(r"(?<![\w.*$}])((?:[\w./-]{0,100}/)?[\w-]+\.launch(?:\.xml)?)(?![\w.])")
_ARGUMENT = re.compile(r"(?<![\w$])(\w+):=(\"[^\"\n]*\"|'[^'\n]*'|[^\s\"';|&]+)")
_HEADING = re.compile(r"##\s*(\w+):\s?(.*)")


@dataclass(frozen=True, slots=True)
class LaunchCall:
    """A line that starts a launch file: the file's name as written, the word before it, and the arguments given."""

    file: str
    before: str
    given: tuple[tuple[str, str], ...]


def read_headings(source: SourceFile) -> Mapping[str, str]:
    """Return `##Summary: ...`, `##Overview: ...` and the `##` lines that follow each, as Markdown by heading."""
    found: dict[str, list[str]] = {}
    current: list[str] | None = None
    for line in source.text.splitlines():
        heading = _HEADING.match(line)
        if heading:
            current = found.setdefault(heading.group(1), [heading.group(2)])
        elif line.startswith("##") and current is not None:
            current.append(line.removeprefix("##").removeprefix(" "))
        else:
            current = None
    return {name: clean_markdown("\n".join(lines)) for name, lines in found.items()}


def find_starts(source: SourceFile) -> tuple[LaunchCall, ...]:
    """Return the launch files that a program names where it runs roslaunch or `ur launch`."""
    starts = []
    for command in _COMMAND.finditer(source.text):
        text = command.group().replace("\\\n", " ")
        file = _FILE.search(text)
        if file is None:
            continue
        words = text[: file.start()].split()
        given = tuple(
            (name, value.strip("\"'")) for name, value in _ARGUMENT.findall(text[file.end() :]) if "$" not in value
        )
        starts.append(LaunchCall(file.group(1), words[-1].strip("\"'") if words else "", given))
    return tuple(dict.fromkeys(starts))


_LEGAL = re.compile(r"copyright|licen[sc]e|all rights reserved", re.IGNORECASE)
_NO_PROSE = re.compile(r"\s*(?:<|ur:|vim:|-\*-)|[^\w]*\Z")
_SENTENCE = re.compile(r"(.+?[.!?])(?:\s|\Z)", re.DOTALL)
_LONG = 160


def find_summary(view: LaunchView) -> str:
    """Return `<!--Summary: ...-->` as one line; else the first sentence of the first prose comment; else nothing."""
    for comment in _outer_comments(view):
        heading = heading_of(comment)
        if heading and heading[0] == "Summary":
            return " ".join(heading[1].split())
    prose = _first_prose(view)
    sentence = _SENTENCE.match(prose)
    text = " ".join((sentence.group(1) if sentence else prose).split())
    return text if len(text) <= _LONG else text[: _LONG - 4].rsplit(" ", 1)[0] + " ..."


def find_overview(view: LaunchView) -> str:
    """Return the Markdown of `<!--Overview: ...-->`, without indentation; else the first prose comment."""
    for comment in _outer_comments(view):
        title, colon, text = comment.text.partition(":")
        if colon and title.strip() == "Overview":
            return clean_markdown(text)
    return clean_markdown(_first_prose(view))


def find_needs(view: LaunchView) -> tuple[str, ...]:
    """Return the words of `<!--Needs: lidar-->`."""
    for comment in _outer_comments(view):
        heading = heading_of(comment)
        if heading and heading[0] == "Needs":
            return tuple(heading[1].replace(",", " ").split())
    return ()


def find_argument_doc(element: Element, launch: Element) -> str:
    """Return the Markdown of the comment `<!--name: ...-->` after an `<arg>`, else of its `doc=`."""
    text = find_argument_comment(element, launch)
    return clean_markdown(element.attributes.get("doc", "")) if text is None else text


def find_argument_comment(element: Element, launch: Element) -> str | None:
    """Return the text of the comment after an `<arg>` that documents it; None if there is none."""
    for comment in comments_after(launch, element):
        title, colon, text = comment.text.partition(":")
        if colon and title.strip() == element.attributes.get("name") and text.strip():
            return clean_markdown(text)
    return None


def clean_markdown(text: str) -> str:
    """Return a text without the indentation in its file."""
    return inspect.cleandoc(text.expandtabs()).strip()


def _outer_comments(view: LaunchView) -> Iterator[Comment]:
    launch = view.tree.launch
    yield from view.tree.comments
    if launch is not None:
        yield from launch.comments


def _first_prose(view: LaunchView) -> str:
    # Comments before the first tag; later ones describe the tag that follows them.
    launch = view.tree.launch
    candidates = list(view.tree.comments)
    for child in launch.children if launch is not None else ():
        if not isinstance(child, Comment):
            break
        candidates.append(child)
    first = launch.start if launch is not None else 0
    for comment in candidates:
        before = comment.span.start < first or (launch is not None and comment.span.start < launch.end)
        if before and heading_of(comment) is None and not _LEGAL.search(comment.text) and _is_prose(comment.text):
            return comment.text.strip()
    return ""


def _is_prose(text: str) -> bool:
    return not _NO_PROSE.match(text) and len(text.split()) >= 3
