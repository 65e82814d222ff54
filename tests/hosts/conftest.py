"""Computers for tests: `bench` is a laptop and a robot, fresh for each module."""

from collections.abc import Iterator

import pytest
from tests.hosts.bench import Bench, Machine, boot, find_obstacle

SUDO = "pat ALL=(ALL) NOPASSWD: ALL\n"


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    here = [item for item in items if item.nodeid.startswith("tests/hosts/")]
    obstacle = find_obstacle()
    for item in here:
        item.add_marker(pytest.mark.hosts)
        if item.get_closest_marker("timeout") is None:
            item.add_marker(pytest.mark.timeout(900))  # the first one may have to make the root file system
        if obstacle:
            item.add_marker(pytest.mark.skip(reason=f"no computers to test with: {obstacle}"))


@pytest.fixture(scope="module")
def bench() -> Iterator[Bench]:
    with boot(("laptop", "robot")) as running:
        yield running


@pytest.fixture(scope="module")
def laptop() -> Iterator[Machine]:
    """A laptop that is just installed, whose user may use sudo, fresh for each module."""
    with boot(("laptop",)) as bench:
        bench["laptop"].write("/etc/sudoers.d/pat", SUDO, mode=0o440)
        yield bench["laptop"]
