#!/bin/sh
# Builds and tests everything: sh tests/run.sh [--all] [LANE...]
#
#   (nothing)   debug build, unit and scenario tests, rules of the house, vcan
#   --all       and peers of other make, tests without the function they test or with faults in it,
#               branch coverage, 2,000 plants from seeds (MCANOPEN_SEEDS), formatting, lint,
#               sanitizers, 32 bit, valgrind, fuzzing, release build and what it needs for a large
#               EDS
#   LANE        only these lanes, by name (and "debug", which others need)
#
# Missing packages are installed with apt-get; MCANOPEN_INSTALL=no leaves the system alone.
# CI=true makes warnings errors. Logs of all lanes: build/logs. The last line is the sum of all
# tests, "N passed, N failed"; the exit code is 0 only when none failed. A lane whose tests pass and
# leave files in TMPDIR has failed.
set -u

cd "$(dirname "$0")/.." || exit 1
build=$PWD/build
logs=$build/logs
sums=$logs/sums
jobs=$(nproc)
fuzz_seconds=${MCANOPEN_FUZZ_SECONDS:-10}

packages="gcc libc6-dev binutils cmake ninja-build pkg-config libxml2-dev libjansson-dev check
    python3 python3-venv can-utils iproute2 user-mode-linux kmod"
packages_all="g++ clang clang-format clang-tidy libclang-rt-14-dev valgrind gcc-multilib
    mandoc"
# For pip; where certificates are already there, they may not be Debian's.
[ -e /etc/ssl/certs/ca-certificates.crt ] || packages="$packages ca-certificates"

export ASAN_OPTIONS=${ASAN_OPTIONS:-detect_stack_use_after_return=1:strict_string_checks=1}
export UBSAN_OPTIONS=${UBSAN_OPTIONS:-print_stacktrace=1}
export TSAN_OPTIONS=${TSAN_OPTIONS:-halt_on_error=1:second_deadlock_stack=1:atexit_sleep_ms=10}

# ---- lanes: one command each, its result on one line ---------------------------------------------

# The last line "N passed, N failed" of a log; a command that prints none is one test.
# Preparations that succeed print "0 passed, 0 failed".
counts_of()
{
    sed -n 's/^\([0-9][0-9]*\) passed, \([0-9][0-9]*\) failed$/\1 \2/p' "$1" | tail -n 1
}

# in_own_folder NAME COMMAND...: TMPDIR is a folder of the lane's own, which is to be left empty but
# for what ThreadSanitizer leaves of a program that is killed
in_own_folder()
{
    TMPDIR=$temporary/$1
    export TMPDIR
    shift
    mkdir -p "$TMPDIR"
    ("$@")
    status=$?
    [ $status -eq 0 ] || return $status
    find "$TMPDIR" -mindepth 1 -maxdepth 1 ! -name 'tsan.rodata.*' | sed 's/^/left behind: /' |
        grep . && return 1
    return 0
}

# lane NAME COMMAND...: runs it, shows the log when it fails
lane()
{
    name=$1
    shift
    wanted "$name" || return 0
    log=$logs/$name.log
    start=$(date +%s)
    (in_own_folder "$name" "$@") >"$log" 2>&1 </dev/null
    status=$?
    seconds=$(($(date +%s) - start))
    counts=$(counts_of "$log")
    if [ -z "$counts" ]; then
        counts=$([ $status -eq 0 ] && echo 1 0 || echo 0 1)
    fi
    good=${counts% *}
    bad=${counts#* }
    if [ $status -ne 0 ] && [ "$bad" -eq 0 ]; then
        bad=1
    fi
    echo "$good $bad" >>"$sums"
    [ "$bad" -eq 0 ] || sed 's/^/    /' "$log"
    verdict=$([ "$bad" -eq 0 ] && echo ok || echo FAIL)
    printf '%-5s %-9s %5d passed %3d failed %5d s\n' "$verdict" "$name" "$good" "$bad" "$seconds"
    sed -n 's/^ *NOT RUN: /      not run: /p' "$log" | sort -u
    [ "$bad" -eq 0 ]
}

wanted()
{
    [ -z "$only" ] && return 0
    case " $only " in
    *" $1 "*) return 0 ;;
    esac
    return 1
}

