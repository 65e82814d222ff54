"""Starting a node's module: messages of a workspace are found, after everything of ours."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

NODE = "import json, sys\nfrom my_messages.msg import Bump\nprint(json.__file__, Bump)\n"


def test_messages_in_pythonpath_are_found_and_replace_nothing(tmp_path: Path) -> None:
    workspace, folder = tmp_path / "devel", tmp_path / "elsewhere"
    (workspace / "my_messages").mkdir(parents=True)
    (workspace / "my_messages/msg.py").write_text("Bump = 'found'\n")
    (workspace / "json.py").write_text("raise SystemExit('replaced')\n")
    (workspace / "a_node.py").write_text(NODE)
    folder.mkdir()
    (folder / "my_messages.py").write_text("raise SystemExit('of the current folder')\n")
    done = subprocess.run(
        [sys.executable, "-I", "-m", "ur_nodes", "a_node"],
        cwd=folder,
        env={"PATH": os.environ["PATH"], "PYTHONPATH": f":.:{workspace}", "ROS_LOG_DIR": str(tmp_path)},
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )
    assert done.stdout.endswith("json/__init__.py found\n"), done.stderr
