"""A package with each trap of heads and silent meanings once: each is named with file, line and help."""

from ur.check.session import check_paths
from ur.launchfile.world import MemoryWorld

FOLDER = "/ws/my_robot"
TF = "static_transform_publisher"
DRIVERS = ("crlf.py", "python.py", "bare.py", "two.py")
LAUNCH = "\n".join(
    [
        "<launch>",
        '  <param name="/use_sim_time" value="true"/>',
        '  <param name="tolerance" value="1e-3"/>',
        '  <param name="address" value="0x1F"/>',
        '  <param name="lights" value="on"/>',
        '  <node name="lidar" pkg="rplidar_ros" type="rplidarNode"/>',
        f'  <node name="turned" pkg="tf2_ros" type="{TF}" args="0 0 0 90 0 0 base turned"/>',
        f'  <node name="nine" pkg="tf2_ros" type="{TF}" args="0 0 0 0 0 0 base nine 100"/>',
        f'  <node name="eight" pkg="tf" type="{TF}" args="0 0 0 0 0 0 base eight"/>',
        f'  <node name="laser" pkg="tf2_ros" type="{TF}" args="0 0 0 0 0 0 base laser"/>',
        f'  <node name="again" pkg="tf2_ros" type="{TF}" args="0 0 1 0 0 0 mast laser"/>',
        '  <rosparam file="$(find my_robot)/params/all.yaml"/>',
        *(f'  <node name="{name[:-3]}" pkg="my_robot" type="{name}"/>' for name in DRIVERS),
        "</launch>",
    ]
)
YAML = "tolerance: 1e-3\ncode: 010\nstart: 12:30\nstates: [blink, on]\nbuilt: 2026-01-02\nmonth: 08\n"
MAP = """image: fine.pgm
resolution: 5e-2
origin: ["-1e1", 010, 0]
negate: 0
occupied_thresh: "0.65"
free_thresh: 0.196
"""  # which yaml-cpp reads as numbers
XML = {
    "dashes": "<launch>\n<!-- a -- b -->\n</launch>",
    "ampersand": "<launch>\n<param name='a' value='b & c'/></launch>",
    "less": "<launch>\n<param name='a' value='b < c'/></launch>",
    "roots": "<launch/>\n<launch/>",
    "declaration": "\n<?xml version='1.0'?>\n<launch/>",
    "comment": "<launch>\n<group <!-- a --> ns='a'/></launch>",
    "text": "<launch>\n<rosparam>a: b < c</rosparam></launch>",
    "version": "<?xml version=1.0?>\n<launch/>",
    "encoding": "<?xml version='1.0' encoding='utf-16'?>\n<launch/>",
}
FOUND = {
    *(("launch/all.launch", line, "misread-value") for line in (3, 4, 5)),
    ("launch/all.launch", 2, "no-clock"),
    *(("launch/all.launch", line, "static-transform") for line in (7, 8, 9)),
    ("launch/all.launch", 11, "two-transforms"),
    *((f"scripts/{name}", 2 if name == "two.py" else 1, "bad-script") for name in DRIVERS),
    *(("params/all.yaml", line, "misread-value") for line in range(1, 7)),
    *((f"launch/{name}.launch", 1 if name in ("encoding", "version") else 2, "bad-xml") for name in XML),
}


def test_each_trap_is_named_once_with_file_line_and_help() -> None:
    files = {
        f"{FOLDER}/package.xml": "<package><name>my_robot</name></package>",
        f"{FOLDER}/launch/all.launch": LAUNCH,
        f"{FOLDER}/params/all.yaml": YAML,
        f"{FOLDER}/maps/fine.yaml": MAP,
        f"{FOLDER}/params/not_loaded.yaml": YAML,
        f"{FOLDER}/params/ros2.yaml": "/**: {ros__parameters: {tolerance: 1e-3}}\n",
        f"{FOLDER}/scripts/crlf.py": "#!/usr/bin/env python3\r\nprint(1)\r\n",
        f"{FOLDER}/scripts/python.py": "#!/usr/bin/env python\nprint(1)\n",
        f"{FOLDER}/scripts/bare.py": "print(1)\n",
        f"{FOLDER}/scripts/two.py": "#!/usr/bin/env python3\nprint 'x'\n",
        "/usr/bin/python3": "",
        **{f"{FOLDER}/launch/{name}.launch": text for name, text in XML.items()},
        **{f"/opt/{name}/package.xml": "" for name in ("rplidar_ros", "tf", "tf2_ros")},
        **{f"/opt/{name}/{TF}": "" for name in ("tf", "tf2_ros")},
        "/opt/rplidar_ros/rplidarNode": "",
    }
    packages = {"my_robot": FOLDER, **{name: f"/opt/{name}" for name in ("rplidar_ros", "tf", "tf2_ros")}}
    run = [path for path in files if path.startswith(("/opt", f"{FOLDER}/scripts"))]
    report = check_paths([FOLDER], MemoryWorld(files, packages, {"PATH": "/usr/bin"}, run))
    found = [
        (each.span.file.path.removeprefix(f"{FOLDER}/"), each.span.position.line, each.rule)
        for each in report.findings
        if each.span is not None and each.help
    ]
    assert len(found) == len(report.findings)
    assert sorted(found) == sorted(FOUND)


def test_comment_in_a_script_hides_its_finding() -> None:
    launch = '<launch><node name="two" pkg="my_robot" type="two.py"/></launch>'
    script = "#!/usr/bin/env python3\n# ur: ignore bad-script: converted when it is installed\nprint 'x'\n"
    files = {
        f"{FOLDER}/package.xml": "<package><name>my_robot</name></package>",
        f"{FOLDER}/launch/two.launch": launch,
        f"{FOLDER}/scripts/two.py": script,
    }
    report = check_paths([FOLDER], MemoryWorld(files, {"my_robot": FOLDER}, executables=[f"{FOLDER}/scripts/two.py"]))
    assert report.findings == ()
    assert report.suppressed == 1
