"""Reuse of findings: those of an earlier check are valid if every query that led to them has the same answer.

While a launch file is checked, its queries to the world are recorded: contents of files, folders, packages, environment
variables. Its findings are stored with the queries and with digests of the answers. The next check makes the same
queries, which is cheap, and repeats the work only if an answer has changed.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterable, Mapping, Sequence, Set
from typing import NamedTuple, TypeVar

import msgspec

from ur.check.findings.merge import Hit
from ur.check.findings.suppress import Suppression, read_line_suppressions, read_xml_suppressions
from ur.check.inclusion import IncludeTag, list_include_tags, list_named_files
from ur.check.rule import LaunchView, Package
from ur.check.worlds import QUESTIONS, CachedWorld, Question
from ur.launchfile.syntax import LaunchFile
from ur.launchfile.syntax.parse import decode_text
from ur.source.file import SourceFile, Span
from ur.source.foreign.json_values import Count, ForeignValue


class IncludeOutline(NamedTuple):
    """The `<include>` tags of a launch file, and the comments that hide findings."""

    source: SourceFile
    includes: tuple[IncludeTag, ...]
    comments: tuple[Suppression, ...]


class KeptOutline(ForeignValue, frozen=True, array_like=True):
    """An encoded outline; `digest` is that of the file's content."""

    digest: str
    includes: tuple[IncludeTag, ...]
    comments: list[object]


def outline_of(view: LaunchView) -> IncludeOutline:
    """Return the outline of a launch file, which is parsed for it."""
    tree = view.tree
    comments = read_xml_suppressions(tree) if tree.root is not None else read_line_suppressions(tree.source)
    tags = list_named_files(tree.source) if tree.launch is None else list_include_tags(view)
    return IncludeOutline(tree.source, tuple(tags), comments)


Kind = TypeVar("Kind")


def _encode(values: Sequence[object], texts: dict[SourceFile, int]) -> list[object]:
    """Encode values, with an index for each text, which is added to `texts`."""
    encoded: list[object] = msgspec.to_builtins(
        values, enc_hook=lambda text: texts.setdefault(text, len(texts)), order="deterministic"
    )
    return encoded


def _decode(value: object, kind: type[Kind], texts: Sequence[SourceFile]) -> Kind:
    """Decode what `_encode` has encoded. Raises ValueError for another shape."""
    numbered = dict(enumerate(texts))
    try:
        return msgspec.convert(value, kind, dec_hook=lambda _kind, number: numbered[number])
    except (msgspec.ValidationError, LookupError) as problem:
        raise ValueError("not what was stored") from problem


MAX_TEXT = 100_000  # characters of texts that are in no file
ReadText = Callable[[str], SourceFile]  # the text of a file; raises OSError


class TooLargeError(ValueError):
    """Findings refer to more text outside of files than is worth storing."""


class KeptHits(ForeignValue, frozen=True, array_like=True):
    """The encoded hits of a file. `sources` are paths, each with its text if that is in no file."""

    sources: tuple[tuple[str, str | None], ...]
    hits: list[object]


def encode_hits(hits: Sequence[Hit], read: ReadText) -> tuple[KeptHits, set[str]]:
    """Encode hits, and return the paths of the files that their spans refer to. Raises TooLargeError."""
    texts: dict[SourceFile, int] = {}
    encoded = _encode(hits, texts)
    stored = {text for text in texts if text.text and _is_in_file(text, read)}
    if sum(len(text.text) for text in texts.keys() - stored) > MAX_TEXT:
        raise TooLargeError
    sources = tuple((text.path, None if text in stored else text.text) for text in texts)
    return KeptHits(sources, encoded), {text.path for text in stored}


def _is_in_file(text: SourceFile, read: ReadText) -> bool:
    try:
        return read(text.path).text == text.text
    except OSError:
        return False


def decode_hits(kept: KeptHits, read: ReadText) -> list[Hit]:
    """Decode the hits that `encode_hits` has encoded.

    Raises ValueError for spans outside of their texts, and OSError.
    """
    hits = _decode(
        kept.hits, list[Hit], [read(path) if text is None else SourceFile(path, text) for path, text in kept.sources]
    )
    _check_spans(span for hit in hits for span in (hit.found.span, *(note.span for note in hit.found.notes)))
    return hits


