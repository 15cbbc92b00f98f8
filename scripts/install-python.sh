#!/bin/sh
# install-python.sh BUILD [VENV]: puts the Python module where Python looks: into the virtual environment VENV (made when there is
# none, seeing the system's packages), else that of VIRTUAL_ENV, else for every user of /usr/bin/python3, as root, or for oneself.
set -eu
build="$1"
venv="${2:-${VIRTUAL_ENV:-}}"
python="${PYTHON:-/usr/bin/python3}"
if [ -n "$venv" ]; then
  venv="$(realpath -m -- "$venv")"
  [ -x "$venv/bin/python" ] || "$python" -m venv --system-site-packages "$venv"
  python="$venv/bin/python"
  folder="$("$python" -c 'import sysconfig; print(sysconfig.get_paths()["platlib"])')"
elif [ "$(id -u)" -eq 0 ]; then
  folder="$("$python" -c 'import site; print([f for f in site.getsitepackages() if f.startswith("/usr/local")][0])')"
else
  folder="$("$python" -m site --user-site)"
fi
rm -rf "$folder/snug"
mkdir -p "$folder/snug"
cp -R "$build"/python/snug/. "$folder/snug/"
cd / # not the sources
version="$("$python" -c 'import snug; print(snug.__version__)')"
echo "snug $version: import it with $python (in $folder)" >&2
