"""Make docs/reference/bases.md from the base files, and the sensors of docs/how-to/describe-a-base.md.

A test compares what is committed with this.
"""

from collections.abc import Callable, Sequence
from pathlib import Path

from ur.robot.base import SENSORS, Base, UpstreamDriver, list_bases, list_variants, load_base
from ur_nodes.motion.obstacle_stop.guard import BLIND
from ur_nodes.motion.obstacle_stop.obstacle_stop import make_sight
from ur_nodes.motion.obstacle_stop.sensors import Side, covers

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "ubiquity_launches"
PAGE = ROOT / "docs" / "reference" / "bases.md"
EXPLAINED = ROOT / "docs" / "how-to" / "describe-a-base.md"
PICTURES = "../images/bases"

_INTRODUCTION = """# Robot bases

Made from `ubiquity_launches/bases/<base>/base.yaml` by `tools/make_base_page.py`: change those files instead. They say
where each figure comes from. The same file feeds the simulator, the URDF and the real robot's drivers;
[describe a base of your own](../how-to/describe-a-base.md) tells what may stand in it.

"""


def make_page(package: Path = PACKAGE) -> str:
    """The page as Markdown."""
    bases = {name: load_all(package, name) for name in list_bases(package)}
    every = [base for variants in bases.values() for base in variants]
    parts = [_INTRODUCTION, *_table(["base", "what it is"], [[_name(base), base.summary] for base in every]), "\n"]
    for name, variants in bases.items():
        parts += [f"## {name}\n\n", *_pictures(variants), *_figures(variants), "\n", *_drivers(variants)]
    return "".join(parts).rstrip() + "\n"


def explain_sensors(page: str) -> str:
    """The page on base files with the examples of all sensors between the keys `sensors` and `driver`."""
    inner = [kind.example.strip("\n") for name, kind in SENSORS.items() if name != "battery"]
    lines = [*(f"  {line}" for text in inner for line in text.splitlines()), SENSORS["battery"].example.strip("\n")]
    before, head, rest = page.partition("\nsensors: # all may be left out\n")
    _, tail, after = rest.partition("\ndriver: ")
    return before + head + "\n".join(lines) + tail + after


def load_all(package: Path, name: str) -> list[Base]:
    """The plain base and its variants."""
    return [load_base(package, name, variant) for variant in ("", *list_variants(package, name))]


def _name(base: Base) -> str:
    return f"`{base.name}`, variant `{base.variant}`" if base.variant else f"`{base.name}`"


def _pictures(variants: Sequence[Base]) -> list[str]:
    found = []
    for base in variants:
        file = f"{base.name}.{base.variant}.png" if base.variant else f"{base.name}.png"
        if (PAGE.parent / PICTURES / file).is_file():
            words = f"{base.name}, variant {base.variant}," if base.variant else base.name
            found.append(f"![{words} in RViz]({PICTURES}/{file})\n")
    return [*found, "\n"] if found else []


def _figures(variants: Sequence[Base]) -> list[str]:
    rows = [[title, *(figure(base) for base in variants)] for title, figure in _ROWS]
    for key, kind in SENSORS.items():
        found = [dict(base.list_sensors()).get(key) for base in variants]
        rows.append([kind.title, *(sensor.describe() if sensor else "none" for sensor in found)])
    shown = [row for row in rows if any(cell != "none" for cell in row[1:])]
    shown = [[title, first, *("same" if cell == first else cell for cell in cells)] for title, first, *cells in shown]
    heads = [f"variant `{base.variant}`" if base.variant else f"`{base.name}`" for base in variants]
    return _table(["", *heads], shown)


def _drivers(variants: Sequence[Base]) -> list[str]:
    drivers: dict[UpstreamDriver, None] = {}
    for base in variants:
        drivers |= dict.fromkeys((*((base.driver,) if base.driver else ()), *base.drivers))
    if not drivers:
        return ["It is only ever simulated: there is no driver.\n\n"]
    lines = []
    for driver in drivers:
        where = f", on `{driver.device}`" if driver.device else ""
        speed = f" at {driver.baud} baud" if driver.baud else ""
        starts = f", started by `{driver.node}`" if driver.node else ""
        package, get = f"the package `{driver.package}`", f". To get it: {driver.install}"
        if driver.package == "ubiquity_launches":
            package, get = "this project", driver.install.removeprefix("it is part of this package")
        what = f"`{driver.executable}` of {package}"
        lines.append(f"- Driver of the {driver.part}: {what}{where}{speed}{starts}{get}.\n")
    return [*lines, "\n"]


def _table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    return [f"| {' | '.join(row)} |\n" for row in (heads, ["---"] * len(heads), *rows)]


def _size(base: Base) -> str:
    xs, ys = zip(*base.footprint, strict=True)
    sides = (max(xs) - min(xs), max(ys) - min(ys), base.height)
    return " x ".join(f"{side * 1000:.0f}" for side in sides) + " mm"


def _wheels(base: Base) -> str:
    wheels = base.wheels
    return f"{2000 * wheels.radius:.0f} x {1000 * wheels.width:.0f} mm, {1000 * wheels.separation:.0f} mm apart"


def _speed(base: Base) -> str:
    return f"{base.limits.velocity:g} m/s, {base.limits.angular_velocity:g} rad/s"


def _starting(base: Base) -> str:
    return f"{base.limits.acceleration:g} m/s², {base.limits.angular_acceleration:g} rad/s²"


def _braking(base: Base) -> str:
    return f"{base.limits.deceleration:g} m/s², {base.limits.angular_deceleration:g} rad/s²"


def _obstacle_stop(base: Base) -> str:
    """Describe where the base sees obstacles while people drive it."""
    sensors = make_sight(base).sensors
    sides: tuple[Side, ...] = ("ahead", "behind")
    seen = [side for side in sides if covers(sensors, side)]
    if not sensors:
        return "where a bumper is pressed" if base.bumpers else "at cliffs" if base.cliffs else "none"
    slow = [side for side in sides if side not in seen]
    return " and ".join(seen) + (f"; {' and '.join(slow)} at most {BLIND:g} m/s" if slow else "")


_ROWS: tuple[tuple[str, Callable[[Base], str]], ...] = (
    ("length x width x height", _size),
    ("mass", lambda base: f"{base.mass:g} kg"),
    ("wheels", _wheels),
    ("speed", _speed),
    ("speeding up", _starting),
    ("braking", _braking),
    ("stops before obstacles", _obstacle_stop),
)


def main() -> None:
    """Write the page."""
    PAGE.parent.mkdir(parents=True, exist_ok=True)
    PAGE.write_text(make_page(), encoding="utf-8")
    EXPLAINED.write_text(explain_sensors(EXPLAINED.read_text(encoding="utf-8")), encoding="utf-8")
    print(PAGE, EXPLAINED, sep="\n")


if __name__ == "__main__":
    main()
