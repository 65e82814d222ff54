"""Places, findings and changes as the protocol has them: lines from 0, columns in the units of the client."""

from collections.abc import Callable, Iterable, Sequence
from os.path import normpath
from pathlib import Path
from urllib.parse import unquote, urlsplit

from lsprotocol import types

from ur.check.rule import TextEdit
from ur.source.diagnostic import Diagnostic, Severity
from ur.source.file import SourceFile, Span

_SEVERITIES = {Severity.ERROR: types.DiagnosticSeverity.Error, Severity.WARNING: types.DiagnosticSeverity.Warning}


def path_of(uri: str) -> str | None:
    """The path of a file; None for what is no file, such as a text without a name."""
    parts = urlsplit(uri)
    return unquote(parts.path) if parts.scheme == "file" and parts.path.startswith("/") else None


def uri_of(path: str) -> str:
    """The address of an absolute path."""
    return Path(normpath(path)).as_uri()


class Units:
    """Columns as a client counts them: in UTF-16 code units, bytes of UTF-8, or characters."""

    def __init__(self, encoding: types.PositionEncodingKind | str) -> None:
        self._encoding = encoding

    def _length(self, text: str) -> int:
        if text.isascii() or self._encoding == types.PositionEncodingKind.Utf32:
            return len(text)
        if self._encoding == types.PositionEncodingKind.Utf8:
            return len(text.encode("utf-8", "surrogatepass"))
        return len(text) + sum(letter > "\uffff" for letter in text)

    def position(self, source: SourceFile, offset: int) -> types.Position:
        """The position of an offset."""
        line, column = source.position(min(offset, len(source.text)))
        return types.Position(line - 1, self._length(source.text[offset - column + 1 : offset]))

    def range(self, span: Span) -> types.Range:
        """The range of a span."""
        return types.Range(self.position(span.file, span.start), self.position(span.file, span.end))

    def offset(self, source: SourceFile, position: types.Position) -> int:
        """The offset of a position; the nearest one where there is no such line or column."""
        lines = source.text.count("\n") + 1
        if position.line >= lines:
            return len(source.text)
        start = source.offset_of_line(position.line + 1)
        text = source.line(position.line + 1)
        if text.isascii() or self._encoding == types.PositionEncodingKind.Utf32:
            return start + min(position.character, len(text))
        passed = 0
        for index, letter in enumerate(text):
            if passed >= position.character:
                return start + index
            passed += self._length(letter)
        return start + len(text)

    def location(self, span: Span, read: Callable[[str], SourceFile]) -> types.Location:
        """The place of a span; `read` gives the text of a file for spans without one."""
        if not span.file.text and span.end > 0:
            span = Span(read(span.file.path), span.start, span.end)
        return types.Location(uri_of(span.file.path), self.range(span))

    def edit(self, edit: TextEdit) -> types.TextEdit:
        """A change of a text."""
        return types.TextEdit(self.range(edit.span), edit.text)

    def edits(self, edits: Iterable[TextEdit]) -> dict[str, Sequence[types.TextEdit]]:
        """Changes by the address of their file."""
        found: dict[str, list[types.TextEdit]] = {}
        for each in edits:
            found.setdefault(uri_of(each.span.file.path), []).append(self.edit(each))
        return {uri: sorted(group, key=lambda each: each.range.start, reverse=True) for uri, group in found.items()}

    def diagnostic(self, found: Diagnostic, span: Span) -> types.Diagnostic:
        """A finding at a span."""
        notes = [
            types.DiagnosticRelatedInformation(
                types.Location(uri_of(note.span.file.path), self.range(note.span)), note.message
            )
            for note in found.notes
            if note.span is not None and note.span.file.path.startswith("/")
        ]
        plain = [note.message for note in found.notes if note.span is None]
        lines = [found.message, *plain, *([f"help: {found.help}"] if found.help else [])]
        return types.Diagnostic(
            self.range(span),
            "\n".join(lines),
            _SEVERITIES[found.severity],
            found.rule,
            source="ur",
            related_information=notes or None,
        )


def move_span(span: Span, now: SourceFile) -> Span | None:
    """A span of an earlier text in the text of now; None where it is in what has changed."""
    before, after = span.file.text, now.text
    if before == after or not before:
        return Span(now, min(span.start, len(after)), min(span.end, len(after)))
    if before[: span.end] == after[: span.end]:
        return Span(now, span.start, span.end)
    shift = len(after) - len(before)
    if span.start + shift >= 0 and before[span.start :] == after[span.start + shift :]:
        return Span(now, span.start + shift, span.end + shift)
    return None
