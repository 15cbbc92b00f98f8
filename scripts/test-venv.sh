#!/bin/sh
# test-venv.sh VENV "MODULES" "PACKAGES" [OPTION]: a virtual environment for a test, with packages from PyPI, made where Python does not find the modules
# there. OPTION: of venv, such as --system-site-packages, which sees Debian's. Exit code 77, skipped, where the packages cannot be had.
set -eu
venv="$1"
for module in $2; do
  "$venv/bin/python" -c "import $module" 2>/dev/null && continue
  # shellcheck disable=SC2086 # packages are several words
  "${PYTHON:-/usr/bin/python3}" -m venv ${4:-} "$venv" && "$venv/bin/pip" install --quiet --retries 0 --timeout 30 $3 && exit 0
  echo "test-venv.sh: skipped: $3 cannot be installed from PyPI into $venv" >&2
  exit 77
done
