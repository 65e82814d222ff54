"""The build of sdist and wheel, for `pyproject.toml`: what runs and is no Python module becomes data of `ur`.

No file is committed twice: folders are copied as they are when a wheel is built, and left alone in a clone, where
`pip install --editable` leads to them. `ur.source.project` finds either.
No `setup.py`: colcon would take the repository for one package of Python, and not find the package of ROS in it.
"""

import shutil
import sys
from pathlib import Path

from setuptools.command.build_py import build_py
from setuptools.command.sdist import sdist

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "src"))

from ur.source.project import DATA_FOLDER, LINKS, list_files  # noqa: E402 - found by the line above


class BuildWithProject(build_py):
    """Copy Python modules, then the launch library, the locks and the set-up."""

    def run(self) -> None:
        """Build into `build_lib`."""
        super().run()
        if self.editable_mode:
            return
        for name, path, _ in self._list_project():
            to = self._folder() / name
            to.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(path, to)  # what a link leads to: a wheel holds no links
        write_links(self._folder())

    def get_outputs(self, include_bytecode: bool = True) -> list[str]:
        """List what is built."""
        names = [] if self.editable_mode else [LINKS, *(name for name, _, _ in self._list_project())]
        return [*super().get_outputs(include_bytecode), *(str(self._folder() / name) for name in names)]

    def _folder(self) -> Path:
        return Path(self.build_lib) / "ur" / DATA_FOLDER

    def _list_project(self) -> list[tuple[str, Path, str]]:
        return [each for each in list_files(ROOT) if not each[0].startswith("src/")]


class ArchiveWithLinks(sdist):
    """Archive the files that MANIFEST.in lists, and where links lead."""

    def make_release_tree(self, base_dir: str, files: list[str]) -> None:
        """Make the folder that is archived."""
        super().make_release_tree(base_dir, files)
        write_links(Path(base_dir))


def write_links(folder: Path) -> None:
    """Write down which of the files, which are copies in this folder, are links in the project."""
    lines = [f"{name} {target}\n" for name, _, target in list_files(ROOT) if target]
    (folder / LINKS).write_text("".join(lines), encoding="utf-8")
