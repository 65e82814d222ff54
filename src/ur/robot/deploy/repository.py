"""Desired states for this project on a robot: a copy of the required files, and the Python environment.

The copy is in ~/ubiquity_launches, outside the workspace, so that `ur sync` does not copy it back. A robot whose user
has a clone of the project, in that folder or in the workspace, keeps the clone.
"""

import base64
import hashlib
import json
import os
import zlib
from dataclasses import dataclass, field
from pathlib import Path

from ur.robot.deploy import repository_side
from ur.robot.setup.change import Change, ChangeScript
from ur.robot.setup.facts import ComputerFacts, FactsRequest
from ur.robot.ssh.shell import quote
from ur.source.project import list_files, project_file

COPY = "~/ubiquity_launches"
WORKSPACE_COPY = "~/catkin_ws/src/ubiquity_launches"
STAMP = f"{COPY}/{repository_side.STAMP}"
# The sources of the environment: tools/set_up.bash writes their digest to the second line of its stamp.
SET_UP_FROM = ("requirements/run.lock", "tools/set_up.bash", "src/ur/system/ros_packages.txt", "pyproject.toml")
READY = ".venv/ready-run"
SECONDS = 300.0
SET_UP_SECONDS = 3600.0
# Only one set-up of a robot runs at a time, so one that is still running belongs to a viewer that has disconnected:
# it may wait for a proxy that no longer exists.
_SET_UP = """\
cd {folder} && mkdir -p .cache || exit
old=$(cat .cache/set_up.pid 2>/dev/null) && grep -qs set_up.bash "/proc/$old/cmdline" && kill "$old"
bash tools/set_up.bash run >.cache/set_up.out 2>&1 </dev/null &
echo $! >.cache/set_up.pid; wait $!; code=$?; rm -f .cache/set_up.pid
[ $code -eq 0 ] || {{
  why=$(sed -n 's/^  | ERROR: //p' .cache/set_up.out | tail -n 1)
  echo "$(sed -n 's/^error: //p' .cache/set_up.out | tail -n 1)${{why:+: $why}}"
}} >&2
exit $code"""


@dataclass(frozen=True, slots=True)
class WantedRepository:
    """A copy of this project on a robot.

    `files` are keyed by path: mode and content; mode 0 is a symbolic link, with its target as content.
    """

    digest: str
    files: dict[str, tuple[int, bytes]] = field(repr=False)
    title: str = "ubiquity_launches"

    def request(self, user: str) -> FactsRequest:
        """Request the installed repository."""
        return FactsRequest(user, files=frozenset({COPY, WORKSPACE_COPY, STAMP}))

    def plan(self, facts: ComputerFacts) -> Change | None:
        """Copy the project, unless the same copy or the user's own clone exists."""
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
        command = ChangeScript(quote("python3", "-I", "-c", code), stdin=text, timeout=SECONDS)
        return Change(self.title, difference, (command,))

    def undo(self, facts: ComputerFacts) -> Change | None:  # noqa: ARG002 - of the protocol
        """Return None: the copy stays, since boot services may need it."""
        return None


@dataclass(frozen=True, slots=True)
class WantedPrograms:
    """The environment in which programs of this project run: the locked Python packages beside the system's.

    The The required Debian packages must be installed. `digest` is that of the files in SET_UP_FROM.
    """

    digest: str
    title: str = "programs"

    def request(self, user: str) -> FactsRequest:
        """Request the project's folders, and the record of what the environment was made from."""
        stamps = {f"{folder}/{READY}" for folder in (COPY, WORKSPACE_COPY)}
        return FactsRequest(user, files=frozenset({COPY, WORKSPACE_COPY, STAMP, *stamps}))

    def plan(self, facts: ComputerFacts) -> Change | None:
        """Create the environment. In the user's own clone it is created once, and then updated by that clone's `ur`."""
        folder = WORKSPACE_COPY if facts.file(WORKSPACE_COPY).folder else COPY
        made = facts.file(f"{folder}/{READY}").text
        own = folder == WORKSPACE_COPY or facts.file(STAMP).text is None
        if made is not None and (own or made.splitlines()[1:2] == [self.digest]):
            return None
        script = _SET_UP.format(folder=quote(facts.resolve(folder)))
        log = facts.resolve(f"{folder}/.cache/set_up.log")
        difference = f"{folder}/.venv: {'a new environment' if made is None else 'the environment is renewed'}"
        command = ChangeScript(script, timeout=SET_UP_SECONDS, fetches=True, log=log)
        return Change(self.title, difference, (command,), note="this takes some minutes")

    def undo(self, facts: ComputerFacts) -> Change | None:
        """Remove the environment of a copy. That of a clone of the user's own stays."""
        if facts.file(f"{COPY}/{READY}").text is None or facts.file(STAMP).text is None:
            return None
        folder = quote(facts.resolve(COPY))
        command = ChangeScript(f"rm -rf {folder}/.venv {folder}/.cache", timeout=SECONDS)
        return Change(self.title, f"{COPY}/.venv: removed", (command,))


def read_programs(root: Path | None = None) -> WantedPrograms:
    """Return the desired environment of a robot: that of the running project, or of a clone at `root`."""
    digest = hashlib.sha256()
    for name in SET_UP_FROM:
        digest.update((root / name if root else project_file(name)).read_bytes())
    return WantedPrograms(digest.hexdigest())


def read_repository(root: Path | None = None) -> WantedRepository:
    """Return the desired copy for a robot: of the running project, clone or wheel, or of a clone at `root`."""
    files: dict[str, tuple[int, bytes]] = {}
    for name, path, target in list_files(root):
        if target:
            files[name] = (0, os.fsencode(target))
        else:
            files[name] = (0o755 if os.access(path, os.X_OK) else 0o644, path.read_bytes())
    digest = hashlib.sha256()
    for name, (mode, content) in sorted(files.items()):
        digest.update(f"{name}\0{mode}\0{len(content)}\0".encode() + content)
    return WantedRepository(digest.hexdigest(), files)
