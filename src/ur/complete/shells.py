"""The lines that bash, zsh and fish need. The candidates come from `ur` itself."""

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
