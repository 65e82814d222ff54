"""Which programs count as there, and which do not."""

import pytest

from ur.check.queries.executables import find_program
from ur.launchfile.world import MemoryWorld

CMAKE = """
project(robot_driver)
add_executable(${PROJECT_NAME}_node src/node.cpp)
cs_add_executable(reader src/reader.cpp)
add_executable(tool_${KIND} src/tool.cpp)
set_target_properties(reader PROPERTIES OUTPUT_NAME read_all)
catkin_install_python(PROGRAMS scripts/talk.py DESTINATION bin)
add_subdirectory(tools)
"""


def world(**extra: str) -> MemoryWorld:
    files = {
        "/r/package.xml": "",
        "/r/CMakeLists.txt": CMAKE,
        "/r/tools/CMakeLists.txt": "add_executable(deep deep.cpp)",
        "/r/scripts/talk.py": "",
        "/r/scripts/plain.py": "",
        "/r/bin/ready": "",
        "/stub/package.xml": "",
        **extra,
    }
    return MemoryWorld(files, {"r": "/r", "stub": "/stub"}, executables=("/r/bin/ready",))


@pytest.mark.parametrize(
    ("package", "name", "kind"),
    [
        ("r", "ready", "found"),
        ("r", "robot_driver_node", "found"),
        ("r", "reader", "found"),
        ("r", "read_all", "found"),
        ("r", "tool_small", "found"),
        ("r", "deep", "found"),
        ("r", "talk.py", "found"),
        ("r", "plain.py", "not-executable"),
        ("r", "redy", "missing"),
        ("stub", "anything", "unknown"),
        ("r", "scripts/talk.py", "unknown"),
        ("nowhere", "x", "no-package"),
    ],
)
def test_program_is_judged(package: str, name: str, kind: str) -> None:
    assert find_program(package, name, world()).kind == kind


def test_missing_program_knows_what_is_near() -> None:
    near = find_program("r", "redy", world()).near
    assert {"ready", "reader", "plain.py"} <= set(near)
