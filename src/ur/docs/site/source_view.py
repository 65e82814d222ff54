"""The text of a launch file or program with numbered lines that links reach."""

from __future__ import annotations

import re
from collections.abc import Iterator
from html import escape

_XML = re.compile(
    r"(?P<comment><!--.*?-->)|(?P<tag></?[\w:.-]+|/?>|\?>|<\?[\w:.-]+)|(?P<value>\"[^\"]*\"|'[^']*')", re.DOTALL
)
_SHELL = re.compile(r"(?P<comment>(?:^|(?<=\s))#[^\n]*)|(?P<value>\"[^\"\n]*\"|'[^'\n]*')", re.MULTILINE)


def show_source(text: str, *, xml: bool) -> str:
    """Lines with anchors `L1`, `L2`, ...; comments, tags and values in colours."""
    painted = "".join(_paint(text.expandtabs(4), _XML if xml else _SHELL))
    lines = painted.removesuffix("\n").split("\n")
    body = "\n".join(f'<span class="line" id="L{n}">{_close(line)}</span>' for n, line in enumerate(lines, 1))
    return f'<pre class="source" tabindex="0" aria-label="source"><code>{body}</code></pre>'


def _paint(text: str, pattern: re.Pattern[str]) -> Iterator[str]:
    position = 0
    for match in pattern.finditer(text):
        yield escape(text[position : match.start()], quote=False)
        # A line is an element of its own, so a comment over several lines is one piece per line.
        pieces = match.group().split("\n")
        yield "\n".join(f'<i class="{match.lastgroup}">{escape(piece, quote=False)}</i>' for piece in pieces)
        position = match.end()
    yield escape(text[position:], quote=False)


def _close(line: str) -> str:
    return line.rstrip("\r") or " "
