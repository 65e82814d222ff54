#!/bin/bash
# Run shellcheck on every shell script of the repository, those without an ending included: check_shell.bash [FILE ...]
set -u
cd "$(dirname "$(readlink -f "$0")")/.." || exit 2

# list_scripts: the files that git knows or would take, which end in .sh or .bash or begin with #! and a shell.
list_scripts() {
  local path first
  while IFS= read -r -d "" path; do
    [[ -f $path && ! -L $path ]] || continue
    case $path in
      *.sh | *.bash) printf '%s\n' "$path" ;;
      */corpus/*) ;;
      *)
        LC_ALL=C IFS= read -r -n 64 first <"$path" 2>/dev/null
        [[ $first =~ ^'#!'.*[/\ ](ba|da|k)?sh([[:space:]]|$) ]] && printf '%s\n' "$path"
        ;;
    esac
  done < <(git ls-files -z --cached --others --exclude-standard)
}

if ! command -v shellcheck >/dev/null; then
  echo "error: shellcheck is not installed, expected it to check the shell scripts" >&2
  echo "help: bash tools/set_up.bash test" >&2
  exit 2
fi
if [[ $# -gt 0 ]]; then scripts=("$@"); else mapfile -t scripts < <(list_scripts); fi
if [[ ${#scripts[@]} -eq 0 ]]; then
  echo "error: no shell scripts found, expected a clone with git" >&2
  exit 2
fi
shellcheck --severity=style --external-sources "${scripts[@]}"
