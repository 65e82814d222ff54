"""The file that the map is saved to while it grows."""

from __future__ import annotations

from pathlib import Path


def saved_map(name: Path, since: float) -> Path | None:
    """Return the YAML file of the map `name` if it was written after `since` (Unix seconds); None if it was not."""
    file = name.with_name(f"{name.name}.yaml")
    try:
        return file if file.stat().st_mtime >= since else None
    except OSError:
        return None
