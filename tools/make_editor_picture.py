"""Make docs/images/editor.svg: Neovim with the set-up of editors/neovim.lua, a finding, and completion that is open.

Usage: tools/make_editor_picture.py [OUTPUT]. It needs Neovim and tmux.
"""

import os
import subprocess
import sys
import tempfile
import uuid
from pathlib import Path

from rich.console import Console
from rich.text import Text

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from tools.pictures import IMAGES, ROOT, clean_svg, save, wait_until

COLUMNS, ROWS = 128, 14
BRINGUP = """<launch>
  <!--Summary: Start a robot with its lidar.-->
  <arg name="robot" default="bob"/>
  <arg name="speed" default="0.5"/>
  <include file="$(find rover)/launch/drive.launch.xml">
    <arg name="max_speed" value="$(arg sped)"/>
    <arg name="name" value="$(arg robot)"/>
    <arg name=""/>
  </include>
  <node name="lidar" pkg="rover" type="read_lidr" output="screen"/>
</launch>
"""
DRIVE = """<launch>
  <!--Summary: Drive.-->
  <arg name="max_speed" doc="The fastest that it drives, in m/s"/>
  <arg name="name"/>
  <arg name="acceleration" default="1.0" doc="How fast it becomes faster, in m/s^2"/>
  <arg name="account" default="" doc="Where distances are kept"/>
  <param name="speed" value="$(arg max_speed)"/>
</launch>
"""
SETTINGS = """
vim.o.number = true
vim.o.signcolumn = "yes"
vim.o.completeopt = "menuone,noselect"
vim.o.termguicolors = true
vim.o.laststatus = 0
vim.o.ruler = false
vim.o.showmode = false
vim.o.shortmess = vim.o.shortmess .. "cFI"
vim.cmd("syntax on")
-- Debian 12 has Neovim 0.7, to which the two functions of the set-up are added.
vim.fs = vim.fs or { dirname = function(path) return vim.fn.fnamemodify(path, ":h") end,
  find = function(_, options) return { vim.fn.findfile("package.xml", vim.fn.fnamemodify(options.path, ":h") .. ";")
  } end }
vim.lsp.start = vim.lsp.start or function(config) vim.lsp.buf_attach_client(0, vim.lsp.start_client(config)) end
vim.api.nvim_create_autocmd("BufEnter", { callback = function() vim.bo.omnifunc = "v:lua.vim.lsp.omnifunc" end })
vim.cmd("colorscheme slate | highlight Pmenu guifg=white guibg=#445566 | highlight SignColumn guibg=NONE")
local function first_line(found) return found.message:gsub("\\n.*", "") end
vim.diagnostic.config({ update_in_insert = true, virtual_text = { format = first_line } })
"""


def make_workspace(folder: Path) -> Path:
    """A package with mistakes; the path of the file that is opened."""
    package = folder / "rover"
    for name, text in (("launch/bringup.launch", BRINGUP), ("launch/drive.launch.xml", DRIVE)):
        (package / name).parent.mkdir(parents=True, exist_ok=True)
        (package / name).write_text(text, encoding="utf-8")
    (package / "package.xml").write_text("<package><name>rover</name></package>", encoding="utf-8")
    for name in ("scripts/read_lidar", "bin/ur"):
        path = (package if name.startswith("scripts") else folder) / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(f'#!/bin/sh\nexec "{sys.executable}" -I -m ur "$@"\n', encoding="utf-8")
        path.chmod(0o755)
    setup = (ROOT / "editors/neovim.lua").read_text(encoding="utf-8")
    (folder / "init.lua").write_text(SETTINGS + setup, encoding="utf-8")
    return package / "launch/bringup.launch"


def take_screen(folder: Path, opened: Path) -> str:
    """The screen of Neovim, with its escape sequences."""
    server = f"ur-picture-{uuid.uuid4().hex[:8]}"
    environment = {"PATH": f"{folder}/bin:{os.environ['PATH']}", "HOME": str(folder), "TERM": "screen-256color"}
    environment.update(LC_ALL="C.UTF-8", ROS_PACKAGE_PATH="", COLORTERM="truecolor")

    def tmux(*words: str) -> str:
        command = ["tmux", "-f", "/dev/null", "-L", server, *words]
        done = subprocess.run(command, check=True, capture_output=True, text=True, env=environment, cwd=folder)
        return done.stdout

    def wait_for(text: str) -> None:
        wait_until(lambda: text in tmux("capture-pane", "-p"), repr(text), 60.0)

    editor = ["nvim", "-u", str(folder / "init.lua"), str(opened)]
    tmux("new-session", "-d", "-x", str(COLUMNS), "-y", str(ROWS), *editor)
    try:
        wait_for("■")  # in front of a finding
        tmux("send-keys", "8G", 'f"', "l", "i", "ac", "C-x", "C-o")
        wait_for("account")
        return tmux("capture-pane", "-p", "-e")
    finally:
        tmux("kill-server")


def draw(screen: str) -> str:
    """A screen as SVG that loads nothing from elsewhere."""
    console = Console(record=True, width=COLUMNS, file=open(os.devnull, "w"), force_terminal=True)  # noqa: SIM115, PTH123
    for line in screen.rstrip("\n").split("\n"):
        console.print(Text.from_ansi(line), soft_wrap=True)
    return clean_svg(console.export_svg(title="nvim bringup.launch", unique_id="terminal"))


def main() -> None:
    """Write the picture."""
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else IMAGES / "editor.svg"
    with tempfile.TemporaryDirectory(prefix="ur_picture_") as folder:
        save(draw(take_screen(Path(folder), make_workspace(Path(folder)))), target)


if __name__ == "__main__":
    main()
