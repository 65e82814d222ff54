"""Random lives of runs, seeded: whatever happens to them, nothing is left and nobody sees a traceback."""

import json
import os
import random
import signal
import time
from contextlib import suppress
from typing import Any

import psutil
import pytest
from tests.forking import run_ur
from tests.run.conftest import start_master
from tests.run.leftovers import find_processes, wait_nothing_left
from tests.run.test_launch import registered

pytestmark = pytest.mark.ros

NODES = ("sleeper", "stubborn", "daemon", "double", "deaf", "crash", "quick", "ticker", "relay", "relay")
ENDS = ("INT", "TERM", "HUP", "INT twice", "kill supervisor", "kill host", "kill guard", "stop verb")


def write_nodes(dice: random.Random) -> str:
    count = dice.randint(1, 6)
    body = []
    for number in range(count):
        kind = dice.choice(NODES)
        more = dice.choice(("", "", ' respawn="true"', ' required="true"' if kind not in ("crash", "quick") else ""))
        output = dice.choice(("log", "screen"))
        args = ' args="in out"' if kind == "relay" else ""
        body.append(f'<node pkg="little_nodes" type="{kind}" name="n{number}" output="{output}"{more}{args}/>')
    body.append('<node pkg="little_nodes" type="sleeper" name="last"/><param name="p" value="1"/>')
    return "".join(body)


def disturb(world: Any, run: Any, dice: random.Random) -> None:
    """Kill one of its processes, or do nothing."""
    mine = find_processes(world.folder, without=frozenset({world.master_pid, run.process.pid}))
    nodes = [pid for pid, command in mine.items() if "sleep 600" in command or "relay" in command]
    if nodes and dice.random() < 0.5:
        with suppress(ProcessLookupError):
            os.kill(dice.choice(nodes), dice.choice((signal.SIGKILL, signal.SIGTERM, signal.SIGSTOP)))


def end(world: Any, run: Any, how: str) -> None:
    if how == "stop verb":
        world.ur("stop", "--all").wait()
    elif how in ("kill host", "kill guard"):
        while run.process.poll() is None and not kill_keeper(run, how.replace("kill ", "ur-")):
            run.read(0.01)  # it has not come that far
        if how == "kill guard":  # one of three does not matter
            run.process.send_signal(signal.SIGINT)
    elif how == "kill supervisor":
        run.process.kill()
    else:
        run.process.send_signal(getattr(signal, f"SIG{how.split()[0]}"))
        if "twice" in how:
            run.read(0.1)
            run.process.send_signal(signal.SIGINT)


def kill_keeper(run: Any, name: str) -> bool:
    """Kill the process host or the guard. False while there is none."""
    with suppress(psutil.Error):
        for child in psutil.Process(run.process.pid).children(recursive=True):
            if name in (child.name(), *child.cmdline()[:1]):
                child.kill()
                return True
    return False


def live(world: Any, seed: int) -> None:
    """One run from start to end; of every other seed with the start of Python, in which signals arrive, too."""
    dice = random.Random(seed)
    start = world.execute if seed % 2 else world.ur
    foreign = dice.random() < 0.5
    master = start_master(world) if foreign else None
    world.master_pid = master.pid if master else 0
    try:
        body = write_nodes(dice)
        run = start("launch", world.write(body))
        how = dice.choice(ENDS)
        if dice.random() < 0.8 or how == "stop verb":  # which finds only what is registered already
            with suppress(AssertionError):  # it may end before: a required node did
                run.until("[/last] started")
            disturb(world, run, dice)
        limit = time.monotonic() + dice.choice((0.0, 0.05, 0.3))
        while time.monotonic() < limit:
            run.read(0.01)
        if master is not None and dice.random() < 0.2:
            master.kill()
            master.wait()
            master = None
        end(world, run, how)
        run.wait()
        own = [line for line in run.text.splitlines() if not line.startswith(("[/", "  | "))]  # not what nodes print
        wrong = ("Traceback", "internal error", "Fatal Python error")
        assert not any(words in line for line in own for words in wrong), run.text
        wait_nothing_left(world.folder, without=frozenset({master.pid}) if master else frozenset())
        if master is not None and how not in ("kill supervisor", "kill host"):
            assert not {name for name in registered(world.port) if name.startswith(("/n", "/last"))}, (how, run.text)
        assert json.loads(run_ur("ps", "--json", environment=world.environment).stdout) == []
    finally:
        if master is not None:
            master.kill()
            master.wait()
        if run.output >= 0:
            os.close(run.output)
            run.output = -1
        world.running.clear()


@pytest.mark.parametrize("seed", range(10))
def test_random_life_leaves_nothing(world: Any, seed: int) -> None:
    live(world, seed)


@pytest.mark.parametrize("block", range(8))  # which processes share
def test_25_random_lives_leave_nothing(world: Any, block: int) -> None:
    first = int(os.environ.get("UR_FIRST_SEED", "1000")) + 25 * block
    for seed in range(first, first + 25):
        try:
            live(world, seed)
        except Exception as problem:  # noqa: PERF203 - the seed is what is needed to see it again
            raise AssertionError(f"seed {seed}") from problem
