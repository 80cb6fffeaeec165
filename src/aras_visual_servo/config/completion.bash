# Tab completion of this package's commands behind rosrun: scenarios, options, keys of --set. Source it in bash:
#   . install/share/aras_visual_servo/config/completion.bash
# Each command completes itself (python3-argcomplete); all other words go to rosbash's own completion.
_aras_rosrun() {
  local package=aras_visual_servo_controller line=${COMP_LINE:0:COMP_POINT} program
  if ((COMP_CWORD < 3)) || [[ ${COMP_WORDS[1]} != "$package" ]]; then
    declare -F _roscomplete_exe >/dev/null && _roscomplete_exe
    return
  fi
  # The folder of the programs beside the share folder that this file is in.
  program=$(dirname "${BASH_SOURCE[0]}")/../../../lib/$package/${COMP_WORDS[2]}
  line=${line#*"$package"}
  line=${line#"${line%%[! ]*}"}
  local IFS=$'\013'
  # shellcheck disable=SC2207
  COMPREPLY=($(IFS="$IFS" COMP_LINE="$line" COMP_POINT="${#line}" COMP_TYPE="$COMP_TYPE" _ARGCOMPLETE=1 \
    _ARGCOMPLETE_COMP_WORDBREAKS="$COMP_WORDBREAKS" _ARGCOMPLETE_SUPPRESS_SPACE=1 \
    "$program" 8>&1 9>/dev/null 1>/dev/null 2>&1))
  [[ ${COMPREPLY-} =~ [=/.]$ ]] && compopt -o nospace
  return 0
}
complete -F _aras_rosrun rosrun
