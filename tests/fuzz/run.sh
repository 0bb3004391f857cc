#!/bin/sh
# Fuzzes every parser and machine for some seconds each: sh tests/fuzz/run.sh SECONDS [NAME...]
#
# NAME is that of a fuzz_NAME.c; without one all run, from the inputs in corpus/NAME/ and with
# NAME's dictionary. New inputs stay in build/fuzz/corpus; what crashes in build/fuzz/crash-NAME-*:
# it belongs into corpus/NAME and into a unit test.
set -u

cd "$(dirname "$0")/../.." || exit 1
seconds=${1:?seconds for each program}
shift
build=$PWD/build/fuzz

names_of_all()
{
    for source in tests/fuzz/fuzz_*.c; do
        basename "$source" .c | sed 's/^fuzz_//'
    done
}

# fuzz_one NAME SECONDS, in a shell of its own
fuzz_one()
{
    kept=tests/fuzz/corpus/$1
    dictionary=tests/fuzz/fuzz_$1.dict
    new=$build/corpus/$1
    mkdir -p "$new"
    set -- "$build/tests/fuzz/fuzz_$1" -max_total_time="$2" -timeout=10 -rss_limit_mb=2048 \
        -seed=1 -print_final_stats=1 -artifact_prefix="$build/crash-$1-" "$new"
    [ ! -d "$kept" ] || set -- "$@" "$kept"
    [ ! -e "$dictionary" ] || set -- "$@" "-dict=$dictionary"
    "$@"
}

if [ "${MCANOPEN_FUZZ_ONE:-}" ]; then
    fuzz_one "$MCANOPEN_FUZZ_ONE" "$seconds" >"$build/$MCANOPEN_FUZZ_ONE.log" 2>&1
    echo $? >"$build/$MCANOPEN_FUZZ_ONE.status"
    exit 0
fi

cmake --preset fuzz && cmake --build "$build" --target fuzzers -j "$(nproc)" || exit 1
[ $# -gt 0 ] || set -- $(names_of_all)
for name in "$@"; do
    echo "$name"
done | xargs -P "$(nproc)" -I '{}' env MCANOPEN_FUZZ_ONE='{}' sh "$0" "$seconds"

passed=0
failed=0
for name in "$@"; do
    if [ "$(cat "$build/$name.status")" = 0 ]; then
        passed=$((passed + 1))
        runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$build/$name.log")
        echo "fuzz $name: $runs runs"
    else
        failed=$((failed + 1))
        cat "$build/$name.log"
        echo "fuzz $name: FAILED"
    fi
done
echo "$passed passed, $failed failed"
[ $failed -eq 0 ] && [ $passed -gt 0 ]
