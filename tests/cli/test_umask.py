"""What `ur` writes is never writable for everybody, whatever the shell has set, and obeys a stricter shell."""

import os
import stat
import subprocess
import sys
from pathlib import Path

import pytest

LAUNCH = '<launch>\n  <node name="a" pkg="p" type="t"/>\n</launch>\n'


@pytest.mark.parametrize("mask", [0o000, 0o022, 0o077])
def test_nothing_is_written_that_others_may_write(tmp_path: Path, mask: int) -> None:
    (tmp_path / "a.launch").write_text(LAUNCH)
    variables = {key: value for key, value in os.environ.items() if not key.startswith("XDG_")}
    before = set(tmp_path.rglob("*"))
    for words in (
        ["use", "sim:magni"],
        ["docs", ".", "--output", "docs/a.md"],
        ["graph", "a.launch", "--output", "graph.txt"],
    ):
        subprocess.run(
            [sys.executable, "-I", "-m", "ur", *words],
            cwd=tmp_path,
            env={**variables, "HOME": str(tmp_path)},
            umask=mask,
            capture_output=True,
            check=True,
        )
    made = set(tmp_path.rglob("*")) - before
    assert {path.name for path in made} >= {"selection", "a.md", "graph.txt"}
    forbidden = 0o077 if mask == 0o077 else 0o002
    assert [path for path in made if stat.S_IMODE(path.lstat().st_mode) & forbidden] == []
