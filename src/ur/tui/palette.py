"""Colours of the interface, for dark and light terminals."""

from dataclasses import dataclass

from rich.style import Style

from ur.run.clients.protocol import Severity
from ur.run.clients.run_state import Mood


@dataclass(frozen=True, slots=True)
class ScreenPalette:
    """Hex colours. `quiet` is for secondary information, `chosen` for the row under the cursor."""

    light: bool
    text: str
    quiet: str
    ground: str
    raised: str
    chosen: str
    accent: str
    green: str
    yellow: str
    red: str

    def of_mood(self, mood: Mood) -> str:
        """Return the colour of a node's state."""
        return {"up": self.green, "busy": self.yellow, "failed": self.red, "idle": self.quiet}[mood]

    def of_severity(self, severity: Severity) -> Style:
        """Return the style of a message."""
        colour = {"debug": self.quiet, "warning": self.yellow, "error": self.red, "fatal": self.red}.get(severity)
        return Style(color=colour or self.text, bold=severity == "fatal" or None)


DARK = ScreenPalette(
    light=False,
    text="#c9d1d9",
    quiet="#6b7683",
    ground="#0f1419",
    raised="#171d24",
    chosen="#22303f",
    accent="#6cb6ff",
    green="#57ab5a",
    yellow="#d9a343",
    red="#f4706b",
)
LIGHT = ScreenPalette(
    light=True,
    text="#24292f",
    quiet="#7c8591",
    ground="#fcfcfb",
    raised="#f1f2f3",
    chosen="#dbe9f9",
    accent="#0a5cc4",
    green="#2a7d3b",
    yellow="#92660a",
    red="#c0262d",
)