cannot_run()
{
    echo "this lane cannot run: $*"
    return 1
}

# Sanitizers of this age lose their shadow memory to far-reaching address randomisation.
steady()
{
    if setarch "$(uname -m)" -R true 2>/dev/null; then
        setarch "$(uname -m)" -R "$@"
    else
        "$@"
    fi
}

# ---- what the lanes do ---------------------------------------------------------------------------

as_root()
{
    if [ "$(id -u)" -eq 0 ]; then
        "$@"
    elif command -v sudo >/dev/null; then
        sudo "$@"
    else
        cannot_run "$* needs root and there is no sudo"
    fi
}

missing_packages()
{
    for package in "$@"; do
        case $(dpkg-query -W -f '${Status}' "$package" 2>/dev/null) in
        *" installed") ;;
        *) echo "$package" ;;
        esac
    done
}

install_packages()
{
    unset TMPDIR # apt-get has other users
    DEBIAN_FRONTEND=noninteractive
    export DEBIAN_FRONTEND
    as_root apt-get update -q || echo "apt-get update failed; trying with the old lists"
    as_root apt-get install -y -q --no-install-recommends "$@" && echo "0 passed, 0 failed"
}

prepare_packages()
{
    # shellcheck disable=SC2046 # a list of words
    set -- $(missing_packages "$@")
    [ $# -eq 0 ] && return 0
    if [ "${MCANOPEN_INSTALL:-yes}" = no ] || ! command -v apt-get >/dev/null; then
        echo "not installed, as far as dpkg knows: $*"
        return 0
    fi
    echo "installing: $*"
    lane packages install_packages "$@"
}

# prepare_venv VENV REQUIREMENTS: Python packages, in a place of their own
prepare_venv()
{
    python3 -m venv --clear "$1" &&
        "$1/bin/pip" install -q --disable-pip-version-check -r "$2" &&
        cp "$2" "$1/installed" && echo "0 passed, 0 failed"
}

build_preset()
{
    cmake --preset "$1" "-DMCANOPEN_WERROR=$werror" &&
        cmake --build "$build/$1" -j "$jobs" -- -k 0 && echo "0 passed, 0 failed"
}

# test_preset PRESET CTEST_OPTION...: build and ctest; the last line has the number of test cases
test_preset()
{
    preset=$1
    shift
    build_preset "$preset" || return 1
    # Many tests wait, for a device or a deadline: more of them than processors.
    steady ctest --test-dir "$build/$preset" -j $((2 * jobs)) --output-on-failure \
        --no-tests=error "$@"
    status=$?
    count_cases "$build/$preset/Testing/Temporary/LastTest.log"
    return $status
}

# Check's summaries of the log of ctest; a program without one is one test, or none where it says
# that it was not run.
count_cases()
{
    awk '
        function close_test() {
            if (open && cases == 0 && !(ok && left_out)) { ok ? good++ : bad++ }
            else if (open && !ok && errors == 0) bad++
            open = cases = errors = left_out = 0
        }
        / NOT RUN: / { left_out = 1; print }
        /^[0-9]+\/[0-9]+ Testing: / { close_test(); open = 1; ok = 0 }
        /^[0-9]+%: Checks: [0-9]+, Failures: [0-9]+, Errors: [0-9]+$/ {
            split($0, n, /[^0-9]+/)
            good += n[2] - n[3] - n[4]; bad += n[3] + n[4]
            cases += n[2]; errors += n[3] + n[4]
        }
        /^Test Passed\.$/ { ok = 1 }
        END { close_test(); printf "%d passed, %d failed\n", good, bad }
    ' "$1"
}

run_vcan()
{
    [ -e tests/vcan/run.sh ] || cannot_run "there is no tests/vcan/run.sh" || return 1
    sh tests/vcan/run.sh "$build/debug"
}

# Against python-canopen and can-utils. The largest transfers take their time beside other lanes.
run_interop()
{
    venv=$build/venv-interop
    requirements=tests/interop/requirements.txt
    cmp -s $requirements "$venv/installed" || prepare_venv "$venv" $requirements ||
        cannot_run "pip does not install $requirements" || return 1
    MCANOPEN_PYTHON=$venv/bin/python MCANOPEN_VCAN_SECONDS=${MCANOPEN_VCAN_SECONDS:-120} \
        sh tests/vcan/run.sh "$build/debug" tests/interop/test_*.py
}

run_fuzz()
{
    [ -e tests/fuzz/run.sh ] || cannot_run "there is no tests/fuzz/run.sh" || return 1
    steady sh tests/fuzz/run.sh "$fuzz_seconds"
}

run_m32()
{
    sh tests/m32_libs.sh "$build/m32-libs" || cannot_run "no 32-bit libraries" || return 1
    test_preset m32 -LE 'house|system'
}

own_sources()
{
    find include src tools tests examples -name '*.[ch]' -not -path '*/data/*' | sort
}

run_format()
{
    status=0
    for source in $(own_sources); do
        if ! clang-format --dry-run -Werror "$source" 2>/dev/null; then
            echo "$source: not as clang-format leaves it"
            status=1
        fi
    done
    [ $status -eq 0 ] || echo "run: cmake --build build/debug --target format"
    return $status
}

run_tidy()
{
    find src -name '*.c' | sort | xargs -n 1 -P "$jobs" \
        clang-tidy --quiet -p "$build/debug" --warnings-as-errors='*'
}

# Manual pages; whether they say what the tools say is a rule of the house.
run_man()
{
    for page in docs/man/*; do
        mandoc -T lint -W warning "$page" || return 1
    done
}

# Each line of tests/valgrind.list is a command in build/debug, its program a pattern of the shell.
run_valgrind()
{
    good=0
    bad=0
    while read -r pattern arguments; do
        case $pattern in '' | '#'*) continue ;; esac
        for program in "$build/debug"/$pattern; do
            # shellcheck disable=SC2086 # a list of words
            if valgrind_one "$program" $arguments; then
                good=$((good + 1))
            else
                echo "failed: $program $arguments"
                bad=$((bad + 1))
            fi
        done
    done <tests/valgrind.list
    echo "$good passed, $bad failed"
    [ "$bad" -eq 0 ]
}

# Without the pipes of its debugger: programs that are killed would leave them behind.
valgrind="valgrind -q --vgdb=no --error-exitcode=99 --leak-check=full"

valgrind_one()
{
    # shellcheck disable=SC2086 # a list of words
    CK_FORK=no CK_TIMEOUT_MULTIPLIER=10 $valgrind --errors-for-leak-kinds=definite,possible "$@"
}

# Each function of the API, each XML element is taken away once: the tests named for it must fail.
run_contract()
{
    python3 -B tests/disabling/run.py "$build/debug"
}

# Faults in the manager and the protocol machines: the tests that are named for them must fail.
run_mutants()
{
    python3 -B tests/mutants/run.py "$build/debug"
}

# The branches of the manager that scenario tests go through, without those of random seeds.
run_coverage()
{
    gcovr=$build/venv/bin/gcovr
    [ -x "$gcovr" ] || cannot_run "pip does not install tests/requirements.txt" || return 1
    cmake --preset coverage "-DMCANOPEN_WERROR=$werror" &&
        cmake --build --preset coverage -j "$jobs" || return 1
    find "$build/coverage" -name '*.gcda' -delete
    ctest --test-dir "$build/coverage" -j "$jobs" -L scenario -E '^test_seeds$' \
        --output-on-failure --no-tests=error || return 1
    "$gcovr" --root . --exclude-throw-branches --exclude-unreachable-branches -j "$jobs" \
        --filter src/manager/ --filter src/proto/ --txt-metric branch --txt \
        --json "$build/coverage/branches.json" "$build/coverage" &&
        "$gcovr" --root . --add-tracefile "$build/coverage/branches.json" \
            --filter src/manager/ --txt "$build/coverage/branches.txt" --txt-summary \
            --fail-under-branch 95.0
}

# 2,000 plants with their faults; the same ones each time.
run_seeds()
{
    cmake --preset seeds "-DMCANOPEN_WERROR=$werror" &&
        cmake --build --preset seeds -j "$jobs" || return 1
    SCENARIO_SEEDS=${MCANOPEN_SEEDS:-2000} SCENARIO_JOBS=$jobs "$build/seeds/tests/test_seeds"
}

# What there was in them.
show_seeds()
{
    sed -n '/ virtual hours, /,/ passed, /{/ passed, /!s/^/      /p}' "$logs/seeds.log"
}

# Refused input leaves nothing behind: each way out under valgrind.
run_refusals()
{
    cd tests/system || return 1
    MCANOPEN_TEST_WRAP=$valgrind \
        MCANOPEN_TOOLS=$build/debug/tools python3 test_bad_input.py
}

# The example programs: no error, no leak.
run_examples()
{
    cd tests/system || return 1
    MCANOPEN_TEST_WRAP="$valgrind --show-leak-kinds=all
        --errors-for-leak-kinds=all" \
        MCANOPEN_TOOLS=$build/debug/tools python3 test_examples.py
}

# What reading files may cost is counted, not timed: a test.
run_release()
{
    build_preset release &&
        python3 -B tests/bench/bench.py --build "$build/release" dcf-read dcf-growth dcf-memory &&
        echo "3 passed, 0 failed"
}

# The README's first command, as in a fresh clone: nothing is built yet. Then those of the others.
run_demo()
{
    rm -rf "$build/fresh"
    for example in boot-network async-sdo async-io cia401-io level-sensor manager-with-data \
        dcf-in-cmake; do
        MCANOPEN_BUILD=$build/fresh/demo sh examples/$example/run.sh virtual:demo-$$ || return 1
    done
}

# With sanitizers not once more: the examples have a lane with valgrind, and test_dcf_corpus reads
# the files of the other one.
elsewhere='^system_test_(corpus|examples)$'
# The tests that have threads; those of machines and parsers have none, nor have these.
no_threads='^system_test_(bad_input|check|corpus_messages|dcf2ccf)$'
threaded='^(system_|test_(api|bus|can|event|file_draft|network($|_can|_confirm)|scan|thread))'

# ---- which lanes ---------------------------------------------------------------------------------

run_unit()
{
    cmp -s tests/requirements.txt "$build/venv/installed" ||
        lane venv prepare_venv "$build/venv" tests/requirements.txt
    lane debug build_preset debug && lane unit test_preset debug
}

# These need one processor each, so they share the time.
run_side_by_side()
{
    {
        lane vcan run_vcan
        lane interop run_interop
        lane man run_man
    } &
    lane contract run_contract
    lane mutants run_mutants
    lane coverage run_coverage
    lane valgrind run_valgrind
    lane refusals run_refusals
    lane format run_format
    lane examples run_examples
    wait
}

run_more()
{
    run_side_by_side
    lane tidy run_tidy
    lane seeds run_seeds && wanted seeds && show_seeds
    lane asan test_preset asan -LE house -E "$elsewhere"
    lane tsan test_preset tsan -LE house -R "$threaded" -E "$elsewhere|$no_threads"
    lane m32 run_m32
    lane fuzz run_fuzz
    lane release run_release
    lane demo run_demo
}

run_lanes()
{
    if [ $all = yes ]; then
        # shellcheck disable=SC2086 # a list of words
        prepare_packages $packages $packages_all || return
        run_unit
        run_more
    else
        # shellcheck disable=SC2086
        prepare_packages $packages || return
        run_unit
        lane vcan run_vcan
    fi
}

usage()
{
    sed -n '2,/^set/s/^# \{0,1\}//p' "$0"
}

all=no
only=
for argument in "$@"; do
    case $argument in
    --all) all=yes ;;
    -*) usage && exit 2 ;;
    *) only="packages venv debug $only $argument" && all=yes ;;
    esac
done
case ${CI:-} in
'' | false | no | 0) werror=OFF ;;
*) werror=ON ;;
esac

begin=$(date +%s)
mkdir -p "$logs"
: >"$sums"
temporary=$(mktemp -d "${TMPDIR:-/tmp}/mcanopen-tests.XXXXXX") || exit 1
chmod 755 "$temporary"
trap 'rm -rf "$temporary"' EXIT
run_lanes
echo "all lanes: $(($(date +%s) - begin)) s, logs in build/logs"
awk '{ good += $1; bad += $2 }
     END { printf "%d passed, %d failed\n", good, bad; exit bad > 0 || good == 0 }' "$sums"
