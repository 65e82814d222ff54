"""Assistants over HTTP: the streamable HTTP of the SDK, for a server that has checked who the client is.

A client is asked for each sign of life, so only the versions of the protocol are served that let a server ask: those
with a handshake. The SDK's clients fall back to them.
"""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator, Awaitable, Callable

import mcp_types as types
from mcp.server.streamable_http_manager import StreamableHTTPSessionManager
from mcp_types.version import HANDSHAKE_PROTOCOL_VERSIONS
from starlette.responses import Response
from starlette.types import ASGIApp, Receive, Scope, Send

from ur.mcp.assistant import Assistant
from ur.mcp.serve import make_server

LONGEST = 1 << 18
"""Bytes of the longest request."""

_MOST_SESSIONS = 10  # of one assistant: its program may be started again without an end
_IDLE = 1800.0  # s after which a session without a request ends
_VERSION = b"mcp-protocol-version"


@contextlib.asynccontextmanager
async def open_assistant(
    assistant: Assistant, name: str, close: Callable[[], Awaitable[None]]
) -> AsyncIterator[ASGIApp]:
    """Serve one assistant while the context lasts, under a name that a person has given it. `close` ends its link."""
    assistant.begin(name)
    server = make_server(assistant, remote=True)
    sessions = StreamableHTTPSessionManager(
        server, max_sessions=_MOST_SESSIONS, session_idle_timeout=_IDLE, max_request_body_size=LONGEST
    )

    async def serve(scope: Scope, receive: Receive, send: Send) -> None:
        version = next((value.decode("latin-1") for name, value in scope["headers"] if name == _VERSION), None)
        if version is None or version in HANDSHAKE_PROTOCOL_VERSIONS:
            await sessions.handle_request(scope, receive, send)
        else:
            await _refuse(version)(scope, receive, send)

    watching = asyncio.create_task(assistant.watch())
    try:
        async with sessions.run():
            yield serve
    finally:
        watching.cancel()
        assistant.end()
        await close()


def _refuse(version: str) -> Response:
    """Return a response that names the versions that are served."""
    supported = types.UnsupportedProtocolVersionErrorData(
        supported=list(HANDSHAKE_PROTOCOL_VERSIONS), requested=version[:40]
    )
    problem = types.ErrorData(
        code=types.UNSUPPORTED_PROTOCOL_VERSION,
        message="over HTTP, the robot needs a version in which a server asks its client for signs of life",
        data=supported.model_dump(mode="json"),
    )
    body = types.JSONRPCError(jsonrpc="2.0", id=None, error=problem)
    return Response(body.model_dump_json(by_alias=True, exclude_unset=True), 400, media_type="application/json")
