"""Visit two places, and keep a picture of each in this folder."""

from pathlib import Path

from ur_nodes.client import Lost, Robot

with Robot() as robot:
    here = robot.pose()
    places = {"table": (here.x + 0.5, here.y), "door": (here.x, here.y)}
    for name, (x, y) in places.items():
        robot.go_to(x, y)
        try:
            picture = robot.picture()
        except Lost as reason:
            print(f"{name}: no picture: {reason}")
            continue
        file = Path(f"{name}.{picture.format.split()[0]}")
        file.write_bytes(picture.data)
        print(f"{name}: {file}, {len(picture.data)} bytes")