def _check_spans(spans: Iterable[Span | None]) -> None:
    if not all(span is None or 0 <= span.start <= span.end <= len(span.file.text) for span in spans):
        raise ValueError("a span outside of its text")


CHECKED = "checked"  # PATH: whether it is among the checked files, and as what; answered by the check itself
ENVIRONMENT = "environment"  # NAME
_WORDS = {"package_names": 0, "find_in_package": 2, "find_files": 2, "find_executables": 2}
_KINDS = QUESTIONS | {CHECKED, ENVIRONMENT}
_SIZE = 12  # bytes of a digest


class Answers:
    """Digests of answers to queries, each computed once."""

    def __init__(self, answer: Callable[[Question], object]) -> None:
        self._answer = answer
        self._digests: dict[Question, str] = {}

    def digest_of(self, question: Question) -> str:
        """Return the digest of the answer to a query, computed on its first use."""
        if question not in self._digests:
            self._digests[question] = digest_of(self._answer(question))
        return self._digests[question]


def is_question(words: tuple[str, ...]) -> bool:
    """Return whether texts from a file are a valid query to a world."""
    return words[0] in _KINDS and len(words) == 1 + _WORDS.get(words[0], 1)


def digest_of(answer: object) -> str:
    """Return a digest of bytes, a text, a number, None, an exception, or a tuple, list or set of texts.

    Sets are sorted first; of an exception, its class, numbers and texts count. Raises TypeError for other types.
    """
    return hashlib.blake2b(_bytes_of(answer), digest_size=_SIZE).hexdigest()


def _bytes_of(answer: object) -> bytes:
    if isinstance(answer, bytes):
        return b"bytes:" + answer
    if isinstance(answer, Exception):
        answer = (type(answer).__name__, *map(str, answer.args), str(answer))
    elif isinstance(answer, Set):
        answer = ("set", *sorted(answer))
    elif not isinstance(answer, str | int | tuple | list | None):
        raise TypeError(f"{type(answer).__name__} is not what a world answers")
    return repr(answer).encode("utf-8", "backslashreplace")


class RecalledFile(ForeignValue, frozen=True, array_like=True):
    """The findings of one file and their dependencies.

    `inputs` is a digest of the check's inputs for the file; `questions`: indices in `KnownFindings.questions`.
    """

    inputs: str
    questions: tuple[Count, ...]
    hits: KeptHits


class KnownFindings(NamedTuple):
    """Findings and outlines by the path of the file, and each query with the digest of its answer."""

    questions: Sequence[tuple[Question, str]] = ()
    units: Mapping[str, RecalledFile] = {}
    outlines: Mapping[str, KeptOutline] = {}


