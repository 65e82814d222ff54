"""Inspection of the devices of a computer: one shell script, and the parser of its output. Both are pure."""

import posixpath
import re
from collections.abc import Iterable, Iterator, Mapping

from ur.devices.known import Device, DeviceHolder, DeviceSnapshot, Kind
from ur.source.foreign.numbers import parse_integer

RULES_FILE = "/etc/udev/rules.d/70-ubiquity.rules"
MOST_DEVICES = 200
_MARK = "\x1e"
_KINDS: Mapping[str, Kind] = {
    "tty": "serial",
    "video4linux": "camera",
    "input": "joystick",
    "i2c-dev": "i2c",
    "gpio": "gpio",
    "hidraw": "hid",
    "usb": "usb",
}
# Parts of a Raspberry Pi that process pictures: they have the class of cameras, and are none.
_NO_CAMERA = re.compile(r"bcm2835-(codec|isp)|pispbe|rpivid|rpi-hevc|hevc|m2m", re.IGNORECASE)
_PATH = re.compile(r"/dev/[\w./:+@-]{1,200}")
_USB = re.compile(r"[0-9a-f]{4}:[0-9a-f]{4}")

# `R` is '' but in tests. A port of a serial chip that is not there has the type 0.
_DEVICES = r"""
text() { [ ! -r "$2" ] || printf '%s %s\n' "$1" "$(tr -d '\000-\037\177' <"$2" 2>/dev/null | head -c 200)"; }
usb() { u=$1; while [ -n "$u" ] && [ "$u" != "$R/sys/devices" ] && [ ! -e "$u/idVendor" ]; do u=${u%/*}; done
[ -e "$u/idVendor" ]; }
about() { echo "usb $(cat "$1/idVendor"):$(cat "$1/idProduct")"; echo "port ${1##*/}"
for t in serial manufacturer product; do text "$t" "$1/$t"; done; }
node() { echo "path $1"; stat -L -c 'mode %a %U %G' "$R$1" 2>/dev/null
[ ! -r "$R$1" ] || [ ! -w "$R$1" ] || echo allowed; }
for e in "$R"/sys/class/tty/* "$R"/sys/class/video4linux/* "$R"/sys/class/input/js* "$R"/sys/class/i2c-dev/* \
"$R"/sys/class/hidraw/*; do
[ -e "$e/device" ] || continue
n=${e##*/}; c=${e%/*}; c=${c##*/}; p=/dev/$n; [ "$c" != input ] || p=/dev/input/$n
[ -e "$R$p" ] || continue
[ "$(cat "$e/type" 2>/dev/null)" != 0 ] || continue
i=$(cat "$e/index" 2>/dev/null); [ "${i:-0}" = 0 ] || continue
mark device; echo "class $c"; node "$p"; text name "$e/name"
d=$(readlink -f "$e/device"); w=$(readlink "$d/driver"); [ -z "$w" ] || echo "driver ${w##*/}"
! usb "$d" || about "$u"
done
for e in "$R"/sys/bus/gpio/devices/gpiochip*; do
[ -e "$R/dev/${e##*/}" ] || continue
mark device; echo "class gpio"; node "/dev/${e##*/}"
done
for u in "$R"/sys/bus/usb/devices/*; do
[ -e "$u/idVendor" ] || continue
[ "$(cat "$u/bDeviceClass" 2>/dev/null)" != 09 ] || continue
mark device; echo "class usb"
node "$(printf '/dev/bus/usb/%03d/%03d' "$(cat "$u/busnum" 2>/dev/null)" "$(cat "$u/devnum" 2>/dev/null)")"
about "$(readlink -f "$u")"
done"""
# A program that has a device open shows it only to its own user and to root; a login prompt names it.
_HOLDERS = r"""
[ "$(id -u)" != 0 ] || echo all
find "$R"/proc/[0-9]*/fd -maxdepth 1 \( -lname '/dev/tty[A-Z]*' -o -lname '/dev/video*' -o -lname '/dev/input/js*' \
-o -lname '/dev/hidraw*' -o -lname '/dev/i2c-*' -o -lname '/dev/gpiochip*' \
-o -lname '/dev/bus/usb/*' \) -printf '%h %l\n' 2>/dev/null |
sort -u | while read -r f l; do p=${f%/fd}; p=${p##*/}
echo "$p $(stat -c %U "$R/proc/$p" 2>/dev/null) $l $(head -c 60 "$R/proc/$p/comm" 2>/dev/null)"; done"""
_GRABBERS = r"""
for f in "$R"/proc/[0-9]*/comm; do c=; read -r c 2>/dev/null <"$f"; p=${f%/comm}
case $c in ModemManager|brltty|agetty) echo "${p##*/} $(stat -c %U "$p" 2>/dev/null) $c \
$(tr '\0\n' '  ' <"$p/cmdline" 2>/dev/null | head -c 200)";; esac; done"""


