#!/bin/sh
# test.sh [MODULE]: builds the release preset and runs every test, or one module's; results also in build/test-results.xml.
set -eu
cd "$(dirname "$0")/.."
module="${1:-}"
jobs="$(nproc)"
rm -f build/test-results.xml
cmake --preset release --log-level=WARNING
if [ -n "$module" ]; then
  if [ ! -d "src/snug/$module" ]; then
    echo "test.sh: no module '$module'; expected one of: $(ls src/snug | tr '\n' ' ')" >&2
    exit 2
  fi
  cmake --build --preset release -j "$jobs" --target "${module}_tests"
  ctest --preset release -j "$jobs" -L "^$module\$"
else
  cmake --build --preset release -j "$jobs" --target all snug_tests snug_python
  ctest --preset release -j "$((jobs + 1))" --output-junit test-results.xml # one more than cores: some wait for servers and schedulers
fi
