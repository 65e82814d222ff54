"""Types (JSDoc, checked by tsc) and a linter for the page's scripts.

Both come from npm with the computer's own settings, in these versions, into `.cache`; nothing of them is committed.
"""

from __future__ import annotations

import fcntl
import json
import shutil
import subprocess
from pathlib import Path

import pytest

from ur.web.server.static_files import FOLDER

ROOT = Path(__file__).parents[3]
PACKAGES = ("typescript@5.9.3", "oxlint@1.31.0")
CACHE = ROOT / ".cache" / "npm" / "_".join(PACKAGES)
OPTIONS = {
    "allowJs": True,
    "checkJs": True,
    "noEmit": True,
    "strict": True,
    "noUnusedLocals": True,
    "noUnusedParameters": True,
    "noImplicitReturns": True,
    "noImplicitOverride": True,
    "noFallthroughCasesInSwitch": True,
    "target": "es2022",
    "module": "es2022",
    "moduleResolution": "bundler",
    "lib": ["es2022", "dom", "dom.iterable"],
    "types": [],
}
RULES = ("--deny", "correctness", "--deny", "eqeqeq", "--deny", "no-var", "--deny", "no-eval", "--deny", "prefer-const")
LIVE = ("--allow", "no-useless-spread")  # a copy of a live collection of elements is taken for useless

pytestmark = [pytest.mark.long, pytest.mark.timeout(300)]


@pytest.fixture(scope="module")
def programs() -> Path:
    """The folder of tsc and oxlint."""
    npm, folder = shutil.which("npm"), CACHE / "node_modules" / ".bin"
    if npm is None:
        pytest.skip("npm is not installed")
    CACHE.mkdir(parents=True, exist_ok=True)
    with (CACHE / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not all((folder / name).exists() for name in ("tsc", "oxlint")):
            command = [
                npm,
                "install",
                "--no-save",
                "--no-audit",
                "--no-fund",
                "--ignore-scripts",
                "--prefix",
                str(CACHE),
            ]
            done = subprocess.run(
                [*command, *PACKAGES], capture_output=True, text=True, timeout=240, cwd=CACHE, check=False
            )
            if done.returncode:
                pytest.skip(f"npm cannot install {' and '.join(PACKAGES)}: {done.stderr.strip()[-200:]}")
    return folder


def test_scripts_are_typed(programs: Path, tmp_path: Path) -> None:
    for script in FOLDER.rglob("*.js"):
        assert script.read_text().startswith("// @ts-check\n"), script.name
    settings = tmp_path / "tsconfig.json"
    settings.write_text(json.dumps({"compilerOptions": OPTIONS, "include": [f"{FOLDER}/**/*.js"]}))
    command = [str(programs / "tsc"), "--pretty", "false", "-p", str(settings)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=240, check=False)
    assert done.returncode == 0, done.stdout
    broken = tmp_path / "broken.js"  # it does see what is wrong
    broken.write_text("// @ts-check\n/** @param {number} x */\nexport function twice(x) {\n  return x.length;\n}\n")
    settings.write_text(json.dumps({"compilerOptions": OPTIONS, "include": [str(broken)]}))
    done = subprocess.run(command, capture_output=True, text=True, timeout=240, check=False)
    assert "broken.js(4,12)" in done.stdout


def test_scripts_are_free_of_what_the_linter_finds(programs: Path, tmp_path: Path) -> None:
    command = [str(programs / "oxlint"), *RULES, *LIVE]
    done = subprocess.run([*command, str(FOLDER)], capture_output=True, text=True, timeout=240, check=False)
    assert done.returncode == 0, done.stdout
    (tmp_path / "broken.js").write_text("var x = 1;\nif (x == '1') eval('x');\n")
    done = subprocess.run([*command, str(tmp_path)], capture_output=True, text=True, timeout=240, check=False)
    assert done.returncode == 1
    assert all(rule in done.stdout for rule in ("eqeqeq", "no-var", "no-eval"))
