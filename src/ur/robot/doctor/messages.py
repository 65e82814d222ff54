"""Message definitions on a computer, for comparison: one script, and the parser of its output. Both are pure.

Nodes connect if the MD5 sums of their messages agree. These are in the Python modules that genpy generates. Definitions
that are not built yet are compared by their text without comments and blanks, from which the sums are computed
(gentools); a nested message is compared separately.
"""

from dataclasses import dataclass

# Python of the robot's system. A package in the workspace takes precedence over the system's, as it does in ROS.
MESSAGES_SCRIPT = r"""
timeout 20 python3 -I - <<'END' 2>/dev/null
import glob, hashlib, os, re, sys
home = os.path.expanduser("~")
work = home + "/catkin_ws"
seen = set()
def tell(name, digest, folder):
    if name not in seen:
        seen.add(name)
        print(name, digest, "~" + folder[len(home):] if folder.startswith(home + "/") else folder)
python = "lib/python%d/dist-packages" % sys.version_info[0]
shown = [place for place in os.environ.get("PYTHONPATH", "").split(":") if place.startswith("/")]
for place in [work + "/devel/" + python, *shown, *sys.path, *glob.glob("/opt/ros/*/" + python), "/usr/" + python]:
    for path in place and sorted(glob.glob(place + "/*/msg/_*.py") + glob.glob(place + "/*/srv/_*.py")):
        root, kind, file = path.rsplit("/", 2)
        with open(path, errors="replace") as text:
            sums = re.findall(r"^ *_md5sum *= *['\"](\w+)", text.read(), re.M)
        if sums:
            tell(os.path.basename(root) + "/" + file[1:-3], sums[-1][:12], root)
roots = [folder for folder, _, files in os.walk(work + "/src") if "package.xml" in files]
for path in filter(None, os.environ.get("ROS_PACKAGE_PATH", "").split(":")):
    roots += [os.path.dirname(each) for each in glob.glob(path + "/*/package.xml")]
for root in roots + [os.path.dirname(each) for each in glob.glob("/usr/share/*/package.xml")]:
    for path in sorted(glob.glob(root + "/msg/*.msg") + glob.glob(root + "/srv/*.srv")):
        with open(path, errors="replace") as file:
            lines = [" ".join(re.sub("#.*", "", line).split()) for line in file]
        digest = hashlib.md5("\n".join(filter(None, lines)).encode()).hexdigest()[:12]
        tell(os.path.basename(root) + "/" + os.path.basename(path), digest, root)
END"""


@dataclass(frozen=True, slots=True)
class Message:
    """A message: a digest of its definition, and the folder of its package or module, with ~ for the user's home."""

    digest: str
    folder: str


def parse_messages(text: str) -> dict[str, Message]:
    """Parse the output of the script: built messages by PACKAGE/TYPE, definitions by PACKAGE/FILE."""
    rows = (line.split(" ", 2) for line in text.splitlines())
    return {row[0]: Message(row[1], row[2]) for row in rows if len(row) == 3}
