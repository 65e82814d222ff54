"""A client of Nav2's services, of rclpy alone: prints their answers as JSON. Argument: a folder.

In the folder are `first.yaml`, which is served, and `second.yaml`.
"""

from __future__ import annotations

import json
import sys
from importlib import import_module
from pathlib import Path
from typing import Any

import rclpy
from nav_msgs.srv import GetMap

NAV2 = import_module("nav2_msgs.srv")  # the tests generate it
PATIENCE = 30.0  # s


class ServiceStage:
    def __init__(self) -> None:
        rclpy.init()
        self.node = rclpy.create_node("stranger")

    def ask(self, name: str, kind: Any, /, **fields: Any) -> Any:
        client = self.node.create_client(kind, name)
        assert client.wait_for_service(PATIENCE), name
        future = client.call_async(kind.Request(**fields))
        rclpy.spin_until_future_complete(self.node, future, timeout_sec=PATIENCE)
        assert future.done(), f"no answer of {name}"
        return future.result()


def main(folder: Path) -> None:
    stage = ServiceStage()
    served = stage.ask("map_server/map", GetMap).map
    loaded = stage.ask("map_server/load_map", NAV2.LoadMap, map_url=str(folder / "second.yaml"))
    missing = stage.ask("map_server/load_map", NAV2.LoadMap, map_url=str(folder / "third.yaml"))
    found = {
        "served": [served.info.width, served.info.height],
        "loaded": [loaded.result, loaded.map.info.width, loaded.map.info.height],
        "missing": missing.result,
        "cleared": [
            str(stage.ask(f"{each}_costmap/clear_entirely_{each}_costmap", NAV2.ClearEntireCostmap))
            for each in ("global", "local")
        ],
    }
    sys.stdout.write(json.dumps(found) + "\n")
    rclpy.shutdown()


if __name__ == "__main__":
    main(Path(sys.argv[1]))
