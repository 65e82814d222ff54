"""Programs of nodes: the files that are run, and those in which parameters may be read."""

import pytest

from ur.launchfile.world.memory import MemoryWorld
from ur.source.project import package_folder
from ur.tools.find.programs import NodeProgram, may_name, program_files, read_program, source_files

NODES = f"{package_folder().parent}/ur_nodes"
START = '#!/bin/bash\nexec "$(dirname "$0")/../lib/node" ur_nodes.eye.main "$@"\n'
WORLD = MemoryWorld(
    {
        "/p/package.xml": "<package><name>p</name></package>",
        "/p/bin/eye": START,
        "/p/bin/lost": START.replace("eye.main", "eye.none"),
        "/p/bin/own": "#!/usr/bin/env python3\nprint()\n",
        "/p/bin/machine_code": b"\x7fELF\0\0",
        "/p/bin/long": b"#" * 1_000_001,
        f"{NODES}/eye/main.py": "import sys\n",
        f"{NODES}/eye/lens.py": "",
        f"{NODES}/eye/notes.txt": "",
    },
    {"p": "/p"},
    executables=["/p/bin/eye", "/p/bin/lost", "/p/bin/own", "/p/bin/machine_code"],
)


@pytest.mark.parametrize(
    ("name", "files"),
    [
        ("eye", ["/p/bin/eye", f"{NODES}/eye/main.py"]),
        ("lost", ["/p/bin/lost"]),
        ("own", ["/p/bin/own"]),
        ("machine_code", ["/p/bin/machine_code"]),
        ("nothing", []),
    ],
)
def test_program_has_its_file_and_the_module_that_it_starts(name: str, files: list[str]) -> None:
    assert program_files(NodeProgram("p", name), WORLD) == files


def test_program_of_an_unknown_package_has_no_files() -> None:
    assert program_files(NodeProgram("far", "eye"), WORLD) == []


def test_modules_beside_the_one_that_is_run_may_read_parameters() -> None:
    files = source_files(NodeProgram("p", "eye"), WORLD)
    assert files == ["/p/bin/eye", f"{NODES}/eye/main.py", f"{NODES}/eye/lens.py"]
    assert source_files(NodeProgram("p", "own"), WORLD) == ["/p/bin/own"]


@pytest.mark.parametrize("path", ["/p/bin/machine_code", "/p/bin/long", "/p/bin/missing"])
def test_file_that_is_no_text_of_a_program_is_not_read(path: str) -> None:
    assert read_program(path, WORLD) is None


@pytest.mark.parametrize(
    ("written", "path", "expected"),
    [
        ("$(find p)/params/$(arg base).yaml", "/p/params/one.yaml", True),
        ("$(find p)/params/$(arg base).yaml", "/p/params/one.yml", False),
        ("$(dirname)/../params/a.yaml", "/p/params/a.yaml", True),
        ("$(arg file)", "/p/params/a.yaml", False),
    ],
)
def test_value_may_name_a_path_that_its_plain_texts_match(written: str, path: str, expected: bool) -> None:
    assert may_name(written, path) is expected
