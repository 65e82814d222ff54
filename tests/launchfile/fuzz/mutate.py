"""Broken variants of launch files: what an editor, a merge or a bad disk makes of them."""

from __future__ import annotations

import random
import re
from collections.abc import Sequence

_PIECE = re.compile(rb"<[^<>]*>|\$\([^()]*\)|\"[^\"]*\"|[\w-]+|\s+|.", re.DOTALL)
_SPECIAL = (
    *(b"<", b">", b"/>", b"</", b'"', b"'", b"&", b"&amp;", b"&#0;", b"&#10;", b"$(", b")", b"$(arg a)", b"$(anon n)"),
    *(b"$(eval ", b"$(find corpus_pkg)", b"<!--", b"-->", b"<![CDATA[", b"]]>", b"<?xml", b"?>", b"\xff", b"\xc3"),
    *(b"\x00", b"\r\n", b"\t", b"\xef\xbb\xbf", b"~", b"//", b" ", b"=", b"1e999", b"-1", b"true", b"if=", b"unless="),
)


def mutate(files: Sequence[bytes], chance: random.Random) -> bytes:
    """One of the files with a few pieces removed, doubled, swapped, or replaced by pieces of another one."""
    pieces = _PIECE.findall(chance.choice(files))
    others = _PIECE.findall(chance.choice(files))
    for _ in range(chance.choice((1, 1, 1, 2, 3, 8))):
        if not pieces:
            break
        at = chance.randrange(len(pieces))
        match chance.randrange(6):
            case 0:
                del pieces[at]
            case 1:
                pieces.insert(at, pieces[at])
            case 2:
                to = chance.randrange(len(pieces))
                pieces[at], pieces[to] = pieces[to], pieces[at]
            case 3:
                pieces[at] = chance.choice(_SPECIAL)
            case 4:
                pieces.insert(at, chance.choice(_SPECIAL))
            case _:
                pieces[at] = chance.choice(others or [b""])
    return b"".join(pieces)
