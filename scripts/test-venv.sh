#!/bin/sh
# test-venv.sh VENV "MODULES" "PACKAGES" [OPTION]: a virtual environment for a test, with packages from PyPI, made where Python does not find the modules
# there. `numpy` as the last package: of the major version that the module was built with, that of PYTHON or Debian. OPTION: of venv, such as
# --system-site-packages, which sees Debian's. Exit code 77, skipped, where the packages cannot be had.
set -eu
venv="$1"
python="${PYTHON:-/usr/bin/python3}"
case "$3" in
*numpy) packages="$3<$("$python" -c 'import numpy; print(int(numpy.__version__.split(".")[0]) + 1)')" ;;
*) packages="$3" ;;
esac
for module in $2; do
  "$venv/bin/python" -c "import $module" 2>/dev/null && continue
  # shellcheck disable=SC2086 # packages are several words
  "$python" -m venv ${4:-} "$venv" && "$venv/bin/pip" install --quiet --retries 0 --timeout 30 $packages && exit 0
  echo "test-venv.sh: skipped: $packages cannot be installed from PyPI into $venv" >&2
  exit 77
done