class Recall:
    """Findings of an earlier check, and those of the present one."""

    def __init__(self, known: KnownFindings | None = None) -> None:
        self._known = known or KnownFindings()
        self._valid: dict[int, bool] = {}
        self._numbers: dict[Question, int] = {}
        self._questions: list[tuple[Question, str]] = []
        self._units: dict[str, RecalledFile] = {}
        self._outlines: dict[str, KeptOutline] = {}
        self.changed = False  # this check found something that the earlier one did not know
        self.recalled = 0  # files whose findings were taken from the earlier check

    @property
    def forgets(self) -> bool:
        """Return whether any finding of the earlier check is no longer of use."""
        return len(self._units) < len(self._known.units) or len(self._outlines) < len(self._known.outlines)

    @property
    def now(self) -> KnownFindings:
        """Return the findings of this check, for the next one."""
        return KnownFindings(tuple(self._questions), dict(self._units), dict(self._outlines))

    def find_outline(self, path: str, world: Asked) -> IncludeOutline | None:
        """Return the stored outline of a launch file, or None if its text has changed."""
        kept = self._known.outlines.get(path)
        if kept is None or kept.digest != world.answers.digest_of(("read_bytes", path)):
            return None
        try:
            source = world.read_text(path)
            outline = IncludeOutline(source, kept.includes, _decode(kept.comments, tuple[Suppression, ...], (source,)))
            _check_spans(Span(source, tag.start, tag.end) for tag in kept.includes)
            _check_spans(each.span for each in outline.comments)
        except (ValueError, OSError):
            return None  # damaged: found again
        self._outlines[path] = kept
        return outline

    def keep_outline(self, path: str, outline: IncludeOutline, world: Asked) -> None:
        """Store the outline of a launch file for the next check."""
        if path not in self._outlines:
            self.changed = True
            digest = world.answers.digest_of(("read_bytes", path))
            self._outlines[path] = KeptOutline(digest, outline.includes, _encode(outline.comments, {}))

    def find(self, path: str, inputs: object, world: Asked) -> tuple[list[Hit], set[Question]] | None:
        """Return the valid stored hits of a file, with the queries that they depend on, or None.

        `inputs`: its dependencies besides the queries, consisting of texts, numbers, None, tuples and sorted lists.
        """
        digest = digest_of(repr(inputs))
        unit = self._known.units.get(path)
        if unit is None or unit.inputs != digest or not all(self._holds(each, world) for each in unit.questions):
            return None
        try:
            hits = decode_hits(unit.hits, world.read_text)
        except (ValueError, OSError):
            return None  # damaged: found again
        self.recalled += 1
        questions = [self._known.questions[each][0] for each in unit.questions]
        self._keep(path, digest, questions, unit.hits, world)
        return hits, {*questions}

    def keep(self, path: str, inputs: object, world: Asked, hits: Sequence[Hit], asked: set[Question]) -> None:
        """Store the hits of a file for the next check. `asked`: the queries that led to them."""
        self.changed = True
        try:
            encoded, files = encode_hits(hits, world.read_text)
        except TooLargeError:
            return
        everything = {*asked, *(("read_bytes", each) for each in (path, *files))}
        self._keep(path, digest_of(repr(inputs)), sorted(everything), encoded, world)

    def _holds(self, number: int, world: Asked) -> bool:
        if number not in self._valid:
            question, digest = self._known.questions[number]
            self._valid[number] = world.answers.digest_of(question) == digest
        return self._valid[number]

    def _keep(self, path: str, inputs: str, questions: Iterable[Question], hits: KeptHits, world: Asked) -> None:
        numbers = []
        for question in questions:
            if question not in self._numbers:
                self._numbers[question] = len(self._questions)
                self._questions.append((question, world.answers.digest_of(question)))
            numbers.append(self._numbers[question])
        self._units[path] = RecalledFile(inputs, tuple(numbers), hits)


class Asked:
    """Digests of the answers of a world. `checked` returns the kind of file that a path is checked as."""

    def __init__(self, world: CachedWorld, checked: Callable[[str], str]) -> None:
        self._world = world
        self._checked = checked
        self._texts: dict[str, SourceFile] = {}
        self.answers = Answers(self._answer)

    def read_text(self, path: str) -> SourceFile:
        """Return the text of a file, decoded like a launch file, as one object for each path. Raises OSError."""
        if path not in self._texts:
            answer = self._world.answer(("read_bytes", path))
            if not isinstance(answer, bytes):
                raise OSError(0, "not readable", path)
            self._texts[path] = SourceFile(path, decode_text(answer)[0])
        return self._texts[path]

    def _answer(self, question: Question) -> object:
        return self._checked(question[1]) if question[0] == CHECKED else self._world.answer(question)


class NotedTrees(dict[str, LaunchFile]):
    """Launch files by absolute path, with those of `views`. Each access is recorded as a query."""

    def __init__(self, world: CachedWorld, views: Mapping[str, LaunchView]) -> None:
        super().__init__()
        self._world = world
        self._views = views

    def get(self, path: str, default: LaunchFile | None = None) -> LaunchFile | None:  # type: ignore[override]
        """See dict."""
        self._world.note("read_bytes", path)
        view = self._views.get(path)
        return view.tree if view is not None else super().get(path, default)


def describe_package(package: Package | None) -> object:
    """Return the properties of a package on which the findings of a file depend, for `Recall.find`."""
    if package is None:
        return None
    bases = [(base.name, base.variants) for base in package.bases]
    return (package.name, package.folder, package.follows_conventions, bases, sorted(package.depends))
