from __future__ import annotations

import os
from pathlib import Path

from ur_nodes.exploration.saved import saved_map


def test_only_a_map_of_this_exploration_counts(tmp_path: Path) -> None:
    assert saved_map(tmp_path / "flat", 100.0) is None
    file = tmp_path / "flat.yaml"
    file.write_text("image: flat.pgm\n")
    os.utime(file, (200.0, 200.0))
    assert saved_map(tmp_path / "flat", 100.0) == file
    assert saved_map(tmp_path / "flat", 300.0) is None
