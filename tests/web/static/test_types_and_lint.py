"""Types (JSDoc, checked by tsc) and a linter for the page's scripts.

Both come from npm, in the versions of requirements/npm.
"""

import json
import subprocess
from pathlib import Path

import pytest
from tests.npm_packages import PAGE

from ur.web.server.static_files import FOLDER

PROGRAMS = PAGE / "node_modules/.bin"
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

pytestmark = [
    pytest.mark.timeout(300),
    pytest.mark.skipif(not PROGRAMS.exists(), reason="tsc is not installed: bash tools/set_up.bash test, with npm"),
]


def test_scripts_are_typed(tmp_path: Path) -> None:
    for script in FOLDER.rglob("*.js"):
        assert script.read_text().startswith("// @ts-check\n"), script.name
    settings = tmp_path / "tsconfig.json"
    settings.write_text(json.dumps({"compilerOptions": OPTIONS, "include": [f"{FOLDER}/**/*.js"]}))
    command = [str(PROGRAMS / "tsc"), "--pretty", "false", "-p", str(settings)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=240, check=False)
    assert done.returncode == 0, done.stdout
    broken = tmp_path / "broken.js"  # it does see what is wrong
    broken.write_text("// @ts-check\n/** @param {number} x */\nexport function twice(x) {\n  return x.length;\n}\n")
    settings.write_text(json.dumps({"compilerOptions": OPTIONS, "include": [str(broken)]}))
    done = subprocess.run(command, capture_output=True, text=True, timeout=240, check=False)
    assert "broken.js(4,12)" in done.stdout


def test_scripts_are_free_of_what_the_linter_finds(tmp_path: Path) -> None:
    command = [str(PROGRAMS / "oxlint"), *RULES, *LIVE]
    done = subprocess.run([*command, str(FOLDER)], capture_output=True, text=True, timeout=240, check=False)
    assert done.returncode == 0, done.stdout
    (tmp_path / "broken.js").write_text("var x = 1;\nif (x == '1') eval('x');\n")
    done = subprocess.run([*command, str(tmp_path)], capture_output=True, text=True, timeout=240, check=False)
    assert done.returncode == 1
    assert all(rule in done.stdout for rule in ("eqeqeq", "no-var", "no-eval"))
