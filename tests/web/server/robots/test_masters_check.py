import asyncio
import socket
import threading

from tests.ros_session import free_port

from ur.web.server.robots.robot_servers import MastersCheck, answers


def test_master_answers_when_its_port_takes_a_connection() -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        assert answers(f"http://127.0.0.1:{server.getsockname()[1]}")
    assert not answers(f"http://127.0.0.1:{free_port()}")


def test_malformed_address_does_not_answer() -> None:
    for master in ("http://[", "http://x:99999999", "", "http://"):
        assert not answers(master)


async def test_masters_are_asked_again_only_after_some_seconds() -> None:
    asked: list[str] = []

    def note(master: str) -> bool:
        asked.append(master)
        return True

    check = MastersCheck(note)
    for _ in range(5):
        assert await check.check(["a", "b"]) == {"a", "b"}
    assert sorted(asked) == ["a", "b"]
    check.close()


async def test_master_that_hangs_is_not_waited_for_and_asked_once() -> None:
    release, asked = threading.Event(), list[str]()

    def hang(master: str) -> bool:
        asked.append(master)
        return release.wait(60) if master == "slow" else True

    check = MastersCheck(hang, 0.05)
    await check.check(["fast", "slow"])
    assert await check.check(["fast", "slow"]) == {"fast"}
    assert asked.count("slow") == 1
    waiting = list(check._running.values())
    release.set()
    await asyncio.wait(waiting)
    assert await check.check(["slow"]) == {"slow"}
    check.close()
