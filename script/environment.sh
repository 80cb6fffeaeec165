# Sourced by the other scripts: the shell environment of the workspace. Never rely on what the caller's shell holds.
workspace=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# ROS belongs to Debian's own Python: another interpreter that comes first in PATH must not take its place.
export PATH=/usr/bin:/usr/sbin:/bin:/sbin:$PATH
# Python keeps what it has compiled, also in an image of a container that forbids it: most programs here run for less time
# than compiling all they import would take.
unset PYTHONHOME PYTHONDONTWRITEBYTECODE
export PYTHONNOUSERSITE=1
# Everything listens and talks on the loopback.
export ROS_HOSTNAME=localhost
export ROS_MASTER_URI=${ROS_MASTER_URI:-http://localhost:11311}
export ROS_LOG_DIR=${ROS_LOG_DIR:-$workspace/log/ros}
mkdir -p "$ROS_LOG_DIR"

# Debian's setup.sh files read variables that may not be set.
source_workspace() {
  local options=$-
  set +u
  # shellcheck disable=SC1091
  . "$workspace/install/setup.sh"
  [[ $options == *u* ]] && set -u
  return 0
}

# A TCP port of the loopback nobody listens on: so that a run never talks to a roscore that is not its own.
free_port() {
  /usr/bin/python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])'
}

# Releases of Debian that script/packages.txt knows.
releases=(12 13)

# packages_of DISTRIBUTION RELEASE SECTION ...: prints the packages that these sections of script/packages.txt name for a
# release, given by ID and VERSION_ID of os-release. Fails, and names what is allowed, for any other.
packages_of() {
  local distribution=$1 release=$2
  shift 2
  if [[ $distribution != debian || " ${releases[*]} " != *" $release "* ]]; then
    echo "found '$distribution ${release:-without a number}', allowed: Debian ${releases[*]} (ID and VERSION_ID in os-release)" >&2
    return 1
  fi
  awk -v sections=" $* " -v release="$release" 'BEGIN { section = "all" } { sub(/#.*/, "") }
    /^\[.*\]/ { section = substr($1, 2, length($1) - 2); next }
    NF && index(sections, " " section " ") && (NF == 1 || $2 == release) { print $1 }' "$workspace/script/packages.txt"
}
