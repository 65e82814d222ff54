"""Broken variants of inputs: bits of the text exchanged, doubled or cut, and values that parsers stumble over."""

import random
import re
from collections.abc import Sequence

_PIECE = re.compile(rb"<[^<>]*>|\$\([^()]*\)|\"[^\"]*\"|[\w-]+|\s+|.", re.DOTALL)
_SPECIAL = (
    *(
        b"",
        b"\x00",
        b"\xff",
        b"\xc3",
        b"\xed\xa0\x80",
        b"\xef\xbb\xbf",
        b"\xe2\x80\xae",
        b"\x1b]52;c;eA==\x07",
        b"\x1e",
    ),
    *(b"\r\n", b"\n", b"\t", b" ", b"-", b"--", b"-oProxyCommand=x", b"/", b"..", b"~", b":", b"=", b",", b"'", b'"'),
    *(
        b"0",
        b"-1",
        b"1e999",
        b"-1e999",
        b"nan",
        b".inf",
        b"9" * 30,
        b"9" * 5000,
        b"0x7fffffff",
        b"08",
        "\u0663".encode(),
    ),
    *(b"null", b"true", b"[]", b"{}", b"[" * 2000, b"{" * 2000, b'{"a":' * 2000, b"a" * 300, b"x" * 70000),
)
_BYTES = (0, 1, 127, 128, 255)


def mutate(inputs: Sequence[bytes], words: Sequence[bytes], chance: random.Random) -> bytes:
    """One of the inputs with a few pieces removed, doubled, swapped, or replaced: by bytes, `words` or other pieces."""
    data = chance.choice(inputs)
    if chance.random() < 0.3:
        return _mutate_bytes(data, chance)
    pieces = _PIECE.findall(data)
    others = _PIECE.findall(chance.choice(inputs))
    for _ in range(chance.choice((1, 1, 1, 2, 3, 8))):
        if not pieces:
            break
        at = chance.randrange(len(pieces))
        match chance.randrange(7):
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
                pieces.insert(at, chance.choice(words or _SPECIAL))
            case 5:
                pieces[at] = chance.choice(others or [b""])
            case _:
                del pieces[at : at + chance.randrange(1, 20)]
    return b"".join(pieces)


def _mutate_bytes(data: bytes, chance: random.Random) -> bytes:
    changed = bytearray(data)
    for _ in range(chance.choice((1, 1, 2, 4, 16))):
        if not changed:
            break
        at = chance.randrange(len(changed))
        match chance.randrange(5):
            case 0:
                changed[at] = chance.choice(_BYTES)
            case 1:
                changed[at] ^= 1 << chance.randrange(8)
            case 2:
                del changed[at:]
            case 3:
                end = at + chance.randrange(1, 9)
                changed[at:at] = changed[at:end]
            case _:
                del changed[at]
    return bytes(changed)
