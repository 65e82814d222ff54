"""This project on a robot: a copy of what it needs to run there, as a wanted state.

The copy is ~/ubiquity_launches: beside the workspace, so that `ur sync` does not carry it back. Its `ur` sets itself up
there when it is first used, which needs the internet. A robot whose user has a clone of the project, there or in the
workspace, keeps that.
"""

from __future__ import annotations

import base64
import hashlib
import json
import os
import zlib
from dataclasses import dataclass, field
from pathlib import Path

from ur.robot import repository_side
from ur.robot.setup.change import Change, Command
from ur.robot.setup.facts import Facts, Request
from ur.robot.ssh.shell import quote

COPY = "~/ubiquity_launches"
WORKSPACE_COPY = "~/catkin_ws/src/ubiquity_launches"
STAMP = f"{COPY}/{repository_side.STAMP}"
# What runs, and what it is set up with: no tests, no documents, nothing that was made on this computer.
PARTS = (
    "src",
    "ubiquity_launches",
    "requirements",
    "tools/set_up.bash",
    "ur",
    "pyproject.toml",
    "README.md",
    "LICENSE",
)
_LEFT_OUT = ("__pycache__", ".egg-info", ".pyc")
SECONDS = 300.0


@dataclass(frozen=True, slots=True)
class WantedRepository:
    """A copy of this project on a robot. `files` are by path: mode and content; with mode 0 a link and its target."""

    digest: str
    files: dict[str, tuple[int, bytes]] = field(repr=False)
    title: str = "ubiquity_launches"

    def request(self, user: str) -> Request:
        """Whether there is one, and which."""
        return Request(user, files=frozenset({COPY, WORKSPACE_COPY, STAMP}))

    def plan(self, facts: Facts) -> Change | None:
        """Copy it, unless the same copy is there, or a clone of the user's own."""
        stamp = facts.file(STAMP).text
        own = facts.file(WORKSPACE_COPY).folder or (facts.file(COPY).folder and stamp is None)
        if own or (stamp or "").strip() == self.digest:
            return None
        source = base64.b64encode(zlib.compress(Path(repository_side.__file__).read_bytes())).decode()
        code = f"import base64,zlib;exec(zlib.decompress(base64.b64decode('{source}')))"
        files = {path: (mode, base64.b64encode(content).decode()) for path, (mode, content) in self.files.items()}
        text = json.dumps({"folder": facts.resolve(COPY), "digest": self.digest, "files": files})
        size = sum(len(content) for _, content in self.files.values()) / 1e6
        difference = f"{COPY}: {'a new copy' if stamp is None else 'the copy is renewed'}, {size:.1f} MB"
        command = Command(quote("python3", "-I", "-c", code), stdin=text, timeout=SECONDS)
        return Change(self.title, difference, (command,))

    def undo(self, facts: Facts) -> Change | None:  # noqa: ARG002 - of the protocol
        """It stays: what starts at boot may need it."""
        return None


def read_repository(root: Path) -> WantedRepository:
    """The copy that a robot is to have, from this project's folder on this computer."""
    files: dict[str, tuple[int, bytes]] = {}
    for part in PARTS:
        place = root / part
        for path in sorted(place.rglob("*")) if place.is_dir() else [place]:
            name = str(path.relative_to(root))
            if any(each in name for each in _LEFT_OUT):
                continue
            if path.is_symlink():
                files[name] = (0, os.fsencode(path.readlink()))
            elif path.is_file():
                files[name] = (0o755 if os.access(path, os.X_OK) else 0o644, path.read_bytes())
    digest = hashlib.sha256()
    for name, (mode, content) in sorted(files.items()):
        digest.update(f"{name}\0{mode}\0{len(content)}\0".encode() + content)
    return WantedRepository(digest.hexdigest(), files)
