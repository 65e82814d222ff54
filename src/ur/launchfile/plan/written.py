"""Files that a launch file writes when it starts, in a folder of the run, and the texts that name them."""

import posixpath
import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from ur.launchfile.plan.commands import RunWith

LOG_FOLDER = "<launch-log-dir>"
"""Stands for the folder of the run's log files, which does not exist before the start."""

_FOLDER = "written"
_TEMPORARY = re.compile(r"/tmp/[^/]+(?=/)")  # noqa: S108 - a folder of the launch file, with all that it writes there


class WrittenFiles:
    """The files of a plan: paths, and texts by `str`."""

    def __init__(self, written: Iterable[tuple[str, object]]) -> None:
        self._written = dict(written)
        self._folders = {match[0] for path in self._written if (match := _TEMPORARY.match(path))}
        paths = sorted({*self._written, *self._folders}, key=len, reverse=True)
        before = {True: r"(?<![\w.-])", False: r"(?<![\w./-])"}
        parts = (f"{before[path[:1] == '/']}{re.escape(path)}" for path in paths if path)
        self._paths = re.compile(rf"(?:{'|'.join(parts)})(?![\w-]|\.\w)") if paths else None

    def move(self, text: str, folder: str, files: dict[str, str]) -> str:
        """Return a text in which written files are in a folder. Their texts are added to `files`, by names below it."""
        if self._paths is None:
            return text

        def place(match: re.Match[str]) -> str:
            path = match[0]
            inner = [path] if path in self._written else [each for each in self._written if each.startswith(f"{path}/")]
            for each in inner:
                if _name(each) not in files:
                    files[_name(each)] = ""  # it may name itself
                    files[_name(each)] = self.move(str(self._written[each]), folder, files)
            return f"{folder}/{_name(path)}"

        return self._paths.sub(place, text)


def _name(path: str) -> str:
    return _FOLDER + posixpath.normpath(f"/{path}").replace("//", "/")


def run_with_files(
    words: Sequence[str], environment: Mapping[str, str], written: Mapping[str, object], run: RunWith
) -> tuple[int, bytes, bytes]:
    """Run a command as `run` does; it finds the written files that it names. Raises OSError."""
    if not any(path in word for path in written for word in words):
        return run(words, environment)
    from tempfile import TemporaryDirectory  # few files

    with TemporaryDirectory() as folder:
        files: dict[str, str] = {}
        moved = [WrittenFiles(written.items()).move(word, folder, files) for word in words]
        for name, text in files.items():
            path = Path(folder, name)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        return run(moved, environment)
