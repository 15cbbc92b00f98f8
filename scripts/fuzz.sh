#!/bin/sh
# fuzz.sh: runs the libFuzzer programs of a build folder over their seeds.
#
#   scripts/fuzz.sh BUILD SECONDS [READER]   SECONDS in all, shared by the readers, as many at a time as there are cores
#
# New inputs that reach new code are kept in BUILD/corpus/READER, findings in BUILD/findings/READER. To look at one, run
# BUILD/tests/fuzz/fuzz_READER FINDING. What is mended becomes a seed in tests/fuzz/seeds/READER. Exit 1: something was found.
set -eu
build="$1"
seconds="$2"
readers="${3:-}"
seeds="$(dirname "$0")/../tests/fuzz/seeds"
# A library that asks for more than any file can need is told that there is none, as by a system that promises no more than it
# has: the sanitizer's own book of such a block would be the finding. What was freed is not kept for long.
export ASAN_OPTIONS="max_allocation_size_mb=400:allocator_may_return_null=1:quarantine_size_mb=16"
export LSAN_OPTIONS="suppressions=$(dirname "$0")/../tests/sanitizer-leaks.txt:print_suppressions=0"
[ -n "$readers" ] || readers="$(ls "$seeds")"
case "$seconds" in *[!0-9]* | "") echo "fuzz.sh: got TIME='$seconds'; expected whole seconds" >&2; exit 2 ;; esac
for reader in $readers; do
  [ -d "$seeds/$reader" ] || { echo "fuzz.sh: got READER='$reader'; expected one of $(ls "$seeds" | tr '\n' ' ')" >&2; exit 2; }
done

jobs="$(nproc)"
count="$(echo $readers | wc -w)"
each=$((seconds * (jobs < count ? jobs : count) / count))
[ "$each" -ge 1 ] || each=1
rm -rf "$build/findings"
run_one() {
  mkdir -p "$build/corpus/$1" "$build/findings/$1"
  # More than 20 times its size and 100 MB is a finding; the sanitizer itself takes some 150 MB and doubles the rest.
  if "$build/tests/fuzz/fuzz_$1" -max_total_time="$each" -timeout=20 -rss_limit_mb=800 -malloc_limit_mb=100 -max_len=16384 \
      -print_final_stats=1 -artifact_prefix="$build/findings/$1/" "$build/corpus/$1" "$seeds/$1" >"$build/findings/$1.log" 2>&1; then
    echo "$1: nothing found in $(sed -n 's/^stat::number_of_executed_units: *//p' "$build/findings/$1.log") runs"
  else
    echo "$1: FOUND something, see $build/findings/$1.log" && touch "$build/findings/found"
  fi
}
echo "each of $count readers for $each s"
running=0
for reader in $readers; do
  run_one "$reader" &
  running=$((running + 1))
  if [ "$running" -ge "$jobs" ]; then wait; running=0; fi
done
wait
[ ! -e "$build/findings/found" ]
