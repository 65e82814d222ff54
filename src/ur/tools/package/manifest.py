"""The dependencies in a package.xml: read, compared, added without changing other lines."""

from __future__ import annotations

import re
from collections.abc import Iterable

_COMMENT = re.compile(r"<!--.*?(?:-->|\Z)", re.DOTALL)
_RUN = re.compile(r"<(depend|exec_depend|run_depend)\b[^>]*>\s*([\w-]+)\s*</\1>")
_OPTIONAL = re.compile(r"<!--\s*ur:\s*optional\s+([\w\s,-]*?):[^>]*-->")
_LAST = re.compile(r"^([ \t]*)<(?:\w*_)?depend\b[^\n]*</\w+>[^\n]*\n", re.MULTILINE)
_END = re.compile(r"^([ \t]*)(<export\b|</package>)", re.MULTILINE)
_FORMAT_1 = re.compile(r"<package(?![^>]{0,500}\bformat=\"[23]\")[^>]*>")


def read_run_dependencies(text: str) -> frozenset[str]:
    """Return the run dependencies of a package."""
    return frozenset(name for _, name in _RUN.findall(_COMMENT.sub("", text)))


def read_optional(text: str) -> frozenset[str]:
    """Return the optional packages, named in `<!--ur: optional NAME NAME: REASON-->`."""
    return frozenset(name for names in _OPTIONAL.findall(text) for name in names.replace(",", " ").split())


def add_run_dependencies(text: str, names: Iterable[str]) -> str:
    """Return the package.xml with further dependencies after the last one, except for existing and optional ones."""
    missing = sorted(set(names) - read_run_dependencies(text) - read_optional(text))
    if not missing:
        return text
    tag = "run_depend" if _FORMAT_1.search(text) else "exec_depend"
    last = None
    for match in _LAST.finditer(text):
        last = match
    if last is not None:
        place, indent = last.end(), last.group(1)
    else:
        end = _END.search(text)
        if end is None:
            raise ValueError("no </package>")
        place, indent = end.start(), "  "
    lines = "".join(f"{indent}<{tag}>{name}</{tag}>\n" for name in missing)
    return text[:place] + lines + text[place:]
