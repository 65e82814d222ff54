"""`ur check --watch` in a process: a report at the start, and one for each change."""

import os
import signal
import subprocess
import sys
from pathlib import Path

# A file is replaced whole: half of one would be checked, too.
RIGHT = '<launch>\n  <arg name="speed" default="1"/>\n  <param name="v" value="$(arg speed)"/>\n</launch>\n'


def put(path: Path, text: str) -> None:
    path.with_name(".new").write_text(text)
    path.with_name(".new").replace(path)


def test_check_is_repeated_when_files_are_written_made_and_removed(tmp_path: Path) -> None:
    (tmp_path / "package.xml").write_text("<package><name>demo</name></package>")
    path = tmp_path / "a.launch"
    put(path, RIGHT)
    command = [sys.executable, "-I", "-m", "ur", "check", "--watch", "--format", "github", str(tmp_path)]
    environment = {**os.environ, "ROS_PACKAGE_PATH": "", "XDG_CACHE_HOME": str(tmp_path / "cache")}
    process = subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=environment)
    try:
        assert process.stdout is not None
        put(path, RIGHT.replace("arg speed", "arg sped"))
        assert "undeclared-argument" in process.stdout.readline()
        put(tmp_path / "b.launch", RIGHT.replace("arg speed", "arg spd"))
        assert {process.stdout.readline().partition(",")[0] for _ in range(2)} == {
            f"::error file={tmp_path}/a.launch",
            f"::error file={tmp_path}/b.launch",
        }
        path.unlink()
        assert process.stdout.readline().startswith(f"::error file={tmp_path}/b.launch,")
    finally:
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=60)
    assert "Traceback" not in errors
