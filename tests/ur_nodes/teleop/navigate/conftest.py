from collections.abc import AsyncIterator
from typing import Any

import pytest_asyncio
from tests.ur_nodes.teleop.navigate.app_screen import AppScreen, open_app

from ur_nodes.client.waypoints import WaypointStore


@pytest_asyncio.fixture
async def screen(navigator: Any, store: WaypointStore) -> AsyncIterator[AppScreen]:
    async with open_app(navigator, store) as shown:
        yield shown
