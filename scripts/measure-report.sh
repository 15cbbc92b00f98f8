#!/bin/sh
# measure-report.sh RUN.h5 [SECOND]: what the report of a recording costs, beside the targets for a real sequence of 250 s.
#
# Writing it and its size here; opening and replaying it (from SECOND on) by the script of viewer/. Figures, not a test: they depend on what else the machine does.
# SNUG names the program, if not build/snug.
set -eu
[ $# -ge 1 ] || { echo "usage: scripts/measure-report.sh RUN.h5 [SECOND]" >&2; exit 2; }
root="$(cd "$(dirname "$0")/.." && pwd)"
snug="${SNUG:-$root/build/snug}"
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
report="$folder/report.html"
begin="$(date +%s%N)"
"$snug" report "$1" -o "$report" 2>/dev/null || { "$snug" report "$1" -o "$report"; exit $?; }
end="$(date +%s%N)"
shift
awk -v ns="$((end - begin))" -v bytes="$(wc -c <"$report")" 'BEGIN {
  printf "%-34s%8.2f s   <= 3 s\n%-34s%7.2f MB   <= 5 MB\n", "report written in", ns / 1e9, "size of the report", bytes / 1e6
}'
cd "$root/viewer"
npm run --silent measure -- "$report" "$@"
