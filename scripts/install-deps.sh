#!/bin/sh
# install-deps.sh: the one list of packages, of Debian 12 and 13 alike, that snug is built, tested and compared with.
#
#   scripts/install-deps.sh              what building, testing and running need: the groups program and test
#   scripts/install-deps.sh program      what the program needs to be built and to pack; test, python, cluster, lint, fuzz,
#                                        peers, package, docs: that, and the groups named
#   scripts/install-deps.sh --list ...   only print the packages
#
# Installs only what is missing, as root or through sudo; with nothing missing it takes a tenth of a second.
set -eu

program="make cmake ninja-build g++ pkg-config ccache python3
  libeigen3-dev libexpected-dev libfmt-dev libyaml-cpp-dev nlohmann-json3-dev libhdf5-dev libcli11-dev
  zlib1g-dev libzstd-dev libcpp-httplib-dev libssl-dev libgtest-dev
  libtinyxml2-dev libassimp-dev libceres-dev libnlopt-cxx-dev libpng-dev libzmq3-dev libprotobuf-dev protobuf-compiler"
node="nodejs npm"                   # unless there is a node of 18 or newer already
python="pybind11-dev python3-dev python3-numpy python3-venv"  # make python
# make test; chromium also draws `snug picture`
test="$python python3-pytest mypy python3-matplotlib hdf5-tools libbenchmark-dev liborocos-kdl-dev libkdl-parser-dev liburdfdom-headers-dev chromium man-db
  python3-zmq python3-protobuf"
cluster="slurm-wlm munge"           # the test of studies as jobs of a cluster, which is skipped without
lint="clang clang-format clang-tidy" # make check, fix, tidy, clang
fuzz="clang libclang-rt-dev"      # make fuzz
peers="libbullet-dev libmujoco-dev"  # make bench-peers
package="dpkg-dev file"              # make package
docs="python3-sphinx python3-myst-parser furo" # make docs

wanted="$program"
groups=""
only_list=no
for argument in "$@"; do
  case "$argument" in
    --list) only_list=yes ;;
    program) groups="$groups program" ;;
    test) groups="$groups test"; wanted="$wanted $test" ;;
    python) groups="$groups python"; wanted="$wanted $python" ;;
    cluster) groups="$groups cluster"; wanted="$wanted $cluster" ;;
    lint) groups="$groups lint"; wanted="$wanted $lint" ;;
    fuzz) groups="$groups fuzz"; wanted="$wanted $fuzz" ;;
    peers) groups="$groups peers"; wanted="$wanted $peers" ;;
    package) groups="$groups package"; wanted="$wanted $package" ;;
    docs) groups="$groups docs"; wanted="$wanted $docs" ;;
    *)
      echo "install-deps.sh: unknown group '$argument'; expected program, test, python, cluster, lint, fuzz, peers, package, docs or --list" >&2
      exit 2 ;;
  esac
done
[ -n "$groups" ] || wanted="$wanted $test"
node_major="$(node --version 2>/dev/null | sed -n 's/^v\([0-9]*\)\..*/\1/p')"
if [ "$only_list" = yes ] || [ "${node_major:-0}" -lt 18 ] || ! command -v npm >/dev/null 2>&1; then
  wanted="$wanted $node"
fi
if [ "$only_list" = yes ]; then
  for package in $wanted; do echo "$package"; done
  exit 0
fi

if ! command -v dpkg-query >/dev/null 2>&1; then
  echo "install-deps.sh: this is not Debian; install what corresponds to:" $wanted >&2
  exit 0
fi

# One dpkg-query for all: a package that was removed but left its settings behind does not count as installed.
installed=" $(dpkg-query -W -f='${db:Status-Status} ${Package}\n' $wanted 2>/dev/null | sed -n 's/^installed //p' | tr '\n' ' ') "
missing=""
for package in $wanted; do
  case "$installed" in *" $package "*) ;; *) missing="$missing $package" ;; esac
done
[ -n "$missing" ] || exit 0

as_root=""
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v sudo >/dev/null 2>&1; then
    echo "install-deps.sh: run as root or install sudo; missing:$missing" >&2
    exit 1
  fi
  as_root="sudo"
fi
echo "installing:$missing" >&2
$as_root apt-get update -qq >&2 || echo "install-deps.sh: apt-get update failed; trying with the lists at hand" >&2
$as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing >&2
