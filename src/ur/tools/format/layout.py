"""Layout of pieces as text: two blanks a level, attributes in one order, one blank line at most."""

import re
from collections.abc import Iterator, Sequence

from ur.tools.format.pieces import CommentPiece, Piece, Tag

WIDTH = 120
MANY = 4  # attributes that stand on one line at most
_STEP = "  "
# The other attributes follow in the order of the alphabet, conditions at the end.
_FIRST = {
    "arg": ("name", "value", "default"),
    "env": ("name", "value"),
    "group": ("ns",),
    "include": ("file",),
    "machine": ("name", "address"),
    "param": ("name", "type", "value"),
    "remap": ("from", "to"),
    "rosparam": ("command", "file"),
}
_LAST = ("if", "unless")
_ITEM = re.compile(r"-( +)(?=\S)")
_TEXT_BLOCK = re.compile(r"(?:^|[:\s])[|>][+-]?\d?\s*(?:#.*)?\Z")


def lay_out(tag: Tag, depth: int = 0) -> Iterator[str]:
    """Yield the lines of a tag and its contents. The layout is idempotent."""
    indent = _STEP * depth
    opening = [*_opening(tag, indent)]
    closing = f"</{tag.name}>"
    if tag.verbatim is not None:
        yield from opening[:-1]
        yield f"{opening[-1]}>{tag.verbatim}{closing}"
    elif tag.inside:
        yield from opening[:-1]
        yield f"{opening[-1]}>"
        yield from _inside(tag.inside, depth + 1)
        yield indent + closing
    else:
        yield from opening[:-1]
        yield f"{opening[-1]}/>"


def lay_out_note(note: CommentPiece, indent: str) -> str:
    """Return a comment at an indentation: its further lines move with the first."""
    first, *others = note.text.split("\n")
    shift = len(indent) - note.column if note.column is not None else 0
    return "\n".join([first.rstrip() if others else first, *(_moved(line, shift) for line in others)])


def _inside(pieces: Sequence[Piece], depth: int) -> Iterator[str]:
    indent = _STEP * depth
    line = ""
    for number, piece in enumerate(pieces):
        before = pieces[number - 1].what if number else None
        if isinstance(piece.what, CommentPiece) and piece.same_line and isinstance(before, Tag):
            line += f" {lay_out_note(piece.what, indent)}"
            continue
        if number:
            yield line
        if piece.blank_before and number:
            yield ""
        if isinstance(piece.what, Tag):
            *done, line = lay_out(piece.what, depth)
            yield from done
        elif isinstance(piece.what, CommentPiece):
            line = indent + lay_out_note(piece.what, indent)
        else:
            line = indent + piece.what.text
    yield line


def _opening(tag: Tag, indent: str) -> Iterator[str]:
    # Without the bracket that closes it.
    words = [f"{name}={value}" for name, value in sort_attributes(tag.name, tag.attributes)]
    line = " ".join([f"{indent}<{tag.name}", *words])
    if len(words) > MANY or (len(words) > 1 and (len(line) > WIDTH or "\n" in line)):
        yield f"{indent}<{tag.name} {words[0]}"
        yield from (f"{indent}{_STEP}{word}" for word in words[1:])
    else:
        yield line


def sort_attributes(tag: str, attributes: Sequence[tuple[str, str]]) -> list[tuple[str, str]]:
    """Return attributes in conventional order."""
    first = _FIRST.get(tag, ())

    def rank(attribute: tuple[str, str]) -> tuple[int, str]:
        name = attribute[0]
        if name in first:
            return first.index(name), ""
        return (len(first) + 1, str(_LAST.index(name))) if name in _LAST else (len(first), name)

    return sorted(attributes, key=rank)


def _moved(line: str, shift: int) -> str:
    text = line.strip()
    if not text:
        return ""
    width = len(line[: len(line) - len(line.lstrip())].expandtabs(4))
    return " " * max(width + shift, 0) + text


def lay_out_yaml(text: str) -> str:
    """Return a text with its lines at conventional columns. What it means is compared by the caller."""
    levels: list[tuple[int, int]] = []  # columns of before and of now, from the outermost
    lines: list[str] = []
    block: tuple[int, int] | None = None  # the column of the key of a text, and by how much its lines move
    for line in text.replace("\r\n", "\n").expandtabs(2).split("\n"):
        bare = line.strip()
        column = len(line) - len(line.lstrip())
        if not bare:
            if lines and lines[-1]:
                lines.append("")
            continue
        if block is not None and column > block[0]:
            lines.append(" " * max(column + block[1], 0) + line.lstrip().rstrip())
            continue
        while levels and column < levels[-1][0]:
            levels.pop()
        if not levels or column > levels[-1][0]:
            levels.append((column, levels[-1][1] + 2 if levels else 0))
        start = now = levels[-1][1]
        items = 0
        while found := _ITEM.match(bare):
            column += found.end()
            now += 2
            levels.append((column, now))
            bare = bare[found.end() :]
            items += 1
        lines.append(" " * start + "- " * items + bare)
        block = (levels[-1 - items][0], start - levels[-1 - items][0]) if _TEXT_BLOCK.search(bare) else None
    while lines and not lines[-1]:
        lines.pop()
    return "\n".join(lines) + "\n"
