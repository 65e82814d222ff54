import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from ur.request.requirements.python_packages import need_all, run_installer
from ur.source.diagnostic import UserError

# Stands in for pip: makes the module whose name is in the requirements file, or fails as pip does.
PIP = """
import sys
from pathlib import Path
name = Path(sys.argv[-1]).read_text().strip()
print("Collecting", name)
if name == "broken":
    print("ERROR: No matching distribution found for broken")
    sys.exit(1)
with open("made.txt", "a") as made:
    made.write(" ".join(sys.argv[1:-1]) + "\\n")
Path(name + ".py").write_text("")
"""


@pytest.fixture
def pip(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    (tmp_path / "requirements").mkdir()
    (tmp_path / "pip.py").write_text(PIP)
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    return [sys.executable, str(tmp_path / "pip.py")]


def test_what_is_missing_is_installed_once_with_its_hashes(
    tmp_path: Path, pip: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "requirements" / "x.lock").write_text("made_on_demand\n")
    for _ in range(2):
        need_all(["made_on_demand", "json"], "x.lock", "a module (1 kB)", folder=tmp_path, pip=pip)
    (line,) = (tmp_path / "made.txt").read_text().splitlines()
    assert "--require-hashes" in line
    assert "--only-binary :all:" in line
    shown = capsys.readouterr().err.splitlines()
    assert shown[0] == "installing a module (1 kB), once ..."
    assert shown[1].startswith("installed in ")
    assert len(shown) == 2


def test_failure_is_told_in_pips_words(tmp_path: Path, pip: list[str]) -> None:
    (tmp_path / "requirements" / "x.lock").write_text("broken\n")
    with pytest.raises(UserError, match="broken could not be installed: No matching distribution found for broken"):
        need_all(["broken"], "x.lock", "a module", folder=tmp_path, pip=pip)


def test_pip_that_cannot_be_started_is_told(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"missing_module could not be installed: .*No such file"):
        need_all(["missing_module"], "x.lock", "a module", folder=tmp_path, pip=["/no/such/pip"])


def test_copy_of_somebody_else_is_not_changed(tmp_path: Path) -> None:
    (tmp_path / ".cache").write_text("")  # in the way of the folder
    with pytest.raises(UserError, match="expected a copy of this project that is yours to write to"):
        need_all(["missing_module"], "x.lock", "a module", folder=tmp_path)


def test_ctrl_c_ends_an_installation_that_runs_as_root() -> None:
    @contextmanager
    def show_progress(_text: str) -> Iterator[Callable[[str], None]]:
        def interrupt(_line: str) -> None:
            raise KeyboardInterrupt

        yield interrupt

    def refuse(_process: object) -> None:
        raise PermissionError(1, "Operation not permitted")

    with pytest.raises(KeyboardInterrupt):
        run_installer(["echo", "begun"], "something", "nothing", show=show_progress, end=refuse)