def device_script(root: str = "") -> str:
    """Return the script that prints a computer's devices, to be run as the user who needs them.

    `root` is a folder with `sys`, `dev` and `proc` in it, for tests; it must need no quoting.
    """
    links = (
        'find "$R/dev" -maxdepth 1 -type l -printf "%p %l\\n" 2>/dev/null; '
        'find "$R"/dev/serial/by-id "$R"/dev/v4l/by-id "$R"/dev/input/by-id -maxdepth 1 -type l -printf "%p %l\\n" '
        "2>/dev/null"
    )
    return "\n".join(
        [
            "mark() { printf '\\036%s\\n' \"$1\"; }; export LC_ALL=C",
            f"R={root}",
            'mark user; id -un; id -nG; id -nG "$(id -un)"',
            f"mark ruled; [ ! -e {RULES_FILE} ] || echo yes",
            'mark container; cat "$R/run/systemd/container" 2>/dev/null; '
            '[ ! -e "$R/.dockerenv" ] || echo docker; [ ! -e "$R/run/.containerenv" ] || echo podman',
            f"mark links; {links}",
            f"mark holders{_HOLDERS}",
            f"mark grabbers{_GRABBERS}",
            _DEVICES,
            "mark end",
        ]
    )


def parse_devices(output: str, root: str = "") -> DeviceSnapshot:
    """Parse the output of the script; missing or invalid parts are left out."""
    parts = [part.partition("\n")[::2] for part in output.replace("\0", "").split(_MARK)[1:]]
    named = dict(parts)
    user, groups, member = [*named.get("user", "").splitlines(), "", "", ""][:3]
    holders = tuple(_holders(named.get("holders", "").splitlines()))
    grabbers = tuple(_grabbers(named.get("grabbers", "").splitlines()))
    links = _links(named.get("links", "").splitlines(), root)
    found: dict[str, Device] = {}
    for name, text in parts:
        device = _device(text, links, holders, grabbers) if name == "device" and len(found) < MOST_DEVICES else None
        if device is not None:
            found.setdefault(device.path, device)
    taken = {device.port for device in found.values() if device.kind != "usb" and device.port}
    return DeviceSnapshot(
        user=user,
        groups=frozenset(groups.split()),
        member=frozenset(member.split()),
        devices=tuple(device for device in found.values() if device.kind != "usb" or device.port not in taken),
        grabbers=tuple(holder for holder, _ in grabbers if holder.program != "agetty"),
        complete=named.get("holders", "").startswith("all\n"),
        container=bool(named.get("container", "").strip()),
        ruled=named.get("ruled", "").strip() == "yes",
    )


def _device(
    text: str,
    links: Mapping[str, tuple[str, ...]],
    holders: Iterable[tuple[str, DeviceHolder]],
    grabbers: Iterable[tuple[DeviceHolder, str]],
) -> Device | None:
    rows = {key: value for key, _, value in (line.partition(" ") for line in text.splitlines())}
    kind, path = _KINDS.get(rows.get("class", "")), rows.get("path", "")
    if kind is None or not _PATH.fullmatch(path):
        return None
    product = rows.get("product", "").strip() or rows.get("name", "").strip()
    if kind == "camera" and _NO_CAMERA.search(rows.get("name", "")):
        return None
    mode, owner, group = [*rows.get("mode", "").split(), "", "", ""][:3]
    opened = [holder for where, holder in holders if where == path]
    opened += [holder for holder, line in grabbers if holder.program == "agetty" and path[5:] in line.split()]
    usb = rows.get("usb", "").strip()
    return Device(
        path=path,
        kind=kind,
        usb=usb if _USB.fullmatch(usb) else "",
        serial=rows.get("serial", "").strip(),
        manufacturer=rows.get("manufacturer", "").strip(),
        product=product,
        driver=rows.get("driver", "").strip(),
        port=rows.get("port", "").strip(),
        links=links.get(path, ()),
        mode=parse_integer(mode, 8),
        owner=owner,
        group=group,
        allowed="allowed" in rows,
        holders=tuple({holder.pid: holder for holder in opened}.values()),
    )


def _links(lines: Iterable[str], root: str) -> dict[str, tuple[str, ...]]:
    found: dict[str, list[str]] = {}
    for line in lines:
        name, _, target = line.partition(" ")
        name = name.removeprefix(root)
        full = posixpath.normpath(posixpath.join(posixpath.dirname(name), target))
        if _PATH.fullmatch(name) and target:
            found.setdefault(full, []).append(name)
    return {target: tuple(sorted(names)) for target, names in found.items()}


def _holders(lines: Iterable[str]) -> Iterator[tuple[str, DeviceHolder]]:
    for line in lines:
        pid, _, rest = line.partition(" ")
        user, _, rest = rest.partition(" ")
        path, _, program = rest.partition(" ")
        number = parse_integer(pid)
        if number is not None and _PATH.fullmatch(path):
            yield path, DeviceHolder(number, program.strip(), user)


def _grabbers(lines: Iterable[str]) -> Iterator[tuple[DeviceHolder, str]]:
    for line in lines:
        row = line.split(" ", 3)
        number = parse_integer(row[0]) if len(row) >= 3 else None
        if number is not None:
            yield DeviceHolder(number, row[2], row[1]), row[3] if len(row) > 3 else ""
