"""A robot's share of a run and its clients, all on this computer: the robot is the machine `bob`."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from tests.forking import python_of_ur
from tests.run.leftovers import wait_nothing_left

from ur.run.remote.protocol import Client, ShareAnswer, ShareRequest, dump, parse_answer

pytestmark = pytest.mark.ros
SLEEPER = '<node machine="bob" pkg="little_nodes" type="sleeper" name="{}"><!--ready: process--></node>'
ONE = Client("a1", "laptop", "m1", 7, detached=True)  # such a client counts as present
TWO = Client("b2", "laptop2", "m2", 7, detached=True)


def request_of(world: Any, client: Client, *nodes: str, file: str = "test.launch") -> ShareRequest:
    path = world.write("".join(SLEEPER.format(node) for node in nodes), file)
    uri = f"http://localhost:{world.port}"
    return ShareRequest(
        "begin",
        "bob",
        (path,),
        nodes=tuple(f"/{each}" for each in nodes),
        master_uri=uri,
        host="localhost",
        client=client,
    )


def ask(world: Any, request: ShareRequest | str) -> ShareAnswer:
    given = (request if isinstance(request, str) else dump(request)).encode()
    done = python_of_ur().run("ur.run.remote.share", folder=Path.cwd(), environment=world.environment, given=given)
    assert done.returncode == 0, done.stderr
    return parse_answer(done.stdout.decode().splitlines()[-1])


def leave(world: Any, request: ShareRequest) -> ShareAnswer:
    return ask(world, replace(request, action="end"))


def list_runs(world: Any) -> list[str]:
    done = world.ur("ps")
    assert done.wait() == 0
    return [line.split()[0] for line in done.text.splitlines() if "detached" in line]


def test_share_ends_with_its_last_client(world: Any) -> None:
    one, two = (request_of(world, client, "talk") for client in (ONE, TWO))
    began = ask(world, one)
    assert (began.problem, began.found, began.clients) == (None, False, ())
    again = ask(world, two)
    assert (again.run, again.found, again.clients) == (began.run, True, ("laptop",))
    listed = world.ur("ps")
    assert listed.wait() == 0
    assert listed.text.splitlines()[0].endswith("USED BY")
    assert listed.text.splitlines()[1].endswith("laptop, laptop2")
    left = leave(world, one)
    assert (left.ended, left.kept, left.clients) == ((), (began.run,), ("laptop2",))
    assert list_runs(world) == [began.run]
    assert leave(world, one) == left  # a second time changes nothing
    assert leave(world, two).ended == (began.run,)
    assert list_runs(world) == []
    wait_nothing_left(world.folder)


def test_laptops_that_start_at_once_get_one_share(world: Any) -> None:
    requests = [request_of(world, client, "talk") for client in (ONE, TWO)]
    with ThreadPoolExecutor(2) as pool:
        one, two = pool.map(lambda request: ask(world, request), requests)
    assert one.run == two.run
    assert sorted((one.found, two.found)) == [False, True]
    assert list_runs(world) == [one.run]
    for request in requests:
        leave(world, request)
    assert list_runs(world) == []


def test_node_of_a_client_that_another_client_has_too_gets_another_name(world: Any) -> None:
    one, two = (request_of(world, replace(client, nodes=("/keys", f"/{client.name}")), "talk") for client in (ONE, TWO))
    assert ask(world, one).names == {}
    assert ask(world, two).names == {"/keys": "/keys_laptop2"}
    third = replace(one, client=replace(TWO, client="c3", machine="m3", nodes=("/keys",)))
    assert ask(world, third).names == {"/keys": "/keys_laptop2_2"}
    for request in (one, two, third):
        leave(world, request)
    assert list_runs(world) == []


def test_client_of_another_program_keeps_the_nodes_that_it_relies_on(world: Any) -> None:
    one = request_of(world, ONE, "talk")
    two = request_of(world, TWO, "talk", "more", file="other.launch")
    first, second = ask(world, one), ask(world, two)
    assert second.running == ("/talk",)
    assert second.clients == ("laptop",)
    left = leave(world, one)
    assert (left.ended, left.kept, left.clients) == ((), (first.run,), ("laptop2",))
    assert sorted(leave(world, two).ended) == sorted((first.run, second.run))
    assert list_runs(world) == []


def test_run_that_was_started_on_the_robot_itself_goes_on(world: Any) -> None:
    own = world.ur(
        "launch", "--detach", world.write(SLEEPER.replace('machine="bob" ', "").format("talk"), "own.launch")
    )
    assert own.wait() == 0, own.text
    runs = list_runs(world)
    request = request_of(world, ONE, "talk")
    began = ask(world, request)
    assert (began.run, began.running, began.clients) == ("", ("/talk",), ())
    assert leave(world, request) == ShareAnswer()
    assert list_runs(world) == runs
    assert world.ur("stop", "--all").wait() == 0


def test_client_of_the_same_computer_that_was_killed_is_dropped(world: Any) -> None:
    killed = request_of(world, replace(ONE, client="killed", detached=False), "talk")
    run = ask(world, killed).run
    again = request_of(world, replace(ONE, detached=False), "talk")
    found = ask(world, again)
    assert (found.run, found.found, found.clients) == (run, True, ())
    assert leave(world, again).ended == (run,)


def test_share_is_kept_for_a_client_that_is_silent_until_it_has_left(world: Any) -> None:
    silent = request_of(world, replace(TWO, detached=False), "talk")
    one = request_of(world, ONE, "talk")
    run = ask(world, silent).run
    ask(world, one)
    assert leave(world, one).kept == (run,)
    assert leave(world, silent).ended == (run,)
    wait_nothing_left(world.folder)


@pytest.mark.parametrize("text", ["", "[]", '{"action": "begin"}', "x" * 300_000])
def test_request_that_makes_no_sense_is_answered_with_a_problem(world: Any, text: str) -> None:
    problem = ask(world, text).problem
    assert problem is not None
    assert "the request cannot be read" in problem.message


def test_file_that_is_not_there_is_a_problem_with_its_rule(world: Any) -> None:
    request = replace(request_of(world, ONE, "talk"), words=("no_such_package", "x.launch"))
    problem = ask(world, request).problem
    assert problem is not None
    assert problem.message.startswith("no package or file named 'no_such_package'")
    assert (problem.rule, problem.place) == ("unknown-package", "")
