"""A TCP proxy between page and server that delays, stalls and drops, as a bad wireless link does."""

import asyncio
from contextlib import suppress


class BadLink:
    """Passes bytes on in order, `delay` s late; while `stalled` nothing passes, and all of it comes afterwards."""

    def __init__(self, port: int) -> None:
        """`port` is that of the server on this computer."""
        self._to = port
        self.delay = 0.0
        self._open = asyncio.Event()
        self._open.set()
        self._writers: set[asyncio.StreamWriter] = set()
        self._server: asyncio.Server | None = None
        self.port = 0

    async def start(self) -> None:
        """Listen on a free port."""
        self._server = await asyncio.start_server(self._serve, "localhost", 0, family=2)
        self.port = self._server.sockets[0].getsockname()[1]

    def stall(self) -> None:
        """Let nothing pass."""
        self._open.clear()

    def resume(self) -> None:
        """Let everything pass again."""
        self._open.set()

    def drop(self) -> None:
        """Reset all connections."""
        for writer in self._writers:
            writer.transport.abort()

    async def close(self) -> None:
        """Stop to listen, and drop what is left."""
        self.resume()
        self.drop()
        if self._server is not None:
            self._server.close()
            await self._server.wait_closed()

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        try:
            far_reader, far_writer = await asyncio.open_connection("127.0.0.1", self._to)
        except OSError:
            writer.close()
            return
        both = {writer, far_writer}
        self._writers |= both
        pumps = [self._pump(reader, far_writer), self._pump(far_reader, writer)]
        await asyncio.wait([asyncio.create_task(each) for each in pumps])
        self._writers -= both

    async def _pump(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        loop = asyncio.get_running_loop()
        queue: asyncio.Queue[tuple[float, bytes]] = asyncio.Queue()

        async def deliver() -> None:
            while True:
                due, data = await queue.get()
                await asyncio.sleep(max(0.0, due - loop.time()))
                await self._open.wait()
                writer.write(data)
                if not data:
                    writer.close()
                    return

        task = asyncio.create_task(deliver())
        with suppress(ConnectionError):
            while data := await reader.read(65536):
                queue.put_nowait((loop.time() + self.delay, data))
        queue.put_nowait((loop.time(), b""))
        with suppress(ConnectionError):
            await task
