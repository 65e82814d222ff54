"""A running server of the page, and its clients."""

from dataclasses import dataclass
from typing import Any

import aiohttp

from ur.web.access.roles import Role
from ur.web.server.logins.gate import LoginGate


@dataclass
class PageServer:
    """The server at `url`, whose gate lets in whom a test wants."""

    gate: LoginGate
    url: str

    async def open_client(self, role: Role = Role.DRIVE, agent: str = "X11; Linux", token: str = "") -> Any:
        """A client of its own that has logged in."""
        headers = {"Origin": self.url, "User-Agent": agent}
        client = aiohttp.ClientSession(cookie_jar=aiohttp.CookieJar(unsafe=True), headers=headers)
        async with client.post(f"{self.url}/login", json={"token": token or self.gate.invite(role)}) as answer:
            assert answer.status == 200
        return client


@dataclass
class PageServerClient(PageServer):
    """The same with one `client`, which logs in when a test says so."""

    client: Any

    async def log_in(self, role: Role = Role.DRIVE) -> None:
        token = {"token": self.gate.invite(role)}
        async with self.client.post(f"{self.url}/login", json=token, headers={"Origin": self.url}) as answer:
            assert answer.status == 200
            cookie = answer.headers["Set-Cookie"]
            assert "HttpOnly" in cookie
            assert "SameSite=Strict" in cookie

    async def post(self, path: str, value: object) -> tuple[int, str]:
        async with self.client.post(self.url + path, json=value, headers={"Origin": self.url}) as answer:
            return answer.status, await answer.text()

    async def read(self, path: str) -> Any:
        """The JSON at a path."""
        return await read_answer(self.client, self.url + path)


async def read_answer(client: Any, address: str) -> Any:
    """The JSON at an address."""
    async with client.get(address) as answer:
        assert answer.status == 200
        return await answer.json()
