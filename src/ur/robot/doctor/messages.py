"""Which messages a computer knows, so that two can be compared: one script, and its answer read. Both are pure.

Nodes connect when the MD5 sums of their messages agree, and those are made of the definitions without comments and
blanks (genmsg, gentools). Here too; a message within a message is compared by itself.
"""

from __future__ import annotations

from dataclasses import dataclass

# Python as every robot has it. A folder of the workspace counts before one of the system, as in ROS_PACKAGE_PATH.
MESSAGES_SCRIPT = r"""
timeout 20 python3 - <<'END' 2>/dev/null
import glob, hashlib, os, re
home = os.path.expanduser("~/catkin_ws/src")
roots = [folder for folder, names, _ in os.walk(home) if "package.xml" in _]
for path in os.environ.get("ROS_PACKAGE_PATH", "").split(":"):
    roots += [os.path.dirname(each) for each in glob.glob(path + "/*/package.xml")] if path else []
roots += [os.path.dirname(each) for each in glob.glob("/usr/share/*/package.xml")]
seen = set()
for root in roots:
    package = os.path.basename(root)
    if package in seen:
        continue
    seen.add(package)
    for path in sorted(glob.glob(root + "/msg/*.msg") + glob.glob(root + "/srv/*.srv")):
        with open(path, errors="replace") as file:
            lines = [" ".join(re.sub("#.*", "", line).split()) for line in file]
        digest = hashlib.md5("\n".join(filter(None, lines)).encode()).hexdigest()[:12]
        print(package + "/" + os.path.basename(path), digest, root.replace(os.path.expanduser("~"), "~", 1))
END"""


@dataclass(frozen=True, slots=True)
class Message:
    """A message's definition: a digest of its text, and the folder of its package, with ~ for the user's home."""

    digest: str
    folder: str


def parse_messages(text: str) -> dict[str, Message]:
    """Read what the script printed: by PACKAGE/FILE."""
    rows = (line.split(" ", 2) for line in text.splitlines())
    return {row[0]: Message(row[1], row[2]) for row in rows if len(row) == 3}
