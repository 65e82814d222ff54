import errno
import threading

import pytest

from ur.robot.addresses import AddressCache


class Names:
    """A name service of which nothing is known but what a test says."""

    def __init__(self) -> None:
        self.addresses = {"bob.local": "192.0.2.7"}
        self.asked: list[str] = []
        self.answered = threading.Event()

    def look_up(self, host: str) -> str:
        self.asked.append(host)
        try:
            if host not in self.addresses:
                raise OSError(errno.ENOENT, "not known")
            return self.addresses[host]
        finally:
            self.answered.set()


def test_address_stays_known_while_names_are_not() -> None:
    names, clock = Names(), [0.0]
    addresses = AddressCache(names.look_up, lambda: clock[0])
    assert addresses.find("bob.local") == "192.0.2.7"
    names.addresses.clear()
    names.answered.clear()
    clock[0] = 100.0
    assert addresses.find("bob.local") == "192.0.2.7"
    assert names.answered.wait(30.0)
    assert addresses.find("bob.local") == "192.0.2.7"


def test_known_address_is_looked_up_again_beside_but_not_each_time() -> None:
    names, clock = Names(), [0.0]
    addresses = AddressCache(names.look_up, lambda: clock[0])
    for _ in range(3):
        addresses.find("bob.local")
    assert names.asked == ["bob.local"]


def test_new_address_of_a_host_is_noticed() -> None:
    names = Names()
    addresses = AddressCache(names.look_up)
    assert not addresses.refresh("bob.local")
    names.addresses["bob.local"] = "192.0.2.8"
    assert addresses.refresh("bob.local")
    assert addresses.find("bob.local") == "192.0.2.8"


def test_name_that_was_never_known_is_an_error() -> None:
    with pytest.raises(OSError, match="not known"):
        AddressCache(Names().look_up).find("alice.local")
