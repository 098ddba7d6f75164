#!/bin/sh
# setup.sh PYTHON [FILE...]: installs what is missing and skips what is there; FILE: more Debian packages.
#   PYTHON = .venv/bin/python: made here, with the wheels of requirements.txt
#   any other PYTHON: taken as it is; it must have torch and mujoco
set -eu
cd "$(dirname "$0")"
python=$1
shift

if command -v dpkg-query >/dev/null; then
  missing=
  for package in $(sed 's/#.*//' packages.txt "$@"); do
    case $(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true) in
      installed) ;;
      *) missing="$missing $package" ;;
    esac
  done
  if [ -n "$missing" ]; then
    echo "installing Debian packages:$missing"
    sudo=
    if [ "$(id -u)" -ne 0 ]; then
      command -v sudo >/dev/null || { echo "error: not root and no sudo; install:$missing" >&2; exit 1; }
      sudo=sudo
    fi
    $sudo apt-get update -q
    # shellcheck disable=SC2086  # one word a package
    $sudo env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends $missing
  fi
else
  echo "note: no dpkg here; the packages of packages.txt must be installed by hand"
fi

if [ "$python" != .venv/bin/python ]; then
  "$python" -c 'import importlib.util as u, sys
missing = [m for m in ("torch", "mujoco") if u.find_spec(m) is None]
sys.exit("error: %s lacks %s; versions that serve are in requirements.txt: %s -m pip install -r requirements.txt"
         % (sys.executable, " and ".join(missing), sys.executable) if missing else 0)'
elif ! cmp -s requirements.txt .venv/requirements.installed; then
  echo "installing the wheels of requirements.txt into .venv"
  [ -x .venv/bin/python ] || python3 -m venv .venv
  .venv/bin/python -m pip install --quiet --disable-pip-version-check -r requirements.txt
  cp requirements.txt .venv/requirements.installed
fi
