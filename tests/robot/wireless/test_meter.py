"""Measuring with real processes in place of ping and ssh."""

import threading
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from ur.robot.doctor.wifi import WirelessLink
from ur.robot.wireless.meter import Meter, ProcessLines, Radio

BLOCK = ("device wlan0", "\tfreq: 5180", "\tsignal: -52 dBm", "\x1e")
PING = """\
#!/bin/bash
i=0; while [ $((++i)) -lt 20 ]; do echo "64 bytes from ${@: -1}: icmp_seq=$i ttl=64 time=2.00 ms"; done; exec sleep 1000
"""
SSH = "#!/bin/bash\nprintf 'device wlan0\\n\\tfreq: 5180\\n\\tsignal: -52 dBm\\n\\036\\n'; exec sleep 1000\n"


def until(condition: Callable[[], object], deadline: float = 60.0) -> None:
    end = time.monotonic() + deadline
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.01)


@pytest.fixture
def tools(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for name, text in (("ping", PING), ("ssh", SSH)):
        (tmp_path / name).write_text(text)
        (tmp_path / name).chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:/usr/bin:/bin")
    return tmp_path


def test_link_is_known_while_it_is_heard_of() -> None:
    now = [100.0]
    radio = Radio(lambda: now[0])
    assert (radio.link(), radio.wireless) == (None, None)
    for line in BLOCK:
        radio.read(line)
    assert radio.link() == WirelessLink("wlan0", 5180.0, -52.0)
    now[0] = 110.0
    assert (radio.link(), radio.wireless) == (None, True)


def test_computer_without_a_wireless_interface_says_so() -> None:
    radio = Radio(time.time)
    radio.read("\x1e")
    assert (radio.link(), radio.wireless) == (None, False)


@pytest.mark.usefixtures("tools")
def test_both_ends_and_the_way_between_are_measured() -> None:
    with Meter("ros", "bob.local", lambda: "10.0.0.2") as meter:
        until(lambda: meter.there.link())
        samples = [meter.sample()]
        while not samples[-1].sent:
            assert len(samples) < 6000
            time.sleep(0.01)
            samples.append(meter.sample())
    assert samples[-1].lost == 0
    assert samples[-1].latency == pytest.approx(0.002)
    assert meter.there.wireless


@pytest.mark.usefixtures("tools")
def test_name_that_leads_nowhere_is_an_error_at_the_start_only() -> None:
    def fail() -> str:
        raise OSError

    with pytest.raises(OSError), Meter("ros", "bob.local", fail):  # noqa: PT011 - any
        pass


def test_process_that_ends_is_started_again_and_none_is_left() -> None:
    seen: list[int] = []
    heard = threading.Event()

    def read(line: str) -> None:
        seen.append(int(line))
        heard.set()

    lines = ProcessLines(lambda: ["sh", "-c", "echo $$; exec sleep 1000"], read)
    until(heard.is_set)
    heard.clear()
    lines.renew()
    until(heard.is_set)
    lines.close()
    assert len(set(seen)) == 2
    assert not any(Path(f"/proc/{number}").exists() for number in seen)
