"""Candidates for the arguments of verbs, by the kind of each.

`path`: any file; `files`: packages, their launch files, and paths; `launch`: all arguments of `ur launch`; `explain`:
the same, and a name in the file. The last kind of a list with an ellipsis is repeated.
"""

from collections.abc import Iterable, Iterator, Sequence

from ur.complete.completions import Completion, Line, NameSources, Option
from ur.complete.launch import (
    complete_arguments,
    complete_files_of_package,
    complete_launch,
    complete_packages,
    complete_paths,
    find_address,
)
from ur.launchfile.world.protocol import World
from ur.source.arguments import parse_argument, split_argv

BASH = """\
# Tab completion for ur: eval "$(ur completion bash)"
_ur_complete() {
  local whole="${COMP_LINE:0:COMP_POINT}" program="${COMP_WORDS[0]}" answer="" text help open
  # A file called ur in the current folder is not started by Tab where ur is installed.
  if type -P ur >/dev/null; then program=ur; fi
  COMPREPLY=()
  # What ur answers is quoted already: it is inserted as it is, in place of the second word that bash gives.
  while IFS=$'\\t' read -r open text help; do
    [[ -n $text ]] || continue
    COMPREPLY+=("$text")
    answer="$open"
  done < <(command "$program" __complete bash "$whole" "$2" 2>/dev/null)
  if [[ ${#COMPREPLY[@]} -eq 1 && $answer == open ]]; then compopt -o nospace; fi
  if [[ ${#COMPREPLY[@]} -gt 1 ]]; then compopt -o nospace -o nosort 2>/dev/null; fi
}
complete -F _ur_complete ur ./ur
"""

ZSH = """\
#compdef ur
# Tab completion for ur: eval "$(ur completion zsh)"
_ur() {
  local -a done open done_shown open_shown
  local kind text help program=$words[1]
  if (( $+commands[ur] )); then program=ur; fi
  while IFS=$'\\t' read -r kind text help; do
    [[ -n $text ]] || continue
    if [[ $kind == open ]]; then open+=("$text") open_shown+=("$text${help:+  -- $help}")
    else done+=("$text") done_shown+=("$text${help:+  -- $help}"); fi
  done < <(command $program __complete zsh "${(pj: :)words[1,CURRENT]}" 2>/dev/null)
  # compadd quotes what it inserts.
  (( $#open )) && compadd -V open -l -d open_shown -S '' -a open
  (( $#done )) && compadd -V done -l -d done_shown -a done
  (( $#open + $#done ))
}
(( $+functions[compdef] )) || { autoload -Uz compinit && compinit; }
compdef _ur ur
"""

FISH = """\
# Tab completion for ur: ur completion fish | source
function __ur_complete
  set -l line (commandline -cp)
  command ur __complete fish "$line" 2>/dev/null | while read -l -d \\t open text help
    printf '%s\\t%s\\n' $text $help
  end
end
complete -c ur -f -a '(__ur_complete)'
"""

SCRIPTS = {"bash": BASH, "zsh": ZSH, "fish": FISH}


# The kind of an option's value; without a verb: of every verb.
_OPTIONS = {
    ("", "--robot"): "robot",
    ("maps", "--to"): "robot",
    ("maps", "--from"): "robot",
    ("check", "--select"): "rule",
    ("check", "--ignore"): "rule",
    ("check", "--explain"): "rule",
}


def complete_line(line: Line, world: World, known: NameSources) -> list[Completion]:
    """Return the candidates at the cursor, best first, without duplicates."""
    found: dict[str, Completion] = {}
    for each in _complete(line, world, known):
        if each.text.startswith(line.prefix):
            found.setdefault(each.text, each)
    return list(found.values())


def _complete(line: Line, world: World, known: NameSources) -> Iterator[Completion]:
    if not line.words:
        if line.prefix.startswith("-"):
            yield from (Completion("--help", "Show what there is."), Completion("--version", "Print the version."))
        else:
            yield from _named("verb", known)
        return
    verb, *words = line.words
    options = known.options(verb) if any(word.startswith("-") for word in (*words, line.prefix)) else ()
    if words and (option := _awaiting(words[-1], options)):
        yield from (Completion(choice) for choice in option.choices)
        if kind := _OPTIONS.get((verb, option.names[0])) or _OPTIONS.get(("", option.names[0])):
            yield from _last_of_list(_named(kind, known), line.prefix)
        elif not option.choices:
            yield from complete_paths(line.prefix, world, every=True)
        return
    if line.prefix.startswith("-"):
        yield from _options(line.prefix, options)
        return
    plain = _without_options(words, options)
    yield from _positional(verb, plain, line.prefix, world, known)


def _positional(verb: str, words: Sequence[str], prefix: str, world: World, known: NameSources) -> Iterator[Completion]:
    kind = _kind(known.kinds(verb), words)
    if kind == "launch":
        yield from complete_launch(words, prefix, world, known)
    elif kind == "explain":
        yield from _explain(words, prefix, world, known)
    elif kind == "files":
        if words:
            yield from complete_files_of_package(words[-1], prefix, world)
        yield from complete_paths(prefix, world, every=True)
        yield from complete_packages(prefix, world)
    elif kind == "program arguments":
        path = known.launch_file(words[0])
        if path is not None:
            yield from complete_arguments(path, words[1:], prefix, world, known)
    else:
        yield from _named(kind, known)


def _explain(words: Sequence[str], prefix: str, world: World, known: NameSources) -> Iterator[Completion]:
    plain = split_argv(words)[0]
    path, used = find_address(plain, world)
    if path is not None and len(plain) == used and parse_argument(prefix) is None:
        yield from known.names(path, words)
    yield from complete_launch(words, prefix, world, known)


def _last_of_list(found: Iterable[Completion], prefix: str) -> Iterator[Completion]:
    # RULE,RULE: the last one is completed.
    before, comma, _ = prefix.rpartition(",")
    yield from (each._replace(text=f"{before}{comma}{each.text}") for each in found)


def _kind(kinds: Sequence[str], words: Sequence[str]) -> str:
    if not kinds:
        return ""
    if kinds[0] in ("launch", "explain") or (len(words) and kinds[-1] == "program arguments"):
        return kinds[-1]
    if kinds[-1] == "...":
        return kinds[min(len(words), len(kinds) - 2)]
    return kinds[len(words)] if len(words) < len(kinds) else ""


def _named(kind: str, known: NameSources) -> Iterable[Completion]:
    source = known.sources.get(kind)
    return source() if source else ()


def _options(prefix: str, options: Sequence[Option]) -> Iterator[Completion]:
    for option in options:
        fitting = [name for name in option.names if name.startswith(prefix)]
        longest = max(fitting, key=len, default="")
        if longest and (prefix != "-" or longest.startswith("--")):
            yield Completion(longest, option.help)


def _awaiting(word: str, options: Sequence[Option]) -> Option | None:
    return next((each for each in options if each.takes_value and word in each.names), None)


def _without_options(words: Sequence[str], options: Sequence[Option]) -> list[str]:
    plain: list[str] = []
    skip = False
    for word in words:
        if skip:
            skip = False
        elif word.startswith("-") and word != "-":
            skip = _awaiting(word, options) is not None
        else:
            plain.append(word)
    return plain
