"""Starting a node's module: messages of a workspace are found, after everything of ours."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

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


@pytest.mark.parametrize(("given", "used"), [({}, "1"), ({"OPENBLAS_NUM_THREADS": "3"}, "3")])
def test_numpy_has_one_thread_unless_the_environment_sets_another_number(
    tmp_path: Path, given: dict[str, str], used: str
) -> None:
    (tmp_path / "a_node.py").write_text("import os\nprint(os.environ['OPENBLAS_NUM_THREADS'])\n")
    done = subprocess.run(
        [sys.executable, "-I", "-m", "ur_nodes", str(tmp_path / "a_node.py")],
        env={"PATH": os.environ["PATH"], "ROS_LOG_DIR": str(tmp_path), **given},
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )
    assert done.stdout == f"{used}\n", done.stderr
