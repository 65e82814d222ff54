"""Formatting of a launch file: read, lay out, order, verify."""

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from ur.check.cases import resolve_cases
from ur.check.rule import Package, survey_launch_file
from ur.check.worlds import CachedWorld
from ur.launchfile.plan.specs import Origin, Plan
from ur.launchfile.syntax import Comment, Element, LaunchFile, parse_launch_file
from ur.launchfile.syntax.parse import decode_text
from ur.launchfile.syntax.tree import WRONG_LAUNCHER
from ur.launchfile.world import World
from ur.launchfile.world.overlay import OverlayWorld
from ur.source.diagnostic import Diagnostic, UserError, user_error, user_error_about
from ur.source.file import Span
from ur.source.foreign.yaml_text import load_yaml
from ur.tools.format.layout import is_title, lay_out, lay_out_yaml, sort_pieces
from ur.tools.format.pieces import Tag, end_of, read_pieces


@dataclass(frozen=True, slots=True)
class Formatted:
    """A formatted launch file. `kept`: the part that is unchanged although it is not conventional, with the reason."""

    path: str
    before: str
    text: str
    kept: str | None = None

    @property
    def changed(self) -> bool:
        """Return whether the text has changed."""
        return self.text != self.before


def format_file(path: str, data: bytes, world: World, package: Package | None = None) -> Formatted:
    """Return a launch file in conventional layout and order, as far as that changes no plan.

    `path` is absolute. Raises UserError with the errors of a file that cannot be parsed, or is not UTF-8. The result
    has Unix line ends.
    """
    before, encoding = decode_text(data)
    if encoding not in ("ascii", "utf-8") or not data.endswith(before.encode()):
        raise user_error_about(
            path, "the file is not encoded in UTF-8", rule="not-utf-8", help="save it as UTF-8 first"
        )
    if path.endswith((".yaml", ".yml")):
        return _format_yaml(path, before, data, world, package)
    tree = _parse(path, before.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n"))
    assert tree.root is not None
    pieces = read_pieces(tree.root)
    plain = _write(tree, pieces)
    # Where <let> and <arg> depend on one another, their order is the author's.
    ordered = plain if tree.for_other_launcher else _write(tree, sort_pieces(pieces))
    for text, kept in ((ordered, None), (plain, "the order of its arguments"), (before, "its layout")):
        if text is ordered and text != plain and not _may_move(tree):
            continue
        if text == before or same_plans(path, data, _checked(tree, text).encode(), package, world):
            why = f"{kept} stays: the usual one would change the meaning of the file"
            return Formatted(path, before, text, why if kept and text != ordered else None)
    raise AssertionError("the text itself is the last that is tried")


def _format_yaml(path: str, before: str, data: bytes, world: World, package: Package | None) -> Formatted:
    text = lay_out_yaml(before)
    try:
        same = load_yaml(before) == load_yaml(text)
    except ValueError as problem:
        raise user_error_about(path, f"{problem}, expected YAML", rule="bad-yaml") from None
    if same and same_plans(path, data, text.encode(), package, world):
        return Formatted(path, before, text)
    return Formatted(path, before, before, "its layout stays: the usual one would change the meaning of the file")


def _parse(path: str, text: str) -> LaunchFile:
    tree = parse_launch_file(path, text.encode())
    if problems := _problems(tree):
        raise UserError(*problems)
    return tree


def _problems(tree: LaunchFile) -> list[Diagnostic]:
    # A file for another launcher has the same layout.
    return [each for each in tree.diagnostics if not tree.for_other_launcher or each.rule != WRONG_LAUNCHER]


def _write(tree: LaunchFile, pieces: Tag) -> str:
    assert tree.root is not None
    text = tree.source.text
    before, after = text[: tree.root.start].rstrip(), text[end_of(tree.root) :].strip()
    parts = (before, "\n".join(lay_out(pieces)), after)
    return "\n".join(part for part in parts if part) + "\n"


def _checked(tree: LaunchFile, text: str) -> str:
    # A defect here must not cost anybody a line of a launch file.
    after = parse_launch_file(tree.source.path, text.encode())
    if _problems(after) or not same_content(tree, after):
        message = f"{tree.source.path}: cannot be laid out without a change of its content; it is left as it is"
        raise user_error(message, rule="not-formatted", help="please report it with the file")
    return text


def _may_move(tree: LaunchFile) -> bool:
    # What pass_all_args hands over depends on which arguments stand before it, and may matter on another computer only.
    assert tree.root is not None
    return not any("pass_all_args" in element.attributes for element in tree.root.elements)


def same_content(before: LaunchFile, after: LaunchFile) -> bool:
    """Return whether two files contain the same tags, comments and texts; those directly in `<launch>` in any order.

    Comments that title a group of arguments do not count, nor blanks in comments.
    """
    first, second = before.root, after.root
    if first is None or second is None:
        return first is second
    return (
        (first.name, first.attributes) == (second.name, second.attributes)
        and Counter(map(_content, _reported(first))) == Counter(map(_content, _reported(second)))
        and [_content(each) for each in before.comments] == [_content(each) for each in after.comments]
    )


def same_plans(path: str, data: bytes, new: bytes, package: Package | None, world: World) -> bool:
    """Return whether a launch file resolves to the same plans, for each base, variant and option."""
    before = _plans(path, package, OverlayWorld(world, {path: data}))
    after = _plans(path, package, OverlayWorld(world, {path: new}))
    return all(first == second for first, second in zip(before, after, strict=True))


def _plans(path: str, package: Package | None, world: World) -> Iterator[object]:
    cached = CachedWorld(world)
    for resolved in resolve_cases(survey_launch_file(path, package, cached), cached):
        yield resolved.case, describe_plan(resolved.plan)


def describe_plan(plan: Plan) -> object:
    """Return a plan as a value for comparison: all of its content, without the positions of origin."""
    reported = Counter((found.severity, found.rule, found.message) for found in plan.diagnostics)
    return reported, [
        _plain(value) for name, value in plan._asdict().items() if name not in ("declared", "diagnostics", "files")
    ]


def _plain(value: object) -> object:
    """Return a value of a plan without the positions of its origin."""
    if isinstance(value, Span):
        return value.text
    if isinstance(value, tuple | list):
        return [_plain(each) for each in value if not isinstance(each, Origin)]
    return repr(value) if isinstance(value, float) else value


def _reported(element: Element) -> Iterable[Element | Comment]:
    return (each for each in element.children if not (isinstance(each, Comment) and is_title(each.span.text)))


def _content(each: Element | Comment) -> object:
    if isinstance(each, Comment):
        return " ".join(each.text.split())
    inside = tuple(_content(child) for child in each.children)
    return each.name, tuple(sorted(each.attributes.items())), each.text, inside
