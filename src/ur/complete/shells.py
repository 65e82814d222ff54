"""The lines that bash, zsh and fish need. All the knowledge is in `ur` itself, which they ask."""

from __future__ import annotations

BASH = """\
# Tab completion for ur: eval "$(ur completion bash)"
_ur_complete() {
  local whole="${COMP_LINE:0:COMP_POINT}" answer text help open kept
  local current="${COMP_WORDS[COMP_CWORD]:0:$((COMP_POINT))}"
  COMPREPLY=()
  # bash takes a:=b for three words; what it will not replace is cut off again.
  kept="${whole##*[[:space:]]}"
  case "$COMP_WORDBREAKS" in *:*|*=*) kept="${kept%"${kept##*[:=]}"}" ;; *) kept="" ;; esac
  while IFS=$'\\t' read -r open text help; do
    [[ -n $text ]] || continue
    COMPREPLY+=("${text#"$kept"}")
    answer="$open"
  done < <("${COMP_WORDS[0]}" __complete bash "$whole" 2>/dev/null)
  if [[ ${#COMPREPLY[@]} -eq 1 && $answer == open ]]; then compopt -o nospace; fi
  if [[ ${#COMPREPLY[@]} -gt 1 ]]; then compopt -o nospace -o nosort 2>/dev/null; fi
}
complete -F _ur_complete ur ./ur
"""

ZSH = """\
#compdef ur
# Tab completion for ur: eval "$(ur completion zsh)"
_ur() {
  local -a done open
  local kind text help
  while IFS=$'\\t' read -r kind text help; do
    [[ -n $text ]] || continue
    if [[ $kind == open ]]; then open+=("${text//:/\\\\:}:$help"); else done+=("${text//:/\\\\:}:$help"); fi
  done < <("${words[1]}" __complete zsh "${(pj: :)words[1,CURRENT]}" 2>/dev/null)
  (( $#open )) && _describe -V 'ur' open -S ''
  (( $#done )) && _describe -V 'ur' done
  (( $#open + $#done ))
}
(( $+functions[compdef] )) || { autoload -Uz compinit && compinit; }
compdef _ur ur
"""

FISH = """\
# Tab completion for ur: ur completion fish | source
function __ur_complete
  set -l line (commandline -cp)
  ur __complete fish "$line" 2>/dev/null | while read -l -d \\t open text help
    printf '%s\\t%s\\n' $text $help
  end
end
complete -c ur -f -a '(__ur_complete)'
"""

SCRIPTS = {"bash": BASH, "zsh": ZSH, "fish": FISH}
