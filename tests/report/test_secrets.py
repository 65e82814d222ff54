"""Secrets that are planted anywhere are not in the archive."""

import base64
import json
import random
import string
import zipfile
from pathlib import Path
from urllib.parse import quote

import pytest
from mcap.reader import make_reader
from mcap.writer import Writer

from ur.report.archive import write_report
from ur.report.secrets import SecretFilter, is_secret_name
from ur.report.sources import RunSources

SEED = 5
LETTERS = string.ascii_letters + string.digits
LOG_SCHEMA = "std_msgs/Header header\nbyte level\nstring name\nstring msg\n"
NAMES = (
    *("password", "wifi_password", "DB_PASSWD", "dbPassword", "passphrase", "api_key", "API-KEY", "apikey", "secret"),
    *("client_secret", "token", "GITHUB_TOKEN", "access_key", "AWS_SECRET_ACCESS_KEY", "psk", "ssid", "essid", "auth"),
    *("Authorization", "private_key", "credentials", "cookie", "pin", "pwd", "PASS", "wpa_passphrase", "ros_key"),
)
LINES = (
    "{name}={value}",
    "{name}: {value}",
    "{name}:={value}",
    '  "{name}": "{value}",',
    "--{name} {value}",
    "--{name}={value}",
    "[INFO] 12:00 set {name} = '{value}' for the camera",
    "http://camera.local/stream?{name}={value}&size=5",
)
SHAPES = (
    "rtsp://admin:{value}@camera.local/stream",
    "https://{value}@example.org/repository.git",
    "curl -H 'Authorization: Bearer {value}'",
    "reading /home/{value}/.ros/log",
    "token ghp_{value}{value} expired",
)


def make_secret(chance: random.Random, *, plain: bool = False) -> str:
    alphabet = LETTERS if plain else LETTERS + "-_.!+/%$#*äß"
    return chance.choice(LETTERS) + "".join(chance.choice(alphabet) for _ in range(chance.randint(7, 24))) + "x"


def plant(chance: random.Random, count: int) -> tuple[RunSources, list[str], list[str]]:
    """Sources of a run with secrets in parameters, environment, arguments, addresses and logs; texts for messages."""
    secrets: list[str] = []
    parameters: dict[str, object] = {"speed": 0.5, "/robot/name": "bob"}
    environment: dict[str, object] = {"ROS_DISTRO": "noetic"}
    arguments: list[object] = ["ur", "run", "wander"]
    lines: list[str] = ["[INFO] started"]
    said: list[str] = []
    for number in range(count):
        name = chance.choice(NAMES)
        place = number % 6
        secret = make_secret(chance, plain=place in (3, 5))
        secrets.append(secret)
        if place == 0:
            parameters[f"/node_{number}"] = {"list": [{name: secret}, 1], "other": True}
            lines.append(f"connecting with {secret} as was set")  # no name beside it
        elif place == 1:
            environment[f"ROS_{number}_{name}"] = secret
            lines.append(f"base64 {base64.b64encode(secret.encode()).decode()} and {quote(secret, safe='')}")
        elif place == 2:
            arguments += [f"--{name}", secret] if number % 4 else [f"{name}:={secret}"]
            said.append(f"started with {secret}")
        elif place == 3:
            lines.append(chance.choice(SHAPES).format(value=secret))
        elif place == 4:
            lines.append(chance.choice(LINES).format(name=name, value=secret))
        else:
            said.append(chance.choice(SHAPES + LINES[:4]).format(name=name, value=secret))
    values: dict[str, object] = {
        "run.json": {"run": "wander.1", "arguments": arguments},
        "parameters.json": parameters,
        "environment.json": environment,
    }
    return RunSources({"logs/wander.log": "\n".join(lines) + "\n"}, values), secrets, said


def log_message(text: str) -> bytes:
    data = text.encode()
    head = bytes(16) + b"\x02" + (4).to_bytes(4, "little") + b"/bot"
    return head + len(data).to_bytes(4, "little") + data + bytes(12)


