import asyncio
from contextlib import suppress

from bench.web_parts.proxy import BadLink


async def test_stalled_link_passes_everything_in_order_afterwards_and_a_drop_ends_it() -> None:
    received: asyncio.Queue[bytes] = asyncio.Queue()

    async def serve(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        while data := await reader.read(100):
            received.put_nowait(data)
        writer.close()

    server = await asyncio.start_server(serve, "127.0.0.1", 0)
    link = BadLink(server.sockets[0].getsockname()[1])
    await link.start()
    reader, writer = await asyncio.open_connection("127.0.0.1", link.port)
    writer.write(b"a")
    assert await asyncio.wait_for(received.get(), 60) == b"a"
    link.stall()
    for each in (b"b", b"c"):
        writer.write(each)
        await asyncio.sleep(0)
    assert received.empty()
    link.resume()
    data = b""
    while len(data) < 2:
        data += await asyncio.wait_for(received.get(), 60)
    assert data == b"bc"
    link.drop()
    with suppress(ConnectionError):
        assert await asyncio.wait_for(reader.read(1), 60) == b""
    writer.close()
    await link.close()
    server.close()
