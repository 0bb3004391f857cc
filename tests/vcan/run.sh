#!/bin/sh
# Runs tests on a vcan0 of their own: sh tests/vcan/run.sh BUILD_DIR [TEST...]
#
# Without TEST these are the programs BUILD_DIR/tests/vcan/test_* and the scripts tests/vcan/*.sh
# beside this one; a TEST is a program, *.sh or *.py (run by MCANOPEN_PYTHON, python3).
# Where this kernel has CAN and lets us, they run in a network namespace of their own, else
# inside Debian's user-mode-linux kernel. They find vcan0 up, the tools of BUILD_DIR in PATH,
# BUILD_DIR in MCANOPEN_BUILD, an empty folder in TMPDIR, and start in the source tree.
#
# One line per test; the log of one that fails; last "N passed, N failed". The exit code is 0 only
# if there were tests and all passed. A test that ends with 77 was not run; its log says why.
# TEST_CORPUS_DIR: the corpus of real device files, where it is not beside the source tree.
# MCANOPEN_VCAN_SECONDS limits each test (60), MCANOPEN_VCAN=uml takes user-mode-linux in any case.
set -u

here=$(cd "$(dirname "$0")" && pwd)
source=$(cd "$here/../.." && pwd)
limit=${MCANOPEN_VCAN_SECONDS:-60}
python=${MCANOPEN_PYTHON:-python3}

cannot_run()
{
    echo "this lane cannot run: $*"
    exit 1
}

# ---- inside: where vcan0 is --------------------------------------------------------------------

make_vcan()
{
    ip link add vcan0 type vcan && ip link set lo up && ip link set vcan0 up
}

milliseconds()
{
    echo $(($(date +%s%N) / 1000000))
}

# run_test WORK FILE: one line into WORK/results, what it said into WORK/NAME.log
run_test()
{
    name=$(basename "$2")
    case $2 in
    *.sh) command="sh $2" ;;
    *.py) command="$python -B $2" ;;
    *) command=$2 ;;
    esac
    mkdir "$1/tmp"
    start=$(milliseconds)
    # shellcheck disable=SC2086
    (cd "$source" && TMPDIR=$1/tmp exec timeout -k 5 "$limit" $command) \
        >"$1/$name.log" 2>&1 </dev/null
    echo "$? $name $(($(milliseconds) - start))" >>"$1/results"
    rm -rf "$1/tmp"
}

# run_inside WORK: the tests in WORK/tests
run_inside()
{
    PATH=$build/tools:$PATH:/usr/sbin:/sbin
    MCANOPEN_BUILD=$build
    export PATH MCANOPEN_BUILD
    while read -r test; do
        run_test "$1" "$test"
    done <"$1/tests"
    echo end >>"$1/results"
}

# ---- outside -----------------------------------------------------------------------------------

own_tests()
{
    for test in "$build"/tests/vcan/test_* "$here"/*.sh; do
        [ -x "$test" ] || [ "$test" != "${test%.sh}" ] || continue
        [ "$(basename "$test")" = run.sh ] || echo "$test"
    done
}

# The tests named, by their whole paths.
named_tests()
{
    for test in "$@"; do
        echo "$(cd "$(dirname "$test")" && pwd)/$(basename "$test")"
    done
}

# The words that run a command in a network namespace where vcan works; nothing if there are none.
namespace_command()
{
    for words in "unshare -n" "unshare -rn"; do
        # shellcheck disable=SC2086
        if $words ip link add vcan0 type vcan 2>/dev/null; then
            echo "$words"
            return
        fi
    done
}

check_uml()
{
    command -v linux.uml >/dev/null ||
        cannot_run "this kernel has no vcan for us, and the package user-mode-linux is missing"
    PATH=$PATH:/usr/sbin:/sbin
    command -v insmod >/dev/null || cannot_run "the package kmod (insmod) is missing"
    command -v ip >/dev/null || cannot_run "the package iproute2 (ip) is missing"
    ls /usr/lib/uml/modules/*/kernel/drivers/net/can/vcan.ko >/dev/null 2>&1 ||
        cannot_run "user-mode-linux has no module vcan"
}

