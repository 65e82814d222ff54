"""Findings as JSON, and back: the texts that they point into are read again instead of being kept."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from ur.check.findings.merge import Hit
from ur.source.diagnostic import Diagnostic, Note, Severity
from ur.source.file import SourceFile, Span

MAX_TEXT = 100_000  # characters of texts that are in no file
ReadText = Callable[[str], SourceFile]  # the text of a file; raises OSError

_DAMAGED = "not a finding"


class TooLargeError(ValueError):
    """Findings that point into more text that is in no file than is worth keeping."""


def encode_hits(hits: Iterable[Hit], read: ReadText) -> tuple[list[Any], set[str]]:
    """Return hits as JSON values, and the paths of the files whose texts they point into. Raises TooLargeError."""
    encoder = _Encoder(read)
    rows = [[encoder.diagnostic(hit.found), hit.root, hit.label, sorted(hit.plain)] for hit in hits]
    return [encoder.sources, rows], encoder.files


def decode_hits(value: Any, read: ReadText) -> list[Hit]:
    """Return the hits that encode_hits was given. Raises ValueError for a value that is not of its shape, and OSError.

    Nothing is taken on trust: a value may come from a damaged file.
    """
    sources, rows = _list(value, 2)
    texts = [_source(each, read) for each in _list(sources)]
    hits = []
    for row in _list(rows):
        found, root, label, plain = _list(row, 4)
        cases = frozenset(map(_text, _list(plain)))
        hits.append(Hit(_diagnostic(found, texts), _text(root), _text(label), cases))
    return hits


class _Encoder:
    def __init__(self, read: ReadText) -> None:
        self._read = read
        self._numbers: dict[int, int] = {}
        self._kept: list[SourceFile] = []  # so that no other object gets the identity of one of them
        self._room = MAX_TEXT
        self.sources: list[list[str | None]] = []
        self.files: set[str] = set()

    def diagnostic(self, found: Diagnostic) -> list[Any]:
        notes = [[note.message, self.span(note.span)] for note in found.notes]
        words = [found.severity.value, found.message, found.rule, found.help, found.subject, found.kind, found.reason]
        return [*words, list(found.expected), self.span(found.span), notes]

    def span(self, span: Span | None) -> list[int] | None:
        return None if span is None else [self.number_of(span.file), span.start, span.end]

    def number_of(self, source: SourceFile) -> int:
        if id(source) not in self._numbers:
            self._numbers[id(source)] = len(self.sources)
            self._kept.append(source)
            self.sources.append([source.path, self.text_of(source)])
        return self._numbers[id(source)]

    def text_of(self, source: SourceFile) -> str | None:
        if source.text:
            try:
                if self._read(source.path).text == source.text:
                    self.files.add(source.path)
                    return None
            except OSError:
                pass
        self._room -= len(source.text)
        if self._room < 0:
            raise TooLargeError
        return source.text


def _source(value: Any, read: ReadText) -> SourceFile:
    path, text = _list(value, 2)
    return read(_text(path)) if text is None else SourceFile(_text(path), _text(text))


def _diagnostic(value: Any, texts: list[SourceFile]) -> Diagnostic:
    severity, message, rule, help_, subject, kind, reason, expected, span, notes = _list(value, 10)
    pairs = [_list(note, 2) for note in _list(notes)]
    return Diagnostic(
        Severity(severity),
        _text(message),
        _text(rule),
        _span(span, texts),
        tuple(Note(_text(words), _span(place, texts)) for words, place in pairs),
        None if help_ is None else _text(help_),
        _text(subject),
        _text(kind),
        tuple(map(_text, _list(expected))),
        _text(reason),
    )


def _span(value: Any, texts: list[SourceFile]) -> Span | None:
    if value is None:
        return None
    number, start, end = _list(value, 3)
    if not all(type(each) is int for each in (number, start, end)) or not 0 <= number < len(texts):
        raise ValueError(_DAMAGED)
    if not 0 <= start <= end <= len(texts[number].text):
        raise ValueError(_DAMAGED)
    return Span(texts[number], start, end)


def _list(value: Any, length: int | None = None) -> list[Any]:
    if not isinstance(value, list) or (length is not None and len(value) != length):
        raise ValueError(_DAMAGED)
    return value


def _text(value: Any) -> str:
    if not isinstance(value, str):
        raise ValueError(_DAMAGED)
    return value
