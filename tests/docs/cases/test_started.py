"""Single files put together mean the same as resolving the whole tree from its root."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.docs.helpers import LIBRARY, ROVER

from ur.check.cases import resolve_cases
from ur.docs.cases.started import StartedFile, Starter, place_name, walk_nodes
from ur.docs.repository.collect import collect_repository
from ur.launchfile.plan.specs import Plan
from ur.launchfile.world import MemoryWorld, SystemWorld
from ur.source.diagnostic import Severity

CORPUS = Path(__file__).parents[2] / "launchfile" / "corpus"


def walk_includes(started: StartedFile, namespace: str = "/") -> Iterator[tuple[str, str]]:
    for include, child in started.included:
        inside = place_name(include.namespace, namespace)
        yield include.file, inside
        if child is not None:
            yield from walk_includes(child, inside)


def whole_nodes(plan: Plan) -> list[tuple[str, str, str, str]]:
    nodes = (*plan.nodes, *(test.node for test in plan.tests))
    return sorted((n.full_name, n.package, n.type, n.args) for n in nodes if n.name)


def is_loadable(plan: Plan) -> bool:
    return not any(found.severity is Severity.ERROR for found in plan.diagnostics)


@pytest.mark.parametrize("folder", [LIBRARY, ROVER, CORPUS], ids=lambda path: path.name)
def test_composed_files_start_what_the_whole_tree_starts(folder: Path) -> None:
    repository = collect_repository(str(folder), SystemWorld({}))
    starter = Starter(repository.trees)
    compared = 0
    for view in repository.views.values():
        whole = list(resolve_cases(view, repository.world))
        composed = list(resolve_cases(view, repository.world, load=starter.load))
        for one, other in zip(whole, composed, strict=False):
            plan = other.plan
            assert isinstance(plan.started, StartedFile)
            if one.case != other.case or not (is_loadable(one.plan) and is_loadable(plan)):
                continue  # what is refused has no meaning to compare
            nodes = sorted((name, n.package, n.type, n.args) for name, n in walk_nodes(plan.started) if n.name)
            assert nodes == whole_nodes(one.plan), (view.path, one.case.label)
            includes = [(include.file, include.namespace) for include in one.plan.includes]
            assert sorted(walk_includes(plan.started)) == sorted(includes), (view.path, one.case.label)
            compared += 1
    assert compared > 20


def test_file_that_includes_itself_twice_ends() -> None:
    text = """<launch>
  <arg name="depth" default="x"/>
  <include file="$(dirname)/a.launch"><arg name="depth" value="$(arg depth)l"/></include>
  <include file="$(dirname)/a.launch"><arg name="depth" value="$(arg depth)r"/></include>
</launch>"""
    repository = collect_repository("/ws", MemoryWorld({"/ws/a.launch": text}))
    view = repository.views["/ws/a.launch"]
    plans = list(resolve_cases(view, repository.world, load=Starter(repository.trees).load))
    assert {found.rule for found in plans[0].plan.diagnostics} == {"include-cycle"}
