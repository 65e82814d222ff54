"""The cameras of this computer as `ur devices` sees them."""

from __future__ import annotations

import subprocess
from pathlib import Path

from ur.devices.model import Snapshot
from ur.devices.observe import device_script, parse_devices

_SECONDS = 20.0
_MODEL = Path("/proc/device-tree/model")


def inspect_cameras() -> Snapshot:
    """Inspect the devices of this computer; an empty snapshot where that fails."""
    try:
        done = subprocess.run(
            ["sh", "-c", device_script()],
            capture_output=True,
            text=True,
            errors="replace",
            timeout=_SECONDS,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired):
        return Snapshot()
    return parse_devices(done.stdout)


def is_raspberry(model: Path = _MODEL) -> bool:
    """Return whether this computer is a Raspberry Pi."""
    try:
        return "Raspberry Pi" in model.read_text(encoding="utf-8", errors="replace")
    except OSError:
        return False
