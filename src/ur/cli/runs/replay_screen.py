"""The replay that runs, on a terminal: its position, and keys that pause it, jump, and change its speed."""

from collections.abc import Mapping
from typing import ClassVar

from rich.text import Text
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.widgets import Footer, ProgressBar, Static

from ur.recordings.replays import CommandName, ReplayCommand, ReplayState, ask_replay
from ur.tui.screen.app import FullScreenApp
from ur.tui.screen.query import ask_background, is_light

_REFRESH = 0.25  # s
_SPEEDS = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0)
_STYLES = {"ended": "dim", "playing": "green", "paused": "yellow"}


class ReplayScreen(FullScreenApp[None]):
    """Shows the replay of this user until it ends, or a key leaves it; the replay goes on."""

    CSS = """
    Screen { align: center middle; }
    #state { width: auto; height: 1; margin: 1; }
    ProgressBar { width: 80%; } Bar { width: 1fr; } #percentage, #eta { display: none; }
    """
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("space", "play", "Pause, play"),
        Binding("left", "command('back', 10)", "10 s", key_display="←"),
        Binding("right", "command('ahead', 10)", "10 s", key_display="→"),
        Binding("comma", "command('back', 1)", "Back 1 s", show=False),
        Binding("full_stop", "command('ahead', 1)", "Ahead 1 s", show=False),
        Binding("home,0", "command('jump', 0)", "Start", key_display="0"),
        Binding("minus,down", "speed(-1)", "Slower", key_display="-"),
        Binding("plus,equals_sign,up", "speed(1)", "Faster", key_display="+"),
        Binding("q,escape", "quit", "Leave", key_display="q"),
        Binding("ctrl+c", "quit", "Leave", priority=True, show=False),
    ]

    def __init__(self, environment: Mapping[str, str], *, light: bool = False) -> None:
        super().__init__()
        self._environment, self._light = environment, light
        self.newest: ReplayState | None = None

    def compose(self) -> ComposeResult:
        """Lay out the state, the position and the keys."""
        yield Static(id="state")
        yield ProgressBar()
        yield Footer()

    def on_mount(self) -> None:
        """Show the replay, again and again."""
        self.use_theme(light=self._light)
        self.action_command("state")
        self.set_interval(_REFRESH, lambda: self.action_command("state"))

    def action_command(self, name: CommandName, value: float = 0.0) -> None:
        """Send a command, and show the state after it."""
        self.newest = state = ask_replay(ReplayCommand(name, value), self._environment)
        if state is None:
            self.exit()
            return
        place = f"  {state.position:.1f} of {state.length:.1f} s  speed {state.speed:g}"
        if not (self.query("#state") and self.query(ProgressBar)):  # the screen is being taken down
            return
        self.query_one("#state", Static).update(Text.assemble((state.doing, _STYLES[state.doing]), place))
        self.query_one(ProgressBar).update(total=max(state.length, 0.1), progress=state.position)

    def action_play(self) -> None:
        """Pause, or play; at the end it plays again from the start."""
        running = self.newest is not None and self.newest.doing == "playing"
        self.action_command("pause" if running else "play")

    def action_speed(self, step: int) -> None:
        """Take the next speed."""
        now = self.newest.speed if self.newest else 1.0
        speeds = [each for each in _SPEEDS if (each > now * 1.01 if step > 0 else each < now * 0.99)]
        if speeds:
            self.action_command("speed", speeds[0] if step > 0 else speeds[-1])


def show_replay(environment: Mapping[str, str]) -> int:
    """Show the replay until it ends or the user leaves it. Returns the exit code."""
    screen = ReplayScreen(environment, light=is_light(environment, ask_background(0, 1)))
    screen.run()
    if screen.problem is not None:
        raise screen.problem
    return 0
