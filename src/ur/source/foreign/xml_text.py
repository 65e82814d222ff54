"""Untrusted XML: parsed without document types, and within limits of depth and number."""

from xml.etree.ElementTree import Element, ParseError, TreeBuilder, XMLParser

MAX_DEPTH = 100
MAX_ELEMENTS = 200_000
MAX_LENGTH = 20_000_000  # bytes or characters


def parse_xml(text: str | bytes, *, length: int = MAX_LENGTH, elements: int = MAX_ELEMENTS) -> Element:
    """Return the root element of a document.

    Raises ValueError, whose text is the reason: not well-formed, a document type (required for entities), more
    characters than `length`, more elements than `elements`, or elements nested deeper than MAX_DEPTH.
    """
    if len(text) > length:
        raise ValueError(f"{len(text):,} characters, expected at most {length:,}")
    parser = XMLParser(target=_Builder(elements))  # noqa: S314 - the builder refuses document types
    try:
        parser.feed(text)
        root: Element = parser.close()
    except (ParseError, LookupError, AssertionError) as problem:  # LookupError: an encoding that Python does not know
        raise ValueError(str(problem)) from None
    return root


class _Builder(TreeBuilder):
    def __init__(self, elements: int) -> None:
        super().__init__()
        self._elements = elements
        self._seen = self._open = 0

    def start(self, tag: str, attrs: dict[str, str], /) -> Element:
        self._seen += 1
        self._open += 1
        if self._seen > self._elements:
            raise ValueError(f"more than {self._elements:,} elements")
        if self._open > MAX_DEPTH:
            raise ValueError(f"nested deeper than {MAX_DEPTH} levels")
        return super().start(tag, attrs)

    def end(self, tag: str, /) -> Element:
        self._open -= 1
        return super().end(tag)

    def doctype(self, *_: str | None) -> None:
        raise ValueError("a document type, expected XML without one")
