# bash completion for brink: commands, their options, files. What there is, the program itself says.
_brink() {
  local word=${COMP_WORDS[COMP_CWORD]} command=${COMP_WORDS[1]}
  if [ "$COMP_CWORD" = 1 ]; then
    mapfile -t COMPREPLY < <(compgen -W "$(brink --help 2>/dev/null | sed -n '/^Subcommands:/,/^$/s/^  \([a-z]*\) .*/\1/p') --help --version" -- "$word")
  elif [[ $word == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$(brink "$command" --help 2>/dev/null | grep -oE -- '--[a-z][a-z0-9-]*' | sort -u)" -- "$word")
  elif [ "$command" = list ]; then
    mapfile -t COMPREPLY < <(compgen -W "$(brink list --help 2>/dev/null | sed -n 's/.*TOPIC .*{\(.*\)}.*/\1/p' | tr ',' ' ')" -- "$word")
  else
    mapfile -t COMPREPLY < <(compgen -f -- "$word")
  fi
}
complete -o filenames -F _brink brink
