"""A robot that lies in every answer: each command ends with one line for it, and nothing of its answers acts here."""

import os
import re
from pathlib import Path

import pytest
from tests.forking import python_of_ur

# In place of ssh: logins succeed, and each command gets a lie of the kind that the file names.
SSH = r"""#!/bin/bash
last=${@: -1}
case "$*" in
*ControlMaster=yes*) echo; echo ubiquity: logged in; exec cat >/dev/null ;;
*"-O forward"*) echo 80x; exit ;;
esac
case $(cat "${0%/*}/kind") in
noise) cat >/dev/null & head -c 5000 /dev/urandom; printf '\e]52;c;eA==\a\e[2J\n' ;;
marks) for name in home hostname name system boot groups addresses broken disk modes host_key public_key; do
    printf '\036%s\n../../x\e[2J 7 $(touch "$HOME/executed") ²\n' $name; done; printf '\036end\n' ;;
paths) printf '{"files": {"../../executed": ["link", 0, 0, false, "/etc/passwd"]}, "skipped": {}, "ignore": [],'
  printf '"rsync": true, "root": "/x", "machine": "m"}' ;;
json) printf '{"files": [1], "skipped": 2, "ignore": {"a": "b"}, "rsync": [], "root": {}, "machine": null}' ;;
numbers) printf '²²²\n-1\n99999999999999999999999999999999999\nnan\ninf\n' ;;
nothing) ;;
twisted) bash -c "$last" 2>&1 | LC_ALL=C sed -E 's/[0-9]+/²/g; s/$/\x1b]0;x\x07/' ;;
codes) printf '\e]0;x\a../../x\n' >&2; exit 1 ;;
esac
"""
KINDS = ("noise", "marks", "paths", "json", "numbers", "nothing", "twisted", "codes")
COMMANDS = (
    "doctor eve",
    "devices --robot eve",
    "sync eve --yes",
    "boot status --robot eve",
    "boot install --robot eve",
    "robot network eve",
    "robot wifi eve",
    "robot calibrate eve --yes --password-from 0",
    "robot rename eve ann --password-from 0",
    "robot setup eve.local --name eve --base magni --no-programs --robot-login --passwords-from 0",
)


@pytest.fixture
def home(tmp_path: Path) -> Path:
    """The home folder of a user who has set up the robot `eve`."""
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin/ssh").write_text(SSH)
    (tmp_path / "bin/ssh").chmod(0o755)
    (tmp_path / "bin/sudo").write_text("#!/bin/sh\nexit 1\n")
    (tmp_path / "bin/sudo").chmod(0o755)
    (tmp_path / "catkin_ws/src").mkdir(parents=True)
    folder = tmp_path / ".config/ubiquity_launches/robots"
    folder.mkdir(parents=True)
    (folder / "eve.yaml").write_text('name: "eve"\nuser: "ros"\nbase: "magni"\nrobot_login: true\n')
    (tmp_path / ".ssh").mkdir(mode=0o700)
    (tmp_path / ".ssh/authorized_keys").write_text("")
    return tmp_path


def snapshot(home: Path) -> dict[str, bytes]:
    """The files that decide who logs in and what runs, and what lies beside the home folder."""
    files = [path for place in (".ssh", ".config", "catkin_ws/src") for path in (home / place).rglob("*")]
    beside = {path.name: b"" for path in home.parent.iterdir()}
    return {str(path): path.read_bytes() for path in files if path.is_file() and "id_ed25519" not in path.name} | beside


@pytest.mark.parametrize("kind", KINDS)
def test_lies_are_named_and_nothing_of_them_acts(home: Path, kind: str) -> None:
    (home / "bin/kind").write_text(kind)
    environment = {**os.environ, "HOME": str(home), "PATH": f"{home}/bin:{os.environ['PATH']}", "LC_ALL": "C.UTF-8"}
    before: dict[str, bytes] = {}
    for words in COMMANDS:
        done = python_of_ur().run(
            "ur", *words.split(), folder=home, environment=environment, given=b"secret-1\nsecret-2\n"
        )
        said = (done.stdout + done.stderr).decode(errors="replace")
        assert "Traceback" not in said, f"{words}: {said}"
        assert "internal error" not in said, f"{words}: {said}"
        assert not re.search(r"[\x00-\x08\x0b-\x1f\x7f-\x9f]", said), f"{words}: {said!r}"
        assert "secret-" not in said
        assert not (home / "executed").exists(), words
        if "rename" not in words and "setup" not in words:  # which may make this user's own keys
            assert not before or snapshot(home) == before, words
        before = snapshot(home)
        assert (home / ".ssh/authorized_keys").read_text().count("\n") <= 1  # this user's own key
