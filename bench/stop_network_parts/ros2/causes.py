"""The causes: what happens while everybody drives. Each returns when nothing more happens."""

import signal
import time

from bench.stop_network_parts.network import Cause
from bench.stop_network_parts.ros2.network import Network, set_clock

_START = 6.0  # s: for the programs of a second laptop to start


def _cut(network: Network) -> None:
    network.computers.order(state="cut")
    time.sleep(network.chance.uniform(0.5, 6.0))
    network.computers.order(state="open")
    time.sleep(2.0)


def _hold(network: Network) -> None:
    """The network keeps everything, and delivers it at once."""
    for _ in range(network.chance.randint(1, 3)):
        network.computers.order(state="held")
        time.sleep(network.chance.uniform(0.3, 4.0))
        network.computers.order(state="open")
        time.sleep(network.chance.uniform(0.1, 1.5))
    time.sleep(1.0)


def _slow(network: Network) -> None:
    """Every packet is late, evenly, and then no longer."""
    delay = network.chance.uniform(0.25, 2.0)
    network.computers.order(delay=delay)
    time.sleep(2.0 + delay)
    network.computers.order(delay=0.0)
    time.sleep(2.0 + delay)


def _loss(network: Network) -> None:
    for _ in range(4):
        network.computers.order(loss=0.9, delay=0.001)
        time.sleep(network.chance.uniform(0.2, 1.5))
        network.computers.order(loss=0.0, delay=0.0)
        time.sleep(network.chance.uniform(0.1, 0.8))
    time.sleep(1.0)


def _kill(network: Network) -> None:
    """The network holds everything back, the programs are killed meanwhile, and then it delivers."""
    network.computers.order(state=network.chance.choice(["held", "cut", "open"]))
    time.sleep(network.chance.uniform(0.1, 3.0))
    for each in network.commanders.values():
        each.send(signal.SIGKILL)
    time.sleep(network.chance.uniform(0.1, 2.0))
    network.computers.order(state="open")
    time.sleep(3.0)


def _suspend(network: Network) -> None:
    network.computers.order(state=network.chance.choice(["held", "cut", "open"]))
    for each in network.commanders.values():
        each.send(signal.SIGSTOP)
    time.sleep(network.chance.uniform(0.5, 5.0))
    network.computers.order(state="open")
    time.sleep(network.chance.uniform(0.0, 0.5))
    for each in network.commanders.values():
        each.send(signal.SIGCONT)
    time.sleep(2.0)


def _reboot(network: Network) -> None:
    """The laptop is gone without a word, and is back."""
    network.computers.order(state="cut")
    for each in network.commanders.values():
        each.send(signal.SIGKILL)
    time.sleep(network.chance.uniform(0.5, 3.0))
    network.computers.order(state="open")
    network.start_commanders()
    time.sleep(4.0)


def _second(network: Network) -> None:
    """A second laptop drives, too, and takes the lease; then its packets are held back, and it is killed."""
    network.start_second({})
    time.sleep(_START)
    network.drive("held", network.second)
    time.sleep(2.0)
    network.computers.order(state="held")
    time.sleep(network.chance.uniform(0.3, 3.0))
    network.end_second()
    network.computers.order(state="open")
    time.sleep(2.0)


def _clock(network: Network) -> None:
    """The laptop's clock is set, back or ahead; then the network holds packets back, and the programs are killed."""
    set_clock(network.computers.folder, network.chance.choice([-3600.0, -5.0, -0.5, 0.5, 5.0, 3600.0]))
    time.sleep(network.chance.uniform(0.5, 2.0))
    _kill(network)
    set_clock(network.computers.folder, 0.0)


def _mux(network: Network) -> None:
    """The muxes hang for a while, with all commands waiting for them."""
    for each in network.muxes.values():
        each.send(signal.SIGSTOP)
    time.sleep(network.chance.uniform(0.3, 3.0))
    for each in network.commanders.values():
        each.send(signal.SIGSTOP)
    time.sleep(0.3)
    for each in network.muxes.values():
        each.send(signal.SIGCONT)
    time.sleep(2.0)
    for each in network.commanders.values():
        each.send(signal.SIGCONT)
    time.sleep(1.0)


def _dead_mux(network: Network) -> None:
    for each in network.muxes.values():
        each.send(signal.SIGKILL)
    network.computers.order(state="held")
    time.sleep(network.chance.uniform(0.3, 2.0))
    network.start_muxes()
    time.sleep(2.0)
    for each in network.commanders.values():
        each.send(signal.SIGKILL)
    network.computers.order(state="open")
    time.sleep(3.0)


CAUSES = {
    "cut": Cause("network cut", _cut),
    "held": Cause("network holds back", _hold),
    "slow": Cause("network late for a while", _slow),
    "loss": Cause("bursts of loss", _loss),
    "kill": Cause("programs killed", _kill, lost=True),
    "suspend": Cause("programs suspended", _suspend),
    "reboot": Cause("laptop rebooted", _reboot),
    "second": Cause("second driver", _second, lost=True),
    "clock": Cause("laptop's clock set", _clock, lost=True),
    "mux": Cause("mux hangs", _mux),
    "dead-mux": Cause("mux killed, started again", _dead_mux, lost=True),
}
