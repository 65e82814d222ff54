"""The order of a launch file: Summary, Overview, required, convenience and optional arguments, the rest."""

import re
from collections.abc import Iterable, Sequence
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
