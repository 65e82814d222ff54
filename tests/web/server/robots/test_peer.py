import asyncio
import socket
from collections.abc import AsyncIterator, Mapping
from typing import Any

import pytest

from ur.web.server.robots.peer import Peer, PeerError


class PeerPair:
    def __init__(self) -> None:
        self.never = asyncio.Event()

    async def open(self) -> None:
        ours, theirs = socket.socketpair()
        self.first = Peer(*await asyncio.open_connection(sock=ours), self.answer)
        self.writer = (await asyncio.open_connection(sock=theirs))[1]
        reader = asyncio.StreamReader()
        self.writer.transport.set_protocol(asyncio.StreamReaderProtocol(reader))
        self.second = Peer(reader, self.writer, self.answer)
        self.tasks = [asyncio.create_task(each.run()) for each in (self.first, self.second)]

    async def answer(self, request: Mapping[str, Any]) -> Any:
        if request.get("wait"):
            await self.never.wait()
        if request.get("back"):
            return await self.second.ask({"n": request["back"]})
        if request.get("refuse"):
            raise PeerError("this robot is not in the list")
        return request["n"]


@pytest.fixture
async def pair() -> AsyncIterator[PeerPair]:
    pair = PeerPair()
    await pair.open()
    yield pair
    pair.first.close()
    await asyncio.wait_for(asyncio.gather(*pair.tasks), 30)


async def test_both_ends_ask_and_each_answer_goes_to_its_request(pair: PeerPair) -> None:
    asked = [peer.ask({"n": number}) for number in range(20) for peer in (pair.first, pair.second)]
    assert await asyncio.gather(*asked) == [number for number in range(20) for _ in range(2)]


async def test_answer_may_need_a_request_in_the_other_direction(pair: PeerPair) -> None:
    assert await pair.first.ask({"back": 7}) == 7


async def test_refusal_is_raised_with_its_reason_at_the_other_end(pair: PeerPair) -> None:
    with pytest.raises(PeerError, match="not in the list"):
        await pair.first.ask({"refuse": True})


async def test_requests_fail_when_the_other_end_has_ended(pair: PeerPair) -> None:
    waiting = asyncio.ensure_future(pair.first.ask({"wait": True}))
    await asyncio.sleep(0)
    pair.second.close()
    with pytest.raises(PeerError, match="has ended"):
        await waiting
    with pytest.raises(PeerError, match="has ended"):
        await pair.first.ask({"n": 1})


async def test_line_that_is_no_message_ends_the_connection(pair: PeerPair) -> None:
    pair.writer.write(b"hello\n")
    await asyncio.wait_for(pair.tasks[0], 30)
