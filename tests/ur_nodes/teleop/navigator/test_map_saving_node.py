from __future__ import annotations

import threading

from ur_nodes.teleop.navigator.map_saving_node import HINT, MapSaving


def test_save_runs_aside_and_once_at_a_time() -> None:
    begun, go, done = threading.Event(), threading.Event(), threading.Event()
    calls = []

    def save() -> str:
        calls.append(1)
        begun.set()
        go.wait(30.0)
        done.set()
        return "map 'flat' saved"

    saving = MapSaving(save)
    assert saving.take_news() == HINT
    saving.ask()
    assert begun.wait(30.0)
    saving.ask()
    assert saving.take_news() == "saving the map ..."
    go.set()
    assert done.wait(30.0)
    while not (news := saving.take_news()):
        pass
    assert news == "map 'flat' saved"
    assert len(calls) == 1
