"""Documentation in a launch file: summary, overview, needs, and a text for each argument."""

import inspect
import re
from collections.abc import Iterator

from ur.check.queries.layout import comments_after, heading_of
from ur.check.rule import LaunchView
from ur.launchfile.syntax import Comment, Element

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
