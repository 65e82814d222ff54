"""Generation of a launch repository's documents. Reads files through a World and writes nothing."""

import re
import shlex
from collections.abc import Iterator

from ur.docs.documents import BaseDoc, DirectoryDoc, Documents, LaunchDoc, PackageDoc, ProgramDoc, TreeDoc
from ur.docs.launch.launch_file import LaunchDescriber
from ur.docs.repository.bases import read_base
from ur.docs.repository.collect import DocumentedRepository, RepositoryPart, collect_repository, relative_path
from ur.docs.repository.comments import LaunchCall, find_starts, read_headings
from ur.docs.words import settle_links
from ur.launchfile.world import World
from ur.source.file import SourceFile
from ur.source.progress import Progress, counted, no_progress

_KINDS = {"n": "node", "m": "task", "rviz": "view"}
_DIRECTORY = re.compile(r"(n|m|rviz)_\w+\Z")


def build_documents(path: str, world: World) -> Documents:
    """Return the documents of a package, a folder of packages, or any folder with launch files.

    Raises UserError if there is no such folder, or no launch file in it. Invalid launch files are documented as such.
    """
    return describe_repository(collect_repository(path, world))


def describe_repository(repository: DocumentedRepository, progress: Progress = no_progress) -> Documents:
    """Return the documents of a collected repository."""
    describer = _Describer(repository, progress)
    packages = tuple(describer.describe_part(part) for part in repository.parts)
    return Documents(repository.root.rpartition("/")[2] or "/", repository.root, packages)


class _Describer:
    def __init__(self, repository: DocumentedRepository, progress: Progress) -> None:
        self.repository = repository
        self.progress = progress
        self.bases = {base.name: base for part in repository.parts for base in self.read_bases(part)}
        self.launches = LaunchDescriber(repository, self.bases)
        self.by_name: dict[str, list[str]] = {}
        for path in repository.views:
            self.by_name.setdefault(path.rpartition("/")[2], []).append(path)

    def read_bases(self, part: RepositoryPart) -> Iterator[BaseDoc]:
        for base in part.package.bases:
            yield read_base(f"{part.package.folder}/bases/{base.name}/base.yaml", base.name, self.repository.world)

    def describe_part(self, part: RepositoryPart) -> PackageDoc:
        programs = tuple(
            self.describe_program(source, part)
            for source in counted(part.programs, "describing", f"programs of {part.package.name}", self.progress)
        )
        started: dict[str, list[str]] = {}
        for program in programs:
            for path in program.starts:
                started.setdefault(path, []).append(program.path)
        launch_files = tuple(
            self.launches.describe(view, tuple(started.get(self.show(view.path), ())))
            for view in counted(part.views, "describing", f"launch files of {part.package.name}", self.progress)
        )
        folder = self.show(part.package.folder)
        own = {base.name for base in part.package.bases}
        return PackageDoc(
            name=part.package.name,
            path="" if folder == "." else folder,
            description=part.description,
            is_package=part.is_package,
            bases=tuple(base for name, base in self.bases.items() if name in own),
            programs=programs,
            directories=tuple(_group_by_directory(launch_files)),
            launch_files=launch_files,
        )

    def show(self, path: str) -> str:
        return relative_path(path, self.repository.root)

    def describe_program(self, source: SourceFile, part: RepositoryPart) -> ProgramDoc:
        headings = read_headings(source)
        starts = [(start, path) for start in find_starts(source) for path in self.find_file(start, part)]
        folder, _, name = source.path.rpartition("/")
        return ProgramDoc(
            path=self.show(source.path),
            name=name,
            command=self.how_to_run(name, source.path, part),
            summary=" ".join(headings.get("Summary", "").split()),
            overview=settle_links(headings.get("Overview", ""), self.show(folder), self.launches.exists),
            starts=tuple(dict.fromkeys(self.show(path) for _, path in starts)),
            trees=tuple(tree for start, path in starts for tree in self.describe_start(start, path)),
        )

    def describe_start(self, start: LaunchCall, path: str) -> tuple[TreeDoc, ...]:
        view = self.repository.views[path]
        given = tuple((name, value) for name, value in start.given if name in view.declared)
        return self.launches.describe_trees(view, given)

    def find_file(self, start: LaunchCall, part: RepositoryPart) -> Iterator[str]:
        # By name in the package that the program names, else in its own, else in the only one that has such a file.
        paths = self.by_name.get(start.file.rpartition("/")[2], [])
        for folder in (self.folder_of(start.before), part.package.folder):
            own = [path for path in paths if folder and path.startswith(f"{folder}/")]
            if own:
                yield own[0]
                return
        if len(paths) == 1:
            yield paths[0]

    def folder_of(self, package: str) -> str | None:
        return next((p.package.folder for p in self.repository.parts if p.package.name == package), None)

    def how_to_run(self, name: str, path: str, part: RepositoryPart) -> str:
        if name.startswith("ur_") and self.repository.world.is_file(f"{part.package.folder}/bin/ur"):
            return f"ur run {name.removeprefix('ur_')}"
        return f"rosrun {part.package.name} {name}" if part.is_package else shlex.quote(self.show(path))


def _group_by_directory(launch_files: tuple[LaunchDoc, ...]) -> Iterator[DirectoryDoc]:
    groups: dict[str, list[LaunchDoc]] = {}
    for doc in launch_files:
        groups.setdefault(doc.folder, []).append(doc)
    for folder, docs in sorted(groups.items()):
        name = folder.rpartition("/")[2]
        match = _DIRECTORY.match(name)
        main = next((doc for doc in docs if doc.name.partition(".")[0] == name), docs[0])
        summary = main.summary if len(docs) == 1 or main is not docs[0] or match else ""
        kind = _KINDS[match.group(1)] if match else "other"
        yield DirectoryDoc(folder, kind, summary, tuple(doc.path for doc in docs))  # type: ignore[arg-type]  # one of _KINDS
