"""Releases of ROS 2 that do not run here: what nodes use of rclpy and of messages exists there, by its sources.

mypy compares the nodes with `stubs/rclpy`; these tests compare the stubs, and what nodes import, with lists of names.
"""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from ur.system.ros import SUPPORTED_UNTIL

ROOT = Path(__file__).parents[3]
STUBS = ROOT / "stubs"
NODES = ROOT / "src/ur_nodes"
INSTALLED = ROOT / ".ros2/share"
LISTS = sorted(Path(__file__).with_name("releases").glob("*.txt"))
SAME = {"Handle": "GuardCondition", "SubscriptionHandle": "Subscription", "_WaitSet": "WaitSet"}  # of rclpy's C++
ONLY_ROS_1 = frozenset({"actionlib_msgs", "fiducial_msgs", "move_base_msgs", "GetMapRequest", "GetMapResponse"})
ONLY_ROS_1 |= {"rosgraph_msgs.Log", "std_msgs.Empty", "std_msgs.Time"}
ABSENT = {
    "humble": {
        "rclpy.event_handler": "its classes are imported of rclpy.node",
        "rclpy.node.PublisherEventCallbacks.__init__(matched)": "ends.py looks for it, and counts subscribers without",
        "rclpy.node.Subscription.CallbackType": "survey.py looks for it; reception.py uses the callback's signature",
        "rclpy.node.TypeHash": "of topic_type_hash",
        "rclpy.node.TopicEndpointInfo.topic_type_hash": "survey.py and subscriptions.py look for it",
    },
}
"""What a release lacks, and why nodes run on it all the same."""

Names = dict[str, frozenset[str] | None]


def read_names(path: Path) -> Names:
    """Return the parameters, or fields, by full name; None where the list has none, as for functions of C++."""
    names: Names = {}
    text = re.sub(r"\n +", " ", re.sub("(?m)^#.*\n", "", path.read_text(encoding="utf-8")))
    for line in text.splitlines():
        head, _, rest = line.partition(": ")
        if "/" in head:
            names[head.rstrip(":")] = frozenset(rest.split())
            continue
        for prefix, part in (("", head), (f"{head}.", rest)):
            for name, given, parameters in re.findall(r"([\w.]+)(\(([^)]*)\))?", part):
                names[prefix + name] = frozenset(parameters.split()) if given else None
    return names


def list_stubs() -> Iterator[tuple[str, frozenset[str]]]:
    """List the classes, functions and members of the stubs of rclpy, with their parameters."""
    for path in sorted((STUBS / "rclpy").rglob("*.pyi")):
        module = ".".join(path.relative_to(STUBS).with_suffix("").parts).removesuffix(".__init__")
        for statement in ast.parse(path.read_text(encoding="utf-8")).body:
            yield from _list(module, statement)
            if getattr(statement, "name", "").endswith("EventCallbacks"):  # nodes import them of this module
                yield from _list("rclpy.node", statement)


def _list(prefix: str, statement: ast.stmt) -> Iterator[tuple[str, frozenset[str]]]:
    if isinstance(statement, ast.ClassDef):
        name = f"{prefix}.{SAME.get(statement.name, statement.name)}"
        if statement.name != "rclpy_implementation":
            yield name, frozenset()
        for each in statement.body:
            if statement.name != "rclpy_implementation" or isinstance(each, ast.ClassDef):
                yield from _list(prefix if statement.name == "rclpy_implementation" else name, each)
    elif isinstance(statement, ast.FunctionDef):
        given = statement.args
        parameters = {each.arg for each in (*given.args, *given.kwonlyargs)} - {"self"}
        yield f"{prefix}.{statement.name}", frozenset(parameters)
    elif isinstance(statement, ast.AnnAssign) and isinstance(statement.target, ast.Name):
        yield f"{prefix}.{statement.target.id}", frozenset()


def list_imports() -> Iterator[tuple[Path, str, str]]:
    """List the names that nodes import of rclpy and of messages: file, module and name."""
    for path in sorted(NODES.rglob("*.py")):
        for each in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(each, ast.ImportFrom) and re.match(r"rclpy\b|\w+\.(msg|srv)$", each.module or ""):
                yield from ((path, str(each.module), alias.name) for alias in each.names)


@pytest.mark.parametrize("path", LISTS, ids=lambda path: path.stem)
def test_release_has_what_nodes_use_of_rclpy(path: Path) -> None:
    names, absent = read_names(path), ABSENT.get(path.stem, {})
    known = {each.partition("(")[0] for each in absent if "(" not in each}
    missing = []
    for name, parameters in list_stubs():
        if any(name == each or name.startswith(f"{each}.") for each in known):
            continue
        found = names.get(name)
        if name not in names:
            missing.append(name)
        elif found is not None and "**" not in found:
            missing += [f"{name}({each})" for each in parameters - found]
    assert sorted(set(missing) - {*absent}) == []
    assert {*absent} - {*missing} <= known, "no longer absent"


@pytest.mark.parametrize("path", LISTS, ids=lambda path: path.stem)
def test_release_has_the_names_that_nodes_import(path: Path) -> None:
    names, absent = read_names(path), ABSENT.get(path.stem, {})
    missing = set()
    for _, module, name in list_imports():
        package, _, part = module.partition(".")
        if package == "rclpy":
            full = f"{module}.{name}"
            listed = full in names or name in ("rclpy_implementation", "utilities") or module in absent
        else:
            full = f"{package}/{part}/{name}"
            listed = full in names or not ONLY_ROS_1.isdisjoint({package, name, f"{package}.{name}"})
        if not listed:
            missing.add(full)
    assert missing == set()


@pytest.mark.skipif(not INSTALLED.exists(), reason="the wheels of ROS 2 are not installed: x86-64 only")
@pytest.mark.parametrize("path", LISTS, ids=lambda path: path.stem)
def test_nodes_use_no_field_that_the_messages_of_a_release_lack(path: Path) -> None:
    names = read_names(path)
    used = []
    for file, module, name in list_imports():
        package, _, part = module.partition(".")
        definition = INSTALLED / package / part / f"{name}.{part}"
        if f"{package}/{part}/{name}" not in names or not definition.is_file():
            continue
        text = re.sub(r"#.*", "", definition.read_text(encoding="utf-8"))
        fields = re.findall(r"(?m)^\s*[A-Za-z][\w/<=]*(?:\[[<=\d]*\])?\s+(\w+)", text)
        for field in {*fields} - (names[f"{package}/{part}/{name}"] or frozenset()):
            used += (
                [f"{file.name}: {name}.{field}"]
                if re.search(rf"\.{field}\b|\b{field}=", file.read_text("utf-8"))
                else []
            )
    assert used == []


def test_each_release_with_a_list_is_one_on_which_nodes_run() -> None:
    assert {path.stem for path in LISTS} <= {*SUPPORTED_UNTIL}
    assert {*ABSENT} <= {path.stem for path in LISTS}
