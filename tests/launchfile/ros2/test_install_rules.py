"""Files of a source tree are found where the install rules of its package take them from."""

import pytest
from tests.launchfile.ros2.plans import PACKAGES, load, load_clean, python

from ur.launchfile.ros2.install_rules import read_cmake, read_setup

SHARE = PACKAGES["demo"]
FILES = ("bringup/launch/a.launch.py", "config/base.yaml", "config/old.bak", "maps/x/office.yaml", "launch/b.launch.py")
CMAKE = {
    "folder": ("install(DIRECTORY launch config DESTINATION share/${PROJECT_NAME})", "config/base.yaml"),
    "contents of a folder": (
        "install(DIRECTORY config/ DESTINATION share/${PROJECT_NAME}/params/)",
        "params/base.yaml",
    ),
    "folder in another": (
        'install(\n  DIRECTORY bringup/launch # the files\n  DESTINATION "${CMAKE_INSTALL_PREFIX}/share/demo")',
        "launch/a.launch.py",
    ),
    "file": ("install(FILES config/base.yaml DESTINATION share/${PROJECT_NAME})", "base.yaml"),
    "file with another name": (
        "install(FILES ${CMAKE_CURRENT_SOURCE_DIR}/config/base.yaml DESTINATION share/demo/p RENAME robot.yaml)",
        "p/robot.yaml",
    ),
    "pattern": (
        'install(DIRECTORY config DESTINATION share/demo FILES_MATCHING PATTERN "*.yaml" PATTERN "old*" EXCLUDE)',
        "config/base.yaml",
    ),
    "glob": ("file(GLOB FOUND config/*.yaml)\ninstall(FILES ${FOUND} DESTINATION share/demo/p)", "p/base.yaml"),
    "list": ("set(DIRS launch config)\ninstall(DIRECTORY ${DIRS} DESTINATION share/demo)", "config/base.yaml"),
    "ament_auto": ("ament_auto_package(INSTALL_TO_SHARE launch config)", "config/base.yaml"),
}
SETUP = {
    "list": ("data_files=[('share/demo/p', ['config/base.yaml'])]", "p/base.yaml"),
    "glob": ("data_files=[(os.path.join('share', name, 'p'), glob('config/*.yaml'))]", "p/base.yaml"),
    "text": (
        "data_files=[('share/' + name, ['package.xml']), (f'share/{name}/p', glob.glob('config/*'))]",
        "p/base.yaml",
    ),
    "deep": ("data_files=[('share/demo/maps', glob('maps/**/*.yaml', recursive=True))]", "maps/office.yaml"),
}


def plan_of(build: str, text: str, path: str, *, clean: bool = True) -> object:
    place = f"PathJoinSubstitution([FindPackageShare('demo'), '{path}'])"
    files = {f"{SHARE}/{each}": "/**: {ros__parameters: {a: 1}}" for each in FILES if each.endswith(".yaml")}
    files |= {f"{SHARE}/{each}": python() for each in FILES if each.endswith(".py")}
    files[f"{SHARE}/{build}"] = text
    action = (
        f"IncludeLaunchDescription({place})" if path.endswith(".py") else f"Node(executable='n', parameters=[{place}])"
    )
    return (load_clean if clean else load)(python(action), files=files)


@pytest.mark.parametrize(("text", "path"), CMAKE.values(), ids=CMAKE)
def test_file_that_cmake_installs_is_found(text: str, path: str) -> None:
    plan_of("CMakeLists.txt", text, path)


@pytest.mark.parametrize(("text", "path"), SETUP.values(), ids=SETUP)
def test_file_that_setup_py_installs_is_found(text: str, path: str) -> None:
    plan_of("setup.py", f"name = 'demo'\nsetup(name=name, {text})", path)


@pytest.mark.parametrize(
    ("build", "text", "path"),
    [
        ("CMakeLists.txt", CMAKE["file"][0], "config/base.yaml"),
        ("CMakeLists.txt", CMAKE["contents of a folder"][0], "launch/b.launch.py"),
        ("setup.py", "setup(data_files=[('share/demo', ['package.xml'])])", "launch/b.launch.py"),
    ],
)
def test_file_that_is_not_installed_is_a_finding(build: str, text: str, path: str) -> None:
    plan = plan_of(build, text, path, clean=False)
    assert [found.message for found in plan.diagnostics] == [  # type: ignore[attr-defined]
        f"{SHARE}/{path} is not installed by its package, expected an install rule for this path"
    ]


@pytest.mark.parametrize(
    ("build", "text"),
    [
        ("CMakeLists.txt", f"{CMAKE['file'][0]}\nforeach(each a b)\nendforeach()"),
        ("CMakeLists.txt", f"{CMAKE['file'][0]}\ninstall(DIRECTORY ${{OTHERS}} DESTINATION share/demo)"),
        ("CMakeLists.txt", ""),
        ("setup.py", "setup(data_files=[('share/demo', ['package.xml']), *more()])"),
        ("setup.py", "data_files = [('share/demo', ['a'])]\ndata_files.append(more)\nsetup(data_files=data_files)"),
        ("setup.py", "setup("),
    ],
)
def test_rules_that_are_not_known_completely_find_a_file_by_its_name(build: str, text: str) -> None:
    plan_of(build, text, "config/base.yaml")


def test_rules_never_fail_for_their_text() -> None:
    for text in ("install(", "install()", "install(FILES)", "set()", "file(GLOB)", "install(DIRECTORY DESTINATION)"):
        assert read_cmake(text, "demo", lambda _: ()).rules == ()
    for text in ("\0", "x" * 9, "setup(data_files=[1, (2, 3), ('a',)])"):
        assert read_setup(text, "demo", lambda _: ()).rules == ()


def test_rules_that_grow_without_end_are_not_known() -> None:
    doubled = "set(A ab)\n" + 60 * 'set(A "${A}${A}")\n'
    assert read_cmake(f"{doubled}install(FILES ${{A}} DESTINATION share/demo)", "demo", lambda _: ()).rules == ()
    names = [f"a{number} = a{number - 1} + a{number - 1}" for number in range(1, 60)]
    text = "\n".join(
        ["a0 = 'ab'", *names, "b = f'{b}'", "setup(data_files=[('share/demo', [a59]), ('share/demo', [b])])"]
    )
    assert not read_setup(text, "demo", lambda _: ()).complete
