#!/usr/bin/python3
"""Stand-in for wpa_supplicant, wpa_cli and hostapd on a robot of the bench: no kernel of a container has a radio.

Installed under these names. The networks in the air are in /etc/bench-air.json: {ssid: [password, whether the robot
then reaches the bench, dBm]}. `wlan0` is a veth; its other end, `air`, is on the bridge `ether` while it is associated.
"""

import codecs
import json
import re
import signal
import socket
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

AIR = Path("/etc/bench-air.json")


def ip(*words: str) -> None:
    subprocess.run(["ip", "link", "set", "air", *words], check=False)


def escape(ssid: str) -> str:
    """Return a name as wpa_supplicant prints it."""
    return "".join(chr(byte) if 32 <= byte < 127 else f"\\x{byte:02x}" for byte in ssid.encode())


class Supplicant:
    """One that reads the configuration that netplan makes, and answers as wpa_supplicant does."""

    def __init__(self, conf: str) -> None:
        self.networks = []
        for block in re.findall(r"^network=\{\n(.*?)^\}", conf, re.MULTILINE | re.DOTALL):
            values = dict(line.strip().partition("=")[::2] for line in block.splitlines())
            ssid, psk = values["ssid"], values.get("psk", "").strip('"')
            raw = ssid[2:-1] if ssid.startswith('P"') else ssid[1:-1]
            name = codecs.escape_decode(raw.encode())[0].decode() if ssid.startswith('P"') else raw
            self.networks.append({"ssid": name, "psk": psk, "priority": 0, "refused": False})
        self.used = -1
        self.associate()

    def associate(self) -> None:
        """Choose by priority, then by strength; a wrong password is refused."""
        air, good = json.loads(AIR.read_text()), []
        for number, each in enumerate(self.networks):
            password, _, strength = air.get(each["ssid"], [None, False, 0])
            each["refused"] = each["ssid"] in air and each["psk"] != password
            if password == each["psk"]:
                good.append((each["priority"], strength, number))
        self.used = max(good)[2] if good else -1
        if self.used < 0:
            ip("down")
        elif air[self.networks[self.used]["ssid"]][1]:
            ip("master", "ether", "up")
        else:
            ip("nomaster", "up")

    def answer(self, words: list[str]) -> str:
        """Answer one request of wpa_cli."""
        if words[0] == "list_networks":
            rows = ["network id / ssid / bssid / flags"]
            for number, each in enumerate(self.networks):
                flags = "[CURRENT]" if number == self.used else "[TEMP-DISABLED]" if each["refused"] else ""
                rows.append(f"{number}\t{escape(each['ssid'])}\tany\t{flags}")
            return "\n".join(rows)
        if words[0] == "get_network":
            ssid = self.networks[int(words[1])]["ssid"] if words[1:2] and words[1].isdigit() else ""
            return f'"{ssid}"' if ssid.isascii() else ssid.encode().hex()
        if words[0] == "status":
            used = self.networks[self.used]["ssid"] if self.used >= 0 else ""
            return f"ssid={escape(used)}\nid={self.used}\nwpa_state=COMPLETED" if used else "wpa_state=SCANNING"
        if words[0] == "scan_results":
            rows = ["bssid / frequency / signal level / flags / ssid"]
            for ssid, (password, _, strength) in json.loads(AIR.read_text()).items():
                rows.append(
                    f"02:00:00:00:00:01\t2437\t{strength}\t{'[WPA2-PSK-CCMP]' if password else ''}[ESS]\t{escape(ssid)}"
                )
            return "\n".join(rows)
        if words[0] == "set_network":
            self.networks[int(words[1])][words[2]] = int(words[3])
        elif words[0] == "reassociate":
            self.associate()
        return "PONG" if words[0] == "ping" else "OK"


def serve(options: list[str]) -> None:
    """Run as wpa_supplicant with netplan's options, or with those of a scan."""
    device = next(each[2:] for each in options if each.startswith("-i") and len(each) > 2)
    folder = Path("/run/wpa_supplicant")
    folder.mkdir(exist_ok=True)
    (folder / device).unlink(missing_ok=True)
    with socket.socket(socket.AF_UNIX) as server:
        supplicant = Supplicant(Path(options[options.index("-c") + 1]).read_text())
        server.bind(str(folder / device))
        server.listen()
        server.settimeout(0.5)
        air = AIR.read_text()
        while True:
            if AIR.read_text() != air:  # what is in reach has changed
                air = AIR.read_text()
                supplicant.associate()
            with suppress(OSError, IndexError, ValueError), server.accept()[0] as link:
                link.sendall(supplicant.answer(json.loads(link.recv(65536))).encode())


def serve_others(conf: str) -> None:
    """Run as hostapd, until it is ended: whoever is on `ether` has joined."""
    settings = dict(line.split("=") for line in conf.splitlines())
    assert settings["wpa"] == "2"
    assert len(settings["wpa_passphrase"]) >= 8
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
    ip("down")
    ip("master", "ether", "up")
    try:
        while True:
            signal.pause()
    finally:
        ip("down")


def ask(words: list[str]) -> str:
    """Run as wpa_cli."""
    options = {words.pop(0): words.pop(0) for _ in range(2) if words and words[0].startswith("-")}
    with socket.socket(socket.AF_UNIX) as link:
        link.connect(f"{options.get('-p', '/run/wpa_supplicant')}/{options['-i']}")
        link.sendall(json.dumps(words).encode())
        return link.makefile().read()


if __name__ == "__main__":
    if Path(sys.argv[0]).name == "wpa_cli":
        try:
            sys.stdout.write(ask(sys.argv[1:]) + "\n")
        except OSError:
            sys.exit("Failed to connect to non-global ctrl_ifname")
    elif Path(sys.argv[0]).name == "hostapd":
        serve_others(Path(sys.argv[1]).read_text())
    else:
        serve(sys.argv[1:])
