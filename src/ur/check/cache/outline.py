"""Outlines of launch files: the data that a check needs of a file with stored findings, so that it is not parsed."""

from dataclasses import dataclass

from ur.check.findings.suppress import Suppression, read_line_suppressions, read_xml_suppressions
from ur.check.inclusion import IncludeTag, list_include_tags, list_named_files
from ur.check.rule import LaunchView
from ur.source.file import SourceFile, Span
from ur.source.foreign.json_values import Count, ForeignValue


@dataclass(frozen=True, slots=True)
class IncludeOutline:
    """The `<include>` tags of a launch file, and the comments that hide findings."""

    source: SourceFile
    includes: tuple[IncludeTag, ...]
    comments: tuple[Suppression, ...]


class KeptComment(ForeignValue, frozen=True, array_like=True):
    """A suppression; `place` is its span."""

    place: tuple[Count, Count]
    rules: tuple[str, ...]
    start: Count | None
    end: Count
    reason: str
    problem: str | None


class KeptOutline(ForeignValue, frozen=True, array_like=True):
    """An outline; `digest` is that of the file's content."""

    digest: str
    includes: tuple[IncludeTag, ...]
    comments: tuple[KeptComment, ...]


def outline_of(view: LaunchView) -> IncludeOutline:
    """Return the outline of a launch file, which is parsed for it."""
    tree = view.tree
    comments = read_xml_suppressions(tree) if tree.root is not None else read_line_suppressions(tree.source)
    tags = list_named_files(tree.source) if tree.launch is None else list_include_tags(view)
    return IncludeOutline(tree.source, tuple(tags), comments)


def encode_outline(outline: IncludeOutline, digest: str) -> KeptOutline:
    """Encode an outline for storage."""
    comments = (
        KeptComment((each.span.start, each.span.end), each.rules, each.start, each.end, each.reason, each.problem)
        for each in outline.comments
    )
    return KeptOutline(digest, outline.includes, tuple(comments))


def decode_outline(kept: KeptOutline, source: SourceFile) -> IncludeOutline:
    """Decode the outline that `encode_outline` has encoded. Raises ValueError for positions outside of the text."""
    places = [*((tag.start, tag.end) for tag in kept.includes), *(each.place for each in kept.comments)]
    if not all(start <= end <= len(source.text) for start, end in places):
        raise ValueError("a place outside of its text")
    comments = (
        Suppression(Span(source, *each.place), each.rules, each.start, each.end, each.reason, each.problem)
        for each in kept.comments
    )
    return IncludeOutline(source, kept.includes, tuple(comments))