def write_recording(path: Path, texts: list[str]) -> None:
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start(profile="ros1", library="test")
        schema = writer.register_schema("rosgraph_msgs/Log", "ros1msg", LOG_SCHEMA.encode())
        channel = writer.register_channel("/rosout", "ros1", schema)
        for number, text in enumerate(texts):
            writer.add_message(channel, number, log_message(text), number)
        writer.add_metadata("events", {"1.000": "password=" + "hunter22222"})
        writer.finish()  # type: ignore[no-untyped-call]


def read_everything(path: Path) -> dict[str, bytes]:
    found = {}
    with zipfile.ZipFile(path) as archive:
        for name in archive.namelist():
            found[name] = archive.read(name)
        with archive.open("recording.mcap") as file:
            reader = make_reader(file)
            found["messages"] = b"\n".join(message.data for _, _, message in reader.iter_messages())
            found["metadata"] = json.dumps([each.metadata for each in reader.iter_metadata()]).encode()
    return found


def test_no_planted_secret_is_in_the_archive(tmp_path: Path) -> None:
    sources, secrets, said = plant(random.Random(SEED), 1000)
    recording = tmp_path / "box.mcap"
    write_recording(recording, said)
    report = write_report(tmp_path / "report.zip", sources, [recording])
    found = read_everything(report.path)
    forms = {
        secret: (secret, quote(secret, safe=""), base64.b64encode(secret.encode()).decode().rstrip("="))
        for secret in [*secrets, "hunter22222"]
    }
    left = [
        (secret, name)
        for secret, each in forms.items()
        for name, data in found.items()
        if any(form.encode() in data or json.dumps(form)[1:-1].encode() in data for form in each)
    ]
    assert left == []
    assert b"[INFO] started" in found["logs/wander.log"]
    assert b'"speed":0.5' in found["parameters.json"].replace(b" ", b"")
    assert len(report.removed) >= 5
    assert not report.missing


def test_messages_keep_their_length() -> None:
    secrets = SecretFilter()
    data = b"\x01\x00token=abcdefgh rest"
    assert secrets.clean_bytes(data, "a") == b"\x01\x00token=******** rest"
    assert secrets.clean_bytes(b"\x01\xff\x00", "a") == b"\x01\xff\x00"


@pytest.mark.parametrize("name", ["compass", "passengers", "author", "monkey", "spin", "keyboard", "bypass", "mapping"])
def test_names_that_only_look_alike_stay(name: str) -> None:
    assert not is_secret_name(name)
    assert SecretFilter().clean(f"{name}: 5\n{name}=north", "a") == f"{name}: 5\n{name}=north"


def test_what_was_removed_is_listed_without_its_value() -> None:
    secrets = SecretFilter()
    text = secrets.clean("psk=verysecret and http://bob:verysecret@robot/", "log")
    assert "verysecret" not in text
    assert dict(secrets.removed) == {
        ("log", "value with the name of a secret"): 1,
        ("log", "password in an address"): 1,
    }


def test_text_with_too_many_secrets_to_look_for_is_left_out() -> None:
    secrets = SecretFilter(1000)
    secrets.learn_text("token=abcdef\ntoken=ghijkl\n")
    assert "abcdef" not in secrets.clean("abcdef " * 1000, "log")
    assert dict(secrets.removed) == {("log", "text: too many secrets to look for"): 1}


@pytest.mark.parametrize(
    "text",
    [
        *("mot_de_passe: hunter22", "contraseña = 'hunter22'", "пароль: hunter22", "密码=hunter22", "hasło=hunter22"),
        *("('password', 'hunter22')", 'setPassword("hunter22")', '#define PASSWORD "hunter22"', 'password{"hunter22"}'),
        *(
            "password = b'hunter22'",
            'password = """hunter22"""',
            '\\"password\\": \\"hunter22\\"',
        ),
        *("<password>hunter22</password>", "password=`hunter22`"),
    ],
)
def test_secrets_of_many_languages_leave_a_log(text: str) -> None:
    secrets = SecretFilter()
    secrets.learn_text(text)
    assert "hunter22" not in secrets.clean(f"{text}\nagain: hunter22\n", "log")
