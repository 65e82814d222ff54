"""Layout of a launch file as text: its order, two blanks a level, attributes in one order, one blank line at most."""

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from ur.check.survey import find_uses
from ur.tools.format.pieces import CommentPiece, Piece, Tag

_SUMMARY, _OVERVIEW, _REQUIRED, _CONVENIENCE, _OPTIONAL, _REST = range(6)
_TITLES = {
    _REQUIRED: "<!-- Required arguments -->",
    _CONVENIENCE: "<!-- Convenience arguments -->",
    _OPTIONAL: "<!-- Optional arguments -->",
}
_TITLE = re.compile(r"<!--\s*(required|convenience|optional)\s+arg(ument)?s?\s*:?\s*-->\Z", re.IGNORECASE)
_HEADING = re.compile(r"<!--\s*([A-Za-z_]\w*)\s*:(?!/)")


@dataclass(frozen=True, slots=True)
class _Unit:
    """Tags and comments that stay together: comments before a tag, the tag, the comments that document it."""

    rank: int
    pieces: tuple[Piece, ...]


def sort_pieces(launch: Tag) -> Tag:
    """Return `<launch>` in conventional order, as far as the dependencies between arguments allow.

    An argument that is computed from an optional one counts as optional, so no argument moves before its dependencies.
    Titles such as `<!-- Required arguments -->` are written anew when the file has one of them.
    """
    titled = any(_is_title(piece) for piece in launch.inside)
    units = _units([piece for piece in launch.inside if not _is_title(piece)])
    ordered = sorted(units, key=lambda unit: unit.rank)
    return replace(launch, inside=tuple(_join(ordered, titled, moved=ordered != units)))


def _units(pieces: Sequence[Piece]) -> list[_Unit]:
    units: list[_Unit] = []
    waiting: list[Piece] = []
    optional: set[str] = set()
    for piece in pieces:
        what = piece.what
        heading = _heading(piece)
        if isinstance(what, Tag):
            rank = _rank(what, optional)
            units.append(_Unit(rank, (*waiting, piece)))
            waiting = []
        elif units and not waiting and _belongs(piece, units[-1]):
            documentation = replace(piece, same_line=piece.same_line and heading is None)
            units[-1] = replace(units[-1], pieces=(*units[-1].pieces, documentation))
        elif heading in ("Summary", "Overview") and not waiting:
            units.append(_Unit(_SUMMARY if heading == "Summary" else _OVERVIEW, (piece,)))
        elif heading in ("Needs", "ur") and units and units[-1].rank <= _OVERVIEW and not waiting:
            units[-1] = replace(units[-1], pieces=(*units[-1].pieces, piece))
        else:
            waiting.append(piece)
    return [*units, _Unit(_REST, tuple(waiting))] if waiting else units


def _rank(tag: Tag, optional: set[str]) -> int:
    if tag.name != "arg" or tag.element is None:
        return _REST
    attributes = tag.element.attributes
    uses = {name for name, _ in find_uses(tag.element)}
    if "default" in attributes or uses & optional:
        optional.add(attributes.get("name", ""))
        return _OPTIONAL
    return _CONVENIENCE if "value" in attributes else _REQUIRED


def _belongs(piece: Piece, unit: _Unit) -> bool:
    """Return whether a comment after a tag documents it: on its line, or under the argument's name."""
    last = unit.pieces[-1].what
    if piece.same_line and isinstance(last, Tag | CommentPiece) and isinstance(piece.what, CommentPiece):
        return True
    tag = next((each.what for each in unit.pieces if isinstance(each.what, Tag)), None)
    if tag is None or tag.element is None or tag.name != "arg":
        return False
    return _heading(piece) == tag.element.attributes.get("name")


def _heading(piece: Piece) -> str | None:
    match = _HEADING.match(piece.what.text) if isinstance(piece.what, CommentPiece) else None
    return match.group(1) if match else None


def is_title(comment: str) -> bool:
    """Return whether a comment, from `<!--` to `-->`, titles a group of arguments."""
    return _TITLE.match(comment) is not None


def _is_title(piece: Piece) -> bool:
    return isinstance(piece.what, CommentPiece) and is_title(piece.what.text)


def _join(units: Sequence[_Unit], titled: bool, moved: bool) -> Iterable[Piece]:
    rank = -1
    for unit in units:
        first, *others = unit.pieces
        if unit.rank != rank:
            title = _TITLES.get(unit.rank) if titled else None
            apart = unit.rank >= _REQUIRED and (titled or moved)
            if title:
                yield Piece(CommentPiece(title, None), blank_before=True)
                first = replace(first, blank_before=False)
            else:
                first = replace(first, blank_before=first.blank_before or apart)
            rank = unit.rank
        yield first
        yield from others


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
