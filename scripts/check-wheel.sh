#!/bin/sh
# check-wheel.sh WHEEL [ROOT]: installs the wheel into a fresh virtual environment, packs a sequence from Python and from the command line, writes
# the pages, and says how large and how quick. ROOT: does so within another system, a folder that has python3 and python3-venv and nothing else:
#
#   debootstrap --variant=minbase --include=python3,python3-venv bookworm ROOT     (root; once)
set -eu
[ $# -ge 1 ] && [ -f "$1" ] || { echo "check-wheel.sh: expected a wheel" >&2; exit 2; }
wheel="$(realpath "$1")"
root="${2:+$(realpath "$2")}"
python="${PYTHON:-/usr/bin/python3}"
work="$(mktemp -d "${root:-}/tmp/snug-wheel-XXXXXX")"
trap 'rm -rf "$work"' EXIT
cp "$wheel" "$work"
cat >"$work/try.sh" <<'STEPS'
set -eu
cd "$1"
began=$(date +%s.%N)
"$2" -m venv fresh
PIP_DISABLE_PIP_VERSION_CHECK=1 fresh/bin/pip install --quiet $3 snug-*.whl
PATH="$PWD/fresh/bin:$PATH"
mkdir away && cd away
snug pack box-demonstrator --sequence 1 --agent margin --robot none --samples 0 -o run.h5 >summary.txt
snug report run.h5 -o run.html
python - <<'PYTHON'
import snug
result = snug.pack(snug.load_scenario("box-demonstrator"), "1", agent="margin", samples=0, robot="none", record="again.h5")
snug.report("again.h5", "again.html")
assert result.executed_boxes >= 5, result
assert len(snug.scenario_names()) > 10
PYTHON
[ "$(wc -c <run.html)" -gt 100000 ] && [ "$(wc -c <again.html)" -gt 100000 ]
python - "$began" <<'PYTHON'
import subprocess, sys, time
print(f"environment, two packed sequences and their pages: {time.time() - float(sys.argv[1]):.1f} s")
def cost(words):
    began = time.perf_counter()
    subprocess.run([sys.executable, "-c", words], check=True)
    return time.perf_counter() - began
for words in ("import numpy", "import snug"):
    print(f"{words}: {sorted(cost(words) - cost('') for _ in range(7))[3]:.3f} s")
PYTHON
STEPS
if [ -n "$root" ]; then
  # No registry from within: numpy comes along.
  "$python" -m pip download --quiet --no-deps --dest "$work" numpy 2>/dev/null || { echo "check-wheel.sh: numpy cannot be downloaded" >&2; exit 1; }
  unshare --mount sh -c 'mount -t proc proc "$0/proc" && exec chroot "$0" sh "$1/try.sh" "$1" python3 "--no-index --find-links=."' \
    "$root" "${work#"$root"}"
else
  sh "$work/try.sh" "$work" "$python" ""
fi
echo "$(basename "$wheel"): $(du --apparent-size --block-size=100kB "$wheel" | awk '{print $1 / 10}') MB"
