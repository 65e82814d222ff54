"""The package servers that a robot's settings name."""

import pytest

from ur.robot.setup.internet.share import Server, find_unreached, parse_servers, reaches
from ur.robot.ssh.shell import LocalShell

INDEX = (Server("index.test", 443), Server("files.test", 443))
DEBIAN = Server("debian.test", 80)


@pytest.mark.parametrize(
    ("said", "servers"),
    [
        ("apt http://debian.test/debian\napt file:/srv/offered\nend\n", {DEBIAN, *INDEX}),
        ("apt http://debian.test/debian\nindex\npip https://own.test/simple\nend\n", {DEBIAN, Server("own.test", 443)}),
        ("pip https://own.test/more\nend\n", {Server("own.test", 443), *INDEX}),
        ("apt http://debian.test/debian\nproxy\nend\n", set()),
        ("apt mirror+file:/etc/apt/mirrors\napt http://bad host/\nend\n", set(INDEX)),
    ],
)
def test_servers_are_those_of_apt_and_pip(said: str, servers: set[Server]) -> None:
    assert parse_servers(said, INDEX) == servers


def test_server_that_nobody_reaches_is_found_out() -> None:
    nobody = Server("nobody.invalid", 80)
    assert find_unreached(LocalShell(), [nobody]) == {nobody}
    assert not reaches(nobody)
