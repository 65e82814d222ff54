"""Pieces of HTML, and Markdown as HTML. Texts of files are escaped here."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from functools import lru_cache
from html import escape
from typing import TYPE_CHECKING

from ur.docs.documents import BaseCase, Value
from ur.docs.links import map_links
from ur.docs.vary import name_cases

if TYPE_CHECKING:
    from markdown_it import MarkdownIt

_SPECIAL = re.compile(r"[`*_\[\]\\!~|#&<>:/@\n]")
Place = Callable[[str], "str | None"]  # where a path of the repository is on the site


@lru_cache(maxsize=1)
def _markdown() -> MarkdownIt:
    from markdown_it import MarkdownIt  # 40 ms, which the page in Markdown does without

    return MarkdownIt("commonmark", {"html": False}).enable("table")


@lru_cache(maxsize=8192)
def inline(text: str) -> str:
    """Return Markdown of one line as HTML, without links."""
    text = map_links(" ".join(text.split()), lambda _target: None)
    if not _SPECIAL.search(text):
        return escape(text)
    rendered: str = _markdown().renderInline(text)
    return rendered


def blocks(text: str, place: Place) -> str:
    """Return Markdown as HTML; its headings become small ones, its relative links lead to pages of the site."""
    parser = _markdown()
    tokens = parser.parse(map_links(text, place))
    for token in tokens:
        if token.type in ("heading_open", "heading_close"):
            token.tag = "h4"
    rendered: str = parser.renderer.render(tokens, parser.options, {})
    return rendered


def code(text: str) -> str:
    """Return a text as code."""
    return f"<code>{escape(text)}</code>" if text else '<span class="quiet">(empty)</span>'


def link(target: str, content: str, extra: str = "") -> str:
    """Return a link around HTML."""
    return f'<a href="{escape(target)}"{extra}>{content}</a>'


def cases_attribute(cases: Iterable[BaseCase]) -> str:
    """Return the HTML attribute that the base switch reads."""
    keys = " ".join(case.key for case in cases if case.base)
    return f' data-cases="{escape(keys)}"' if keys else ""


def show_values(values: Sequence[Value]) -> str:
    """Return a value that may differ between bases."""
    if len(values) == 1 and not values[0].cases:
        return code(values[0].text)
    parts = []
    for value in values:
        names = name_cases(value.cases)
        where = f' <span class="where">{escape(names)}</span>' if names.strip() else ""
        parts.append(f"<div{cases_attribute(value.cases)}>{code(value.text)}{where}</div>")
    return "".join(parts)


def table(head: Sequence[str], rows: Sequence[Sequence[str]], label: str) -> str:
    """Return a table of HTML cells that scrolls separately; empty columns are left out."""
    used = [i for i in range(len(head)) if any(row[i] for row in rows)]
    header = "".join(f'<th scope="col">{head[i]}</th>' for i in used)
    body = "".join(f"<tr>{''.join(_cell(row[i], head[i], i == used[0]) for i in used)}</tr>" for row in rows)
    return (
        f'<div class="scroll" role="region" aria-label="{escape(label)}" tabindex="0">'
        f"<table><thead><tr>{header}</tr></thead><tbody>{body}</tbody></table></div>"
    )


def _cell(content: str, title: str, first: bool) -> str:
    # Narrow screens stack the cells of a row, each with the title of its column.
    if first:
        return f'<th scope="row">{content}</th>'
    label = f' data-label="{escape(title)}"' if title and content else ""
    return f"<td{label}>{content}</td>"


def section(anchor: str, title: str, content: str) -> str:
    """Return a part of a page, with a heading that links can target."""
    return f'<section aria-labelledby="{anchor}"><h2 id="{anchor}">{escape(title)}</h2>{content}</section>'
