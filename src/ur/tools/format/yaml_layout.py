"""Layout of a launch file in YAML: two blanks for each level, one blank line at most, and comments where they were."""

import re

_ITEM = re.compile(r"-( +)(?=\S)")
_TEXT_BLOCK = re.compile(r"(?:^|[:\s])[|>][+-]?\d?\s*(?:#.*)?\Z")


def lay_out_yaml(text: str) -> str:
    """Return a text with its lines at conventional columns. What it means is compared by the caller."""
    levels: list[tuple[int, int]] = []  # columns of before and of now, from the outermost
    lines: list[str] = []
    block: tuple[int, int] | None = None  # the column of the key of a text, and by how much its lines move
    for line in text.replace("\r\n", "\n").expandtabs(2).split("\n"):
        bare = line.strip()
        column = len(line) - len(line.lstrip())
        if not bare:
            if lines and lines[-1]:
                lines.append("")
            continue
        if block is not None and column > block[0]:
            lines.append(" " * max(column + block[1], 0) + line.lstrip().rstrip())
            continue
        while levels and column < levels[-1][0]:
            levels.pop()
        if not levels or column > levels[-1][0]:
            levels.append((column, levels[-1][1] + 2 if levels else 0))
        start = now = levels[-1][1]
        items = 0
        while found := _ITEM.match(bare):
            column += found.end()
            now += 2
            levels.append((column, now))
            bare = bare[found.end() :]
            items += 1
        lines.append(" " * start + "- " * items + bare)
        block = (levels[-1 - items][0], start - levels[-1 - items][0]) if _TEXT_BLOCK.search(bare) else None
    while lines and not lines[-1]:
        lines.pop()
    return "\n".join(lines) + "\n"
