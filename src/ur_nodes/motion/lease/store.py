"""The lease on the robot's disk, so that no published change is lost if the mux is killed."""

import json
import os
import zlib
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from ur.source.foreign.json_values import BadJsonError, read_json
from ur.source.replace import PRIVATE, replace_file, sync_folder
from ur_nodes.motion.lease.text import Lease, read_lease, write_lease

_LONGEST = 16384  # bytes


@dataclass(frozen=True, slots=True)
class LeaseStore:
    """The file of the lease of one mux. `run` is the id of the master's run; `sync` flushes a file to disk."""

    path: Path
    run: str = ""
    sync: Callable[[int], object] = os.fsync

    def load(self) -> tuple[Lease | None, bool]:
        """Return the lease and whether it is of this run of the master; None if there is none or it is damaged."""
        try:
            with self.path.open("rb") as file:
                value = read_json(file.read(_LONGEST), dict[str, object])
        except (OSError, BadJsonError):
            return None, True
        return read_lease(value.get("lease")), value.get("run") == self.run

    def save(self, lease: Lease) -> None:
        """Write the lease to disk. Raises OSError, after removing an older lease if possible."""
        try:
            text = json.dumps({"run": self.run, "lease": write_lease(lease)})
            replace_file(self.path, text, mode=PRIVATE, parents=True, sync=self.sync)
        except OSError:
            with suppress(OSError):
                self.clear()
            raise

    def clear(self) -> None:
        """Remove the file. Raises OSError."""
        with suppress(FileNotFoundError):
            self.path.unlink()
            sync_folder(str(self.path.parent))


def make_store(environment: Mapping[str, str], mux: str, run: str) -> LeaseStore:
    """Return the store of the mux with this node name, at the master or domain of the environment."""
    home = environment.get("ROS_HOME") or str(Path(environment.get("HOME") or os.sep) / ".ros")
    ros2 = environment.get("ROS_VERSION") == "2"
    graph = environment.get("ROS_DOMAIN_ID") or "0" if ros2 else environment.get("ROS_MASTER_URI", "")
    key = f"{graph}\0{mux}"
    name = f"{mux.strip('/').replace('/', '.')[:64]}-{zlib.crc32(key.encode()):08x}.json"
    return LeaseStore(Path(home, "ur_lease", name), run)
