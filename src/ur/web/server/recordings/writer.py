"""Programs that write topics into files: `rosbag record`. Another format needs another `RecordingWriter`."""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Protocol

from ur.web.server.recordings.topics import TopicSelection

_PART = 512  # MB after which the next file begins
_BUFFER = 64  # MB that wait for the disk


class NoWriterError(Exception):
    """The program is not installed; the text names the missing part."""


class RecordingWriter(Protocol):
    """A program that writes until it gets SIGINT, and then completes its files."""

    @property
    def ending(self) -> str:
        """The ending of its file names."""

    @property
    def unfinished(self) -> str:
        """The ending of the names of incomplete files."""

    def make_command(self, stem: Path, selection: TopicSelection) -> list[str]:
        """Return the command that writes files whose paths begin with `stem`. Raises NoWriterError."""


class Rosbag:
    """Writes bags of format 2.0, compressed by LZ4, in parts."""

    ending = ".bag"
    unfinished = ".bag.active"

    def __init__(self, environment: Mapping[str, str]) -> None:
        self._path = environment.get("PATH")

    def make_command(self, stem: Path, selection: TopicSelection) -> list[str]:
        """Return the program behind `rosbag record`, without its wrapper, which would be a second process."""
        command = shutil.which("rosbag", path=self._path)
        program = Path(command).resolve().parents[1] / "lib" / "rosbag" / "record" if command else None
        if program is None or not program.is_file():
            raise NoWriterError("rosbag is not installed on the computer that serves the page: python3-rosbag")
        options = ["--quiet", "--lz4", "--split", "--size", str(_PART), "--buffsize", str(_BUFFER), "-O", str(stem)]
        if selection.topics:
            return [str(program), *options, *selection.topics]
        return [str(program), *options, "--all", "--exclude", selection.left_out]
