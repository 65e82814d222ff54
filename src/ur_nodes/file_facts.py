"""Facts of a run in a file, where the middleware keeps none without a node."""

import contextlib
import json
import os
from pathlib import Path
from typing import Any

from ur.source.replace import PRIVATE, replace_file
from ur.system.ros import find_facts, parameters_file


class FileFacts:
    """See `ports.facts.Facts`: a file of the run."""

    def __init__(self, *, simulated_time: bool, file: Path | None = None) -> None:
        self.simulated_time = simulated_time
        self._file = file or file_of_run()

    def get(self, name: str, default: object = None) -> Any:
        return self._read().get(name, default)

    def set(self, name: str, value: object) -> None:
        facts = self._read() | {name: value}
        self._file.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        replace_file(self._file, json.dumps(facts), mode=PRIVATE, follow=False, lasting=False)

    def _read(self) -> dict[str, object]:
        with contextlib.suppress(OSError, ValueError):
            found = json.loads(self._file.read_text())
            if isinstance(found, dict):
                return found
        return {}


def file_of_run() -> Path:
    """The file of the facts of this run."""
    return Path(find_facts(os.environ, os.environ.get("ROS_DOMAIN_ID") or "0"))


def given_parameters() -> Path:
    """Return the file with the parameters of all nodes, as the launch files of the runs give them."""
    return Path(parameters_file(str(file_of_run())))
