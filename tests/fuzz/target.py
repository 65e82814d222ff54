"""The contract of a parser that is fuzzed, and all of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path

CORPUS = Path(__file__).with_name("corpus")


@dataclass(frozen=True, slots=True)
class Target:
    """A parser of foreign input: `run` gets one input and an empty scratch folder that it may use for files.

    `run` suppresses the exceptions that the parser declares and raises any other. `words` are what the format is made
    of, `seeds` give further inputs to start from than those in the corpus.
    """

    kind: str
    run: Callable[[bytes, Path], None]
    words: tuple[bytes, ...] = ()
    seeds: Callable[[], Sequence[bytes]] = field(default=tuple)

    def read_inputs(self) -> list[bytes]:
        """The inputs of the corpus, finds included, and the seeds."""
        kept = [path.read_bytes() for path in sorted((CORPUS / self.kind).glob("*")) if path.is_file()]
        return [*kept, *self.seeds()]


def list_kinds() -> tuple[str, ...]:
    """The kinds of input, in a fixed order."""
    return tuple(_KINDS)


def load_target(kind: str) -> Target:
    """The target of a kind. Imports only what that one needs, since the memory of the process counts."""
    targets: Sequence[Target] = import_module(f"tests.fuzz.targets.{_KINDS[kind]}").TARGETS
    return next(target for target in targets if target.kind == kind)


_KINDS = {
    "announcement": "announcements",
    "announcement_fields": "announcements",
    "xml_rpc": "xml_rpc",
    "run_json": "state_files",
    "run_events": "state_files",
    "remembered": "state_files",
    "robot_yaml": "state_files",
    "facts": "robots",
    "doctor": "robots",
    "networks": "robots",
    "services": "robots",
    "remote_run": "robots",
    "sync": "robots",
    "public_key": "robots",
    "launch": "launch_files",
    "launch_check": "launch_files",
    "parameters": "launch_files",
    "map": "maps",
    "world": "maps",
    "base": "maps",
    "waypoints": "maps",
    "fiducial_map": "maps",
    "picture": "maps",
    "lease": "lease",
    "package_xml": "packages",
    "partitions": "packages",
    "messages": "packages",
    "get": "folders",
    "map_folder": "folders",
    "archive": "folders",
    "urdf": "descriptions",
    "xacro": "descriptions",
    "device_bytes": "devices",
}
