#!/bin/sh
# test.sh [ROOM]: builds the release preset and runs every test, or one room's; results also in build/test-results.xml.
set -eu
cd "$(dirname "$0")/.."
room="${1:-}"
jobs="$(nproc)"
rm -f build/test-results.xml
cmake --preset release --log-level=WARNING
if [ -n "$room" ]; then
  if [ ! -d "src/snug/$room" ]; then
    echo "test.sh: no room '$room'; expected one of: $(ls src/snug | tr '\n' ' ')" >&2
    exit 2
  fi
  cmake --build --preset release -j "$jobs" --target "${room}_tests"
  ctest --preset release -j "$jobs" -L "^$room\$"
else
  cmake --build --preset release -j "$jobs"
  ctest --preset release -j "$jobs" --output-junit test-results.xml
fi
