#!/bin/sh
# The example program under valgrind, on simulated devices: no error, no leak.
#   valgrind_example.sh BUILD_DIR
set -eu
build=$1
plant=$(cd "$(dirname "$0")/../../examples/boot-network" && pwd)
bus=virtual:valgrind-$$
log=$(mktemp)
sim=

finish()
{
    [ -z "$sim" ] || kill "$sim" 2>/dev/null || true
    rm -f "$log"
}
trap finish EXIT
trap 'exit 1' INT TERM

"$build/tools/mcanopen" sim -q --bus "$bus" "$plant/network.xml" >"$log" 2>&1 &
sim=$!
until grep -q 'simulated devices on' "$log"; do
    kill -0 "$sim" || { cat "$log"; exit 1; }
    sleep 0.05
done
MCANOPEN_NET_0=$bus timeout 60 valgrind -q --error-exitcode=99 --leak-check=full \
    --show-leak-kinds=all --errors-for-leak-kinds=all \
    "$build/examples/boot-network" "$plant/network.xml"
