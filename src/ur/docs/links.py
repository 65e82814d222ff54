"""Links in the Markdown of comments, which are written relative to a launch file but read elsewhere."""

import posixpath
import re
from collections.abc import Callable

_LINK = re.compile(r"(!?)\[([^\]\n]{0,500})\]\(\s*([^)\s]+)\s*\)")
_SCHEME = re.compile(r"[a-zA-Z][a-zA-Z0-9+.-]*:")


def settle_links(text: str, folder: str, exists: Callable[[str], bool]) -> str:
    """Return Markdown whose relative links start at the root of the repository; dead links become plain text.

    `folder` is the folder of the text, relative to the root; `exists` is called with a path relative to the root, too.
    """

    def settle(match: re.Match[str]) -> str:
        mark, label, target = match.groups()
        if _SCHEME.match(target) or target.startswith("//"):
            return match.group()
        path, hash_, fragment = target.partition("#")
        for base in (folder, ""):
            whole = posixpath.normpath(posixpath.join(base, path))
            if path and not path.startswith("/") and not whole.startswith("..") and exists(whole):
                return f"{mark}[{label}]({whole}{hash_}{fragment})"
        return label

    return _LINK.sub(settle, text) if "](" in text else text


def map_links(text: str, place: Callable[[str], str]) -> str:
    """Return Markdown in which `place` maps each relative link."""

    def replace(match: re.Match[str]) -> str:
        mark, label, target = match.groups()
        if _SCHEME.match(target) or target.startswith("//"):
            return match.group()
        return f"{mark}[{label}]({place(target)})"

    return _LINK.sub(replace, text) if "](" in text else text
