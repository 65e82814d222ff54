"""Write the table of what each command trusts into docs/explain/security.md. A test compares it."""

from __future__ import annotations

from pathlib import Path

from ur.cli.verbs import list_trust

PAGE = Path(__file__).parents[1] / "docs" / "explain" / "security.md"
BEGIN = "<!-- Made by tools/make_trust_table.py from src/ur/cli/verbs/. -->\n"
END = "<!-- The end of the table. -->\n"


def make_table() -> str:
    """The table as Markdown: a line for each command, in the order of the help."""
    lines = ["| command | reads | starts | sends, to whom | writes |", "|---|---|---|---|---|"]
    for name, trust in list_trust():
        lines.append(f"| `ur {name}` | {trust.reads} | {trust.starts} | {trust.sends} | {trust.writes} |")
    return "\n".join(lines) + "\n"


def put_table(page: str) -> str:
    """The page with the table of now."""
    before, _, rest = page.partition(BEGIN)
    _, _, after = rest.partition(END)
    return f"{before}{BEGIN}\n{make_table()}\n{END}{after}"


if __name__ == "__main__":
    PAGE.write_text(put_table(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
