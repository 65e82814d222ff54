"""Packages that a launch package depends on."""

import re
from collections.abc import Iterable, Iterator

from ur.check.cases import resolve_cases
from ur.check.collect import collect_targets
from ur.check.rule import LaunchView, Package, survey_launch_file
from ur.check.survey import walk_possible
from ur.check.worlds import CachedWorld, has_marker
from ur.launchfile.world import World
from ur.source.file import SourceFile, Span
from ur.source.progress import Progress, counted, no_progress

_FIND = re.compile(r"\$\(find\s+([A-Za-z][\w-]*)\s*\)|\bfind\(\s*['\"]([\w-]+)['\"]\s*\)")
_STARTS = re.compile(r"^[^#\n]*\b(?:ur\"?|ros)\s?(?:launch|run)\s+(?:-\S+\s+)*([a-z]\w+)\s+\S", re.MULTILINE)


def find_used_packages(folder: str, world: World, progress: Progress = no_progress) -> tuple[Package, dict[str, Span]]:
    """Return the package in a folder, and by name the packages that it uses, each with its first use.

    Launch files are resolved for every base, variant and option; programs in `bin` count, too. The package itself, and
    uses that depend on arguments without a value, are left out. Raises UserError for a folder without package.xml.
    """
    cached = CachedWorld(world)
    targets = collect_targets([folder], cached)
    package = targets.whole[0] if targets.whole else None
    if package is None or package.folder != cached.absolute(folder):
        from ur.source.diagnostic import user_error_about

        raise user_error_about(folder, "no package.xml, expected a package", rule="no-package", help="ur new package")
    found: dict[str, Span] = {}
    for path in counted(targets.launch_files, "checking", "launch files", progress):
        if targets.package_of(path) is package:
            for name, span in _in_launch_file(survey_launch_file(path, package, cached), cached):
                found.setdefault(name, span)
    for path in targets.programs:
        source = SourceFile(path, cached.read_bytes(path).decode("utf-8", "replace"))
        for match in _STARTS.finditer(source.text):
            found.setdefault(match.group(1), Span(source, *match.span(1)))
    found.pop(package.name, None)
    return package, found


def _in_launch_file(view: LaunchView, world: CachedWorld) -> Iterator[tuple[str, Span]]:
    for element in walk_possible(view.tree.launch):
        for attribute, value in element.attributes.items():
            for match in _FIND.finditer(value):
                yield match.group(1) or match.group(2), element.piece_span(attribute, *match.span())
    for resolved in resolve_cases(view, world):
        for node in resolved.plan.all_nodes():
            own = node.origin.span.file.path == view.path
            if own and node.package and not has_marker(node.package):
                yield node.package, node.origin.span


_COMMENT = re.compile(r"<!--.*?(?:-->|\Z)", re.DOTALL)
_RUN = re.compile(r"<(depend|exec_depend|run_depend)\b[^>]*>\s*([\w-]+)\s*</\1>")
_OPTIONAL = re.compile(r"<!--\s*ur:\s*optional\s+([\w\s,-]*?):[^>]*-->")
_LAST = re.compile(r"^([ \t]*)<(?:\w*_)?depend\b[^\n]*</\w+>[^\n]*\n", re.MULTILINE)
_END = re.compile(r"^([ \t]*)(<export\b|</package>)", re.MULTILINE)
_FORMAT_1 = re.compile(r"<package(?![^<>]{0,500}\bformat=\"[23]\")[^<>]*>")


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
