"""The files that a check reads, with the includes between launch files."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from types import MappingProxyType

from ur.check.cache.recall import IncludeOutline, NotedTrees, outline_of
from ur.check.collect import collect_targets, is_script, list_launch_files, may_be_checked
from ur.check.findings.suppress import Suppression
from ur.check.inclusion import IncludeFinder, Inclusions, PossibleInclude, merge_includes
from ur.check.rule import LaunchView, Package, survey_launch_file
from ur.check.survey import LaunchSurvey
from ur.check.worlds import CachedWorld
from ur.launchfile.world import World
from ur.source.diagnostic import Diagnostic, error
from ur.source.file import SourceFile, Span
from ur.source.progress import Progress, counted

_STRUCTURE = ("package.xml", "base.yaml", "CATKIN_IGNORE")  # files that tell how others are checked
RecallOutline = Callable[[str], IncludeOutline | None]  # of the file at a path, as it is now
_NOTHING: Mapping[str, LaunchSurvey] = MappingProxyType({})


def _recall_nothing(_path: str) -> None:
    return None


class CheckSources:
    """The files that a check of `paths` reads. Raises UserError for a bad path.

    `views` are the checked launch files, `neighbours` other ones of the same packages, which may include them; `trees`
    all parsed launch files. `unreadable` and `comments` are findings and suppressions by path, `outlines` those of the
    views and neighbours.
    """

    def __init__(self, paths: Sequence[str], world: World) -> None:
        self.world = CachedWorld(world)
        self.targets = collect_targets(paths, self.world)
        self.views: dict[str, LaunchView] = {}
        self.trees = NotedTrees(self.world, self.views)
        self.outlines: dict[str, IncludeOutline] = {}
        self.neighbours: dict[str, LaunchView] = {}
        self.inclusions = Inclusions()
        self.unreadable: dict[str, Diagnostic] = {}
        self.comments: dict[str, tuple[Suppression, ...]] = {}
        self._includes: dict[str, tuple[PossibleInclude, ...]] = {}
        self._yaml = frozenset(self.targets.yaml_files)
        self._paths_of: dict[str, dict[str, None]] = {}  # of views, in their order, by the folder of their package

    def read(self, known: Mapping[str, LaunchSurvey], recall: RecallOutline, progress: Progress) -> None:
        """Read all launch files, except `known` ones; those that `recall` has are not parsed."""
        for path in counted(self.targets.launch_files, "reading", "launch files", progress):
            self._read_view(path, known, recall)
        folders = {view.package.folder: view.package for view in self.views.values() if view.package is not None}
        for folder, package in folders.items():
            progress(f"finding files that include them in {package.name}")
            for path in list_launch_files(folder, self.targets, self.world):
                if path not in self.views:
                    with suppress(OSError):
                        self._read_neighbour(path, package, known, recall)
        self._finder = IncludeFinder(self._all_views())
        for view in self._all_views():
            self._note_includes(view.path)
        self._merge_includes()

    def read_again(self, path: str) -> Iterator[str]:
        """Read a changed launch file; yield the files whose including files change by that."""
        before = self.inclusions
        if path in self.neighbours:
            self._read_neighbour(path, self.neighbours[path].package)
        else:
            self._read_view(path)
        self._note_includes(path)
        self._merge_includes()
        for each in self.views:
            same = before.passed.get(each) == self.inclusions.passed.get(each)
            if not same or (each in before.tags) != (each in self.inclusions.tags):
                yield each

    def stays_as_it_is(self, path: str) -> bool:
        """Return whether a changed file is still checked in the same way."""
        if path.rpartition("/")[2] in _STRUCTURE or not self.world.is_file(path):
            return False
        if path in self.targets.programs:
            return is_script(path, self.world)
        if path in self.views or path in self.neighbours:
            data = self.world.read_bytes(path)
            is_named_so = path.endswith((".launch", ".launch.xml", ".launch.yaml", ".launch.yml"))
            return is_named_so or b"<launch" in data or b"generate_launch_description" in data
        return path in self._yaml or not may_be_checked(path)

    def checked_as(self, path: str) -> str:
        """Return the kind of file that a path is checked as; empty for a file that is not checked."""
        return "launch file" if path in self.views else "YAML file" if path in self._yaml else ""

    def views_of(self, package: Package) -> tuple[LaunchView, ...]:
        """Return the checked launch files of a package."""
        return tuple(self.views[path] for path in self._paths_of.get(package.folder, ()))

    def read_text(self, path: str) -> SourceFile | None:
        """Read a text in UTF-8; None if it cannot be read."""
        try:
            return SourceFile(path, self.world.read_bytes(path).decode("utf-8"))
        except (OSError, UnicodeDecodeError):
            return None

    def _read_view(
        self, path: str, known: Mapping[str, LaunchSurvey] = _NOTHING, recall: RecallOutline = _recall_nothing
    ) -> None:
        try:
            self.views[path] = self._survey(path, self.targets.package_of(path), known, recall)
        except OSError as problem:
            reason = (problem.strerror or str(problem)).lower()
            self.unreadable[path] = error(
                f"{path}: {reason}, expected a readable text", Span(SourceFile(path, ""), 0, 0), rule="unreadable-file"
            )
            return
        self.comments[path] = self.outlines[path].comments
        if (package := self.views[path].package) is not None:
            self._paths_of.setdefault(package.folder, {})[path] = None

    def _read_neighbour(
        self,
        path: str,
        package: Package | None,
        known: Mapping[str, LaunchSurvey] = _NOTHING,
        recall: RecallOutline = _recall_nothing,
    ) -> None:
        self.neighbours[path] = self._survey(path, package, known, recall)

    def _survey(
        self, path: str, package: Package | None, known: Mapping[str, LaunchSurvey], recall: RecallOutline
    ) -> LaunchView:
        survey = known.get(path)
        view = (
            LaunchView(path, package, self.world, survey) if survey else survey_launch_file(path, package, self.world)
        )
        self.outlines[path] = recall(path) or outline_of(view)
        return view

    def _note_includes(self, path: str) -> None:
        outline = self.outlines[path]
        self._includes[path] = self._finder.find(outline.source, outline.includes)

    def _all_views(self) -> Iterable[LaunchView]:
        return (*self.views.values(), *self.neighbours.values())

    def _merge_includes(self) -> None:
        # In the order of the files, so that the first named one stays the same.
        self.inclusions = merge_includes(self._includes[view.path] for view in self._all_views())
