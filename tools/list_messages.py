"""Print every message that the verbs of `ur` print on wrong input, from the golden file; --update makes it again."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from tests.cli.wrong_inputs import GOLDEN, describe_messages


def main() -> None:
    """Print the golden file, made again before with --update."""
    if "--update" in sys.argv[1:]:
        GOLDEN.write_text(describe_messages(), encoding="utf-8")
    print(GOLDEN.read_text(encoding="utf-8"), end="")


if __name__ == "__main__":
    main()
