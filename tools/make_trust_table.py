"""Write the table of what each command trusts into docs/explain/security.md. A test compares it."""

from pathlib import Path

from ur.cli.verbs import list_trust
from ur.cli.verbs.verb import Trust

PAGE = Path(__file__).parents[1] / "docs" / "explain" / "security.md"
BEGIN = "<!-- Made by tools/make_trust_table.py from src/ur/cli/verbs/. -->\n"
END = "<!-- The end of the table. -->\n"


SSH = "to the robot, by ssh with a known host key"


def make_table() -> str:
    """The table as Markdown, in the order of the help: a line for the commands that trust the same."""
    names: dict[Trust, list[str]] = {}
    for name, trust in list_trust():
        names.setdefault(trust, []).append(f"`ur {name}`")
    lines = ["| command | reads | starts | sends, to whom | writes |", "|---|---|---|---|---|"]
    for trust, commands in names.items():
        sends = trust.sends.replace(SSH, "*to the robot*")
        cells = (", ".join(commands), trust.reads, trust.starts, sends, trust.writes)
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def put_table(page: str) -> str:
    """The page with the table of now."""
    before, _, rest = page.partition(BEGIN)
    _, _, after = rest.partition(END)
    return f"{before}{BEGIN}\n{make_table()}\n{END}{after}"


if __name__ == "__main__":
    PAGE.write_text(put_table(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
