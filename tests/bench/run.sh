#!/bin/sh
# How fast and how big:
#   sh tests/bench/run.sh [--json] [--smoke] [--bus INTERFACE] [--build DIR] [ROW...]
#
# Prints a table, or with --json JSON, of ratios and counts against their targets; --help lists the
# rows. Rates and times are compared with those of bare CAN_RAW programs in ../shared/neutral
# (MCANOPEN_NEUTRAL names another folder) in the same run on a vcan, medians of five; where these
# programs are not there, it says so and measures the rest. docs/performance.md explains the rows.
#
# Builds the preset "release" for it; --build DIR takes the programs of that build as they are.
# --smoke: a few frames of each kind, no judgement. The exit code is 1 when something went wrong,
# 2 when a target was missed or something was not measured; the last line tells which rows.
set -eu

source=$(cd "$(dirname "$0")/../.." && pwd)
build=$source/build/release

has_build()
{
    for argument in "$@"; do
        case $argument in --build | --build=* | --help | -h) return 0 ;; esac
    done
    return 1
}

build_programs()
{
    cmake -S "$source" --preset release \
        ${MCANOPEN_NEUTRAL:+"-DMCANOPEN_NEUTRAL=$MCANOPEN_NEUTRAL"} &&
        cmake --build "$build" --target bench dcftest_tool mcanopen_tool
}

if ! has_build "$@"; then
    mkdir -p "$build"
    build_programs >"$build/bench.log" 2>&1 </dev/null || {
        cat "$build/bench.log"
        exit 1
    }
fi
exec python3 -B "$source/tests/bench/bench.py" --build "$build" "$@"