# The first program of the user-mode kernel.
write_init()
{
    cat <<END
#!/bin/sh
PATH=/usr/local/bin:/usr/bin:/bin:/usr/local/sbin:/usr/sbin:/sbin
export PATH
mount -t proc proc /proc
mount -t sysfs sysfs /sys
mkdir -p /dev/shm
mount -t tmpfs tmpfs /dev/shm
ln -s /proc/self/fd /dev/fd
mount -t tmpfs tmpfs /run
mkdir -p /dev/pts
mount -t devpts devpts /dev/pts
modules=/usr/lib/uml/modules/\$(uname -r)/kernel
for module in net/can/can net/can/can-raw net/can/can-bcm drivers/net/can/dev/can-dev \\
    drivers/net/can/vcan drivers/net/can/slcan/slcan; do
    insmod \$modules/\$module.ko
done
${TEST_CORPUS_DIR:+export TEST_CORPUS_DIR='$TEST_CORPUS_DIR'}
MCANOPEN_VCAN_SECONDS=$limit MCANOPEN_PYTHON='$python' sh '$here/run.sh' --inside '$1' '$build'
sync
echo o >/proc/sysrq-trigger
sleep 60
END
}

# user-mode-linux has one CPU, and processes that wait for each other: on one of ours it is twice as
# fast as on two.
on_one_cpu()
{
    cpu=$(($$ % $(nproc)))
    if taskset -c $cpu true 2>/dev/null; then
        taskset -c $cpu "$@"
    else
        "$@"
    fi
}

run_uml()
{
    check_uml
    write_init "$1" >"$1/init"
    chmod +x "$1/init"
    # Its memory is a file in TMPDIR, where that is set, and in memory else.
    on_one_cpu env -u TMPDIR timeout -k 5 900 linux.uml mem=512M root=/dev/root \
        rootfstype=hostfs rootflags=/ rw quiet "init=$1/init" con=null con0=fd:0,fd:1 \
        >"$1/console" 2>&1 </dev/null
}

# cases_of LOG STATUS: "GOOD BAD" by the summaries of Check in it; without one it is one test
cases_of()
{
    awk -v "status=$2" '
        /^[0-9]+%: Checks: [0-9]+, Failures: [0-9]+, Errors: [0-9]+$/ {
            split($0, n, /[^0-9]+/)
            good += n[2] - n[3] - n[4]; bad += n[3] + n[4]
        }
        END {
            if (status == 77) { print 0, 0; exit }
            if (status != 0 && bad == 0) bad = 1
            if (status == 0 && good == 0) good = 1
            print good + 0, bad + 0
        }
    ' "$1"
}

# report WORK: the lines and logs; the exit code of the lane
report()
{
    passed=0
    failed=0
    while read -r status name time; do
        [ "$status" = end ] && break
        verdict=ok
        [ "$status" = 124 ] && echo "time limit: $limit s" >>"$1/$name.log"
        cases=$(cases_of "$1/$name.log" "$status")
        passed=$((passed + ${cases% *}))
        failed=$((failed + ${cases#* }))
        [ "$status" = 0 ] || verdict=FAIL
        [ "$status" = 77 ] && verdict=none
        printf '%-5s %-40s %6d ms\n' "$verdict" "$name" "$time"
        [ "$status" = 0 ] || sed 's/^/    /' "$1/$name.log"
    done <"$1/results"
    if ! grep -q '^end$' "$1/results"; then
        echo "the tests did not come to their end:"
        tail -n 20 "$1/console"
        failed=$((failed + 1))
    fi
    [ "$passed$failed" != 00 ] || echo "there are no tests"
    echo "$passed passed, $failed failed"
    [ $failed -eq 0 ] && [ $passed -gt 0 ]
}

if [ "${1:-}" = --inside ]; then
    build=$3
    make_vcan && run_inside "$2"
    exit
fi
[ $# -ge 1 ] || cannot_run "usage: run.sh BUILD_DIR [TEST...]"
build=$(cd "$1" && pwd) || exit 1
shift
for test in "$@"; do
    [ -e "$test" ] || cannot_run "there is no $test"
done
work=$(mktemp -d "${TMPDIR:-/tmp}/mcanopen-vcan.XXXXXX") || exit 1
trap 'rm -rf "$work"' EXIT
: >"$work/results"
if [ $# -gt 0 ]; then
    named_tests "$@" >"$work/tests"
else
    own_tests >"$work/tests"
fi
start=$(milliseconds)
words=
[ "${MCANOPEN_VCAN:-}" = uml ] || words=$(namespace_command)
if [ -n "$words" ]; then
    # shellcheck disable=SC2086
    $words sh "$here/run.sh" --inside "$work" "$build" >"$work/console" 2>&1
else
    run_uml "$work"
fi
report "$work"
status=$?
echo "$(($(milliseconds) - start)) ms in all, ${words:-user-mode-linux}" >&2
exit $status
