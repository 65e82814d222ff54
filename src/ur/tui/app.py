"""The interface on a large enough terminal: nodes above, log below, keys for everything."""

from __future__ import annotations

from typing import ClassVar

from textual.binding import BindingType

from ur.tui.keys import make_bindings
from ur.tui.steering import Steering


class WatchApp(Steering):
    """Watches and steers one run. Ends with the run, or with `detached` while the run goes on."""

    BINDINGS: ClassVar[list[BindingType]] = make_bindings()
