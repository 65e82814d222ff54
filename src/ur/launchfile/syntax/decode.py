"""Decoding of bytes to text, and conversion of expat's byte offsets to character offsets."""

from __future__ import annotations

import codecs
import re

_DECLARATION = re.compile(rb"""^<\?xml[^>]*?encoding\s*=\s*["']([A-Za-z0-9._-]+)["']""")
_MARKS = ((codecs.BOM_UTF8, "utf-8"), (codecs.BOM_UTF16_LE, "utf-16-le"), (codecs.BOM_UTF16_BE, "utf-16-be"))


def decode_text(data: bytes) -> tuple[str, str]:
    """Return the text of an XML file and its encoding: from the byte order mark, the declaration, else UTF-8.

    Invalid bytes become U+FFFD; the XML parser reports them.
    """
    if data.isascii():
        return data.decode("ascii"), "ascii"
    for mark, encoding in _MARKS:
        if data.startswith(mark):
            return data.decode(encoding, "replace"), encoding
    declared = _DECLARATION.match(data)
    encoding = declared.group(1).decode("ascii").lower() if declared else "utf-8"
    try:
        return data.decode(encoding, "replace"), encoding
    except (LookupError, ValueError):
        return data.decode("utf-8", "replace"), "utf-8"


class Offsets:
    """Converts byte offsets to character offsets. Cheap as long as the requested offsets increase."""

    __slots__ = ("_byte", "_character", "_data", "_encoding", "_same")

    def __init__(self, data: bytes, encoding: str) -> None:
        self._data = data
        self._encoding = encoding
        self._same = encoding == "ascii"
        self._byte = 0
        self._character = 0

    def characters(self, byte: int) -> int:
        """Return the number of characters before a byte."""
        if self._same:
            return byte
        if byte < self._byte:
            self._byte = self._character = 0
        self._character += len(self._data[self._byte : byte].decode(self._encoding, "replace"))
        self._byte = byte
        return self._character
