"""Encoding and decoding of stored findings: the texts that their spans refer to are read again, not stored."""

from collections.abc import Callable, Iterable, Sequence

from ur.check.findings.merge import Hit
from ur.source.diagnostic import Diagnostic, Note, Severity
from ur.source.file import SourceFile, Span
from ur.source.foreign.json_values import Count, ForeignValue

MAX_TEXT = 100_000  # characters of texts that are in no file
ReadText = Callable[[str], SourceFile]  # the text of a file; raises OSError


class TooLargeError(ValueError):
    """Findings refer to more text outside of files than is worth storing."""


class KeptSpan(ForeignValue, frozen=True, array_like=True):
    """A span in the text with the index `source` in `KeptHits.sources`."""

    source: Count
    start: Count
    end: Count


class KeptNote(ForeignValue, frozen=True, array_like=True):
    """A note."""

    message: str
    span: KeptSpan | None


class KeptDiagnostic(ForeignValue, frozen=True, array_like=True):
    """The fields of a diagnostic, in its order."""

    severity: Severity
    message: str
    rule: str
    span: KeptSpan | None
    notes: tuple[KeptNote, ...]
    help: str | None
    subject: str
    kind: str
    expected: tuple[str, ...]
    reason: str


class KeptHit(ForeignValue, frozen=True, array_like=True):
    """A hit."""

    found: KeptDiagnostic
    root: str
    label: str
    plain: tuple[str, ...]


class KeptHits(ForeignValue, frozen=True, array_like=True):
    """The hits of a file. `sources` are paths, each with its text if that is in no file."""

    sources: tuple[tuple[str, str | None], ...]
    hits: tuple[KeptHit, ...]


def encode_hits(hits: Iterable[Hit], read: ReadText) -> tuple[KeptHits, set[str]]:
    """Encode hits, and return the paths of the files that their spans refer to. Raises TooLargeError."""
    encoder = _Encoder(read)
    kept = [KeptHit(encoder.diagnostic(hit.found), hit.root, hit.label, tuple(sorted(hit.plain))) for hit in hits]
    return KeptHits(tuple(encoder.sources), tuple(kept)), encoder.files


def decode_hits(kept: KeptHits, read: ReadText) -> list[Hit]:
    """Decode the hits that `encode_hits` has encoded.

    Raises ValueError for spans outside of their texts, and OSError.
    """
    texts = [read(path) if text is None else SourceFile(path, text) for path, text in kept.sources]
    return [Hit(_diagnostic(each.found, texts), each.root, each.label, frozenset(each.plain)) for each in kept.hits]


class _Encoder:
    def __init__(self, read: ReadText) -> None:
        self._read = read
        self._numbers: dict[int, int] = {}
        self._kept: list[SourceFile] = []  # so that no other object gets the identity of one of them
        self._room = MAX_TEXT
        self.sources: list[tuple[str, str | None]] = []
        self.files: set[str] = set()

    def diagnostic(self, found: Diagnostic) -> KeptDiagnostic:
        return KeptDiagnostic(
            found.severity,
            found.message,
            found.rule,
            self.span(found.span),
            tuple(KeptNote(note.message, self.span(note.span)) for note in found.notes),
            found.help,
            found.subject,
            found.kind,
            tuple(found.expected),
            found.reason,
        )

    def span(self, span: Span | None) -> KeptSpan | None:
        return None if span is None else KeptSpan(self.number_of(span.file), span.start, span.end)

    def number_of(self, source: SourceFile) -> int:
        if id(source) not in self._numbers:
            self._numbers[id(source)] = len(self.sources)
            self._kept.append(source)
            self.sources.append((source.path, self.text_of(source)))
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


def _diagnostic(kept: KeptDiagnostic, texts: Sequence[SourceFile]) -> Diagnostic:
    return Diagnostic(
        kept.severity,
        kept.message,
        kept.rule,
        _span(kept.span, texts),
        tuple(Note(each.message, _span(each.span, texts)) for each in kept.notes),
        kept.help,
        kept.subject,
        kept.kind,
        kept.expected,
        kept.reason,
    )


def _span(kept: KeptSpan | None, texts: Sequence[SourceFile]) -> Span | None:
    if kept is None:
        return None
    if kept.source >= len(texts) or not kept.start <= kept.end <= len(texts[kept.source].text):
        raise ValueError("a span outside of its text")
    return Span(texts[kept.source], kept.start, kept.end)
