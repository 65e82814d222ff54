import subprocess
import sys
from pathlib import Path

from ur.run.remote.own_clients import hold_client, list_clients

HOLD = """
import sys, pathlib
from ur.run.remote.own_clients import hold_client
with hold_client("b2", pathlib.Path(sys.argv[1])):
    print("held", flush=True)
    sys.stdin.read()
"""


def test_client_is_listed_while_it_runs(tmp_path: Path) -> None:
    folder = tmp_path / "clients"
    assert list_clients(folder) == []
    with hold_client("a1", folder):
        assert list_clients(folder) == ["a1"]
    assert list_clients(folder) == []
    assert list(folder.iterdir()) == []


def test_client_that_was_killed_is_not_listed_and_leaves_no_file(tmp_path: Path) -> None:
    process = subprocess.Popen(
        [sys.executable, "-c", HOLD, str(tmp_path)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    with process:
        assert process.stdout is not None
        assert process.stdout.readline() == "held\n"
        assert list_clients(tmp_path) == ["b2"]
        process.kill()
    assert list_clients(tmp_path) == []
    assert list(tmp_path.iterdir()) == []


def test_client_goes_on_where_its_file_cannot_be_made(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with hold_client("a1", tmp_path / "file"):
        assert list_clients(tmp_path / "file") == []
