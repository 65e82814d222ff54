"""Programs that write topics into files: `rosbag record`. Another format is another `RecordingWriter`."""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Protocol

from ur.web.server.recordings.topics import TopicSelection

_PART = 512  # MB after which the next file begins
_BUFFER = 64  # MB that wait for the disk


class NoWriterError(Exception):
    """The program is not installed; the text names what is missing."""


class RecordingWriter(Protocol):
    """A program that writes until it gets SIGINT, and then finishes its files."""

    @property
    def ending(self) -> str:
        """The ending of the names of its files."""

    @property
    def unfinished(self) -> str:
        """The ending of the names of files that are not finished."""

    def make_command(self, stem: Path, selection: TopicSelection) -> list[str]:
        """The command that writes files whose paths begin with `stem`. Raises NoWriterError."""


class Rosbag:
    """Writes bags of format 2.0, compressed by LZ4, in parts."""

    ending = ".bag"
    unfinished = ".bag.active"

    def __init__(self, environment: Mapping[str, str]) -> None:
        self._path = environment.get("PATH")

    def make_command(self, stem: Path, selection: TopicSelection) -> list[str]:
        """The program behind `rosbag record`, without the command in front of it, which would be a second process."""
        command = shutil.which("rosbag", path=self._path)
        program = Path(command).resolve().parents[1] / "lib" / "rosbag" / "record" if command else None
        if program is None or not program.is_file():
            raise NoWriterError("rosbag is not installed on the computer that serves the page: python3-rosbag")
        options = ["--quiet", "--lz4", "--split", "--size", str(_PART), "--buffsize", str(_BUFFER), "-O", str(stem)]
        if selection.topics:
            return [str(program), *options, *selection.topics]
        return [str(program), *options, "--all", "--exclude", selection.left_out]
