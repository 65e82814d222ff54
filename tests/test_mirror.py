"""Tests lie where what they test lies: the tests of src/ur/x/y.py are in tests/x/, those of src/ur_nodes/x in
tests/ur_nodes/x, in a file named after the module or after the behaviour."""

from __future__ import annotations

import ast
from pathlib import Path

TESTS = Path(__file__).parent
SRC = TESTS.parent / "src"
# Folders of tests that mirror no folder of src, each with the reason.
OTHERS = {
    "bench": "tests of the programs in bench/",
    "data": "tests of the files in ubiquity_launches/",
    "documents": "tests of README.md and docs/",
    "e2e": "tests of whole programs on every base",
    "fresh": "the installation on an empty computer",
    "fuzz": "broken inputs for parsers of all packages",
    "hosts": "tests of several computers together",
    "ur_nodes/first_drive": "nodes together on a bus, from the simulator to the goal",
    "launchfile/fuzz": "broken launch files, also beside roslaunch",
    "tools": "tests of the programs in tools/; its folders are those of src/ur/tools/",
    "web/static": "modules of the page, which Node.js runs",
}
# Packages without a test file of their own, each with the place of its tests.
ELSEWHERE = {
    "ur/check/rules": "every rule holds its examples, which tests/check/test_rules.py runs",
    "ur/check/rules/library": "likewise",
    "ur/check/rules/text": "likewise",
    "ur/docs/launch": "whole documents: tests/docs/ and tests/docs/site/",
    "ur/docs/repository": "whole documents: tests/docs/ and tests/docs/site/",
    "ur/robot/base/sensors": "sensors are read as part of base files: tests/robot/test_base.py, tests/robot/base/",
    "ur/web/server/assistants": "the page, assistants over HTTP and a robot together: tests/mcp/test_http.py",
    "ur_nodes/assistant": "the robot's end and the server together: tests/mcp/",
    "ur_nodes/codecs": "the contract of all backends: tests/ur_nodes/ports/",
    "ur_nodes/memory": "the contract of all backends: tests/ur_nodes/ports/",
    "ur_nodes/ports/values": "values have no behaviour: the contract of all backends carries each of them",
    "ur_nodes/slam/gmapping": "the node on a bus: tests/ur_nodes/slam/test_slam_gmapping_node.py",
}

TEST_FILES = sorted(TESTS.rglob("test_*.py"))
PACKAGES = sorted(
    path.parent.relative_to(SRC).as_posix()
    for path in SRC.rglob("__init__.py")
    if any(each.name != "__init__.py" for each in path.parent.glob("*.py"))
)
MODULES = {".".join(path.relative_to(SRC).with_suffix("").parts) for path in SRC.rglob("*.py")}


def folder_of_tests(package: str) -> Path:
    return TESTS / package.removeprefix("ur/") if package != "ur" else TESTS


def imports_of(path: Path) -> set[str]:
    found: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            found |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
    return found & MODULES


def test_files_with_the_name_of_a_module_lie_where_the_module_does() -> None:
    misplaced = {}
    for path in TEST_FILES:
        named = {each for each in imports_of(path) if each.rpartition(".")[2] == path.stem.removeprefix("test_")}
        homes = {folder_of_tests(each.rpartition(".")[0].replace(".", "/")) for each in named}
        if homes and path.parent not in homes:
            misplaced[path] = homes
    assert misplaced == {}


def test_folders_mirror_packages_except_for_those_that_are_listed() -> None:
    packages = [path.parent.relative_to(SRC).as_posix() for path in SRC.rglob("__init__.py")]
    mirrors = {folder_of_tests(package).relative_to(TESTS).as_posix() for package in packages}
    folders = {path.parent.relative_to(TESTS).as_posix() for path in TEST_FILES} - {"."}
    assert {each for each in folders if each not in mirrors and not is_listed(each)} == set()
    assert {each for each in OTHERS if not (TESTS / each).is_dir()} == set()


def is_listed(folder: str) -> bool:
    return any(folder == each or folder.startswith(f"{each}/") for each in OTHERS)


def test_packages_have_tests_in_their_folders_except_for_those_that_are_listed() -> None:
    without = {package for package in PACKAGES if not any(folder_of_tests(package).glob("test_*.py"))}
    assert without == set(ELSEWHERE)
