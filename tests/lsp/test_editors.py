"""The set-ups of `editors/` in the editors themselves, each in a scripted session."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from tests.npm_packages import installed

pytest.importorskip("pygls", reason="pygls is not installed: requirements/lsp.lock")

ROOT = Path(__file__).parents[2]
WRONG = '<launch>\n  <arg name="speed" default="1"/>\n  <param name="v" value="$(arg sped)"/>\n</launch>\n'
RIGHT = WRONG.replace("sped)", "speed)")

# Debian 12 has Neovim 0.7, to which the two functions of the set-up are added.
NEOVIM = """
vim.fs = vim.fs or { dirname = function(path) return vim.fn.fnamemodify(path, ":h") end,
  find = function(_, options) return { vim.fn.findfile("package.xml", vim.fn.fnamemodify(options.path, ":h") .. ";")
  } end }
vim.lsp.start = vim.lsp.start or function(config) vim.lsp.buf_attach_client(0, vim.lsp.start_client(config)) end
dofile(SETUP)
vim.cmd("edit " .. FILE)
local function report(count)
  vim.wait(60000, function() return #vim.diagnostic.get(0) == count end, 50)
  local codes = vim.tbl_map(function(each) return each.code .. ":" .. each.lnum end, vim.diagnostic.get(0))
  print("findings [" .. table.concat(codes, " ") .. "]")
end
report(1)
vim.api.nvim_buf_set_lines(0, 2, 3, true, { '  <param name="v" value="$(arg speed)"/>' })
report(0)
local params = { textDocument = { uri = vim.uri_from_bufnr(0) }, position = { line = 2, character = 34 } }
local answers = vim.lsp.buf_request_sync(0, "textDocument/definition", params, 60000)
for _, answer in pairs(answers) do print("definition line " .. answer.result[1].range.start.line) end
vim.cmd("silent write | silent edit " .. vim.fn.fnamemodify(FILE, ":h:h") .. "/params/speed.yaml")
report(1)
vim.cmd("qa!")
"""
EMACS = """
(require 'eglot)
(setq eglot-autoshutdown nil eglot-sync-connect 60 eglot-connect-timeout 60)
(load SETUP)
(find-file FILE)
(eglot-ensure)
(run-hooks 'post-command-hook)
(unless (eglot-current-server) (apply #'eglot--connect (eglot--guess-contact)))
(defun report (count)
  (let ((end (+ (float-time) 60)))
    (while (and (/= (length (flymake-diagnostics)) count) (< (float-time) end))
      (accept-process-output nil 0.05)
      (flymake-start)))
  (princ (format "findings %d\\n" (length (flymake-diagnostics)))))
(report 1)
(goto-char (point-min))
(search-forward "sped")
(replace-match "speed")
(eglot--signal-textDocument/didChange)
(report 0)
(princ (format "definition line %d\\n"
  (plist-get (plist-get (plist-get (elt (jsonrpc-request (eglot-current-server) :textDocument/definition
    (eglot--TextDocumentPositionParams)) 0) :range) :start) :line)))
(set-buffer-modified-p nil)
"""


@pytest.fixture
def launch_file(tmp_path: Path) -> Path:
    (tmp_path / "demo/launch").mkdir(parents=True)
    (tmp_path / "demo/package.xml").write_text("<package><name>demo</name></package>")
    path = tmp_path / "demo/launch/wrong.launch"
    path.write_text(WRONG)
    (tmp_path / "demo/params").mkdir()
    (tmp_path / "demo/params/speed.yaml").write_text("speed: [1.0\n")
    command = tmp_path / "bin/ur"
    command.parent.mkdir()
    command.write_text(f'#!/bin/sh\nexec "{sys.executable}" -I -m ur "$@"\n')
    command.chmod(0o755)
    return path


def run(command: list[str], launch_file: Path) -> str:
    tmp_path = launch_file.parents[2]
    environment = {**os.environ, "PATH": f"{tmp_path}/bin:{os.environ['PATH']}", "HOME": str(tmp_path)}
    environment.update(XDG_STATE_HOME=str(tmp_path), XDG_CACHE_HOME=str(tmp_path), ROS_PACKAGE_PATH="")
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=110, check=False)
    return done.stdout + done.stderr


def write(script: str, launch_file: Path, name: str, setup: str) -> str:
    path = launch_file.parents[2] / name
    path.write_text(script.replace("SETUP", f'"{ROOT / "editors" / setup}"').replace("FILE", f'"{launch_file}"'))
    return str(path)


def test_neovim_shows_findings_while_a_file_is_edited(launch_file: Path) -> None:
    if shutil.which("nvim") is None:
        pytest.skip("Neovim is not installed: sudo apt-get install neovim")
    script = write(NEOVIM, launch_file, "session.lua", "neovim.lua")
    printed = run(["nvim", "--headless", "-u", "NONE", "-c", f"luafile {script}", "-c", "qa!"], launch_file)
    lines = [line for line in printed.splitlines() if line.startswith(("findings", "definition"))]
    expected = ["findings [undeclared-argument:2]", "findings []", "definition line 1", "findings [bad-yaml:1]"]
    assert lines == expected, printed


def test_set_up_of_helix_starts_the_server_for_each_kind_of_file() -> None:
    described = pytest.importorskip("tomllib").loads((ROOT / "editors/helix.toml").read_text())
    assert described["language-server"]["ur"] == {"command": "ur", "args": ["lsp"]}
    assert {each["name"] for each in described["language"] if "ur" in each["language-servers"]} == {
        "xml",
        "yaml",
        "bash",
    }


def build_extension() -> Path:
    """The folder of the built extension: made by npm in the versions of its package.json, and kept in `.cache`."""
    source = ROOT / "editors/vscode"
    described = json.loads((source / "package.json").read_text())
    names = ("vscode-languageclient", "typescript", "@types/node", "@types/vscode")
    versions = {**described["dependencies"], **described["devDependencies"]}
    wanted = [f"{name}@{versions[name]}" for name in names]
    name = "-".join(["vscode", *(each.rpartition("@")[2] for each in wanted)])
    with installed(name, wanted) as folder:
        for name in ("src", "test"):
            shutil.copytree(source / name, folder / name, dirs_exist_ok=True)
        for name in ("tsconfig.json", "package.json"):
            shutil.copy(source / name, folder)
        tsc = [str(folder / "node_modules/.bin/tsc"), "-p", str(folder)]
        done = subprocess.run(tsc, capture_output=True, text=True, timeout=100, check=False)
        assert done.returncode == 0, done.stdout
    return folder


def test_vs_code_shows_findings_while_a_file_is_edited(launch_file: Path) -> None:
    # The extension and vscode-languageclient themselves; what they use of VS Code is in test/vscode.js.
    folder = build_extension()
    printed = run(["node", f"{folder}/test/session.js", str(folder), str(launch_file)], launch_file)
    lines = [line for line in printed.splitlines() if line.startswith(("findings", "definition", "commands"))]
    expected = ["findings [undeclared-argument:2]", "findings []", "definition line 1", "commands ur.graph ur.launch"]
    assert lines == expected, printed


def test_emacs_shows_findings_while_a_file_is_edited(launch_file: Path) -> None:
    if shutil.which("emacs") is None:
        pytest.skip("Emacs is not installed: sudo apt-get install emacs-nox elpa-eglot")
    has_eglot = ["emacs", "--batch", "--eval", "(progn (package-initialize) (require 'eglot))"]
    if subprocess.run(has_eglot, capture_output=True, timeout=60, check=False).returncode:
        pytest.skip("Emacs has no eglot: sudo apt-get install elpa-eglot")
    script = write(EMACS, launch_file, "session.el", "emacs.el")
    printed = run(["emacs", "--batch", "--eval", "(package-initialize)", "-l", script], launch_file)
    lines = [line for line in printed.splitlines() if line.startswith(("findings", "definition"))]
    assert lines == ["findings 1", "findings 0", "definition line 1"], printed
