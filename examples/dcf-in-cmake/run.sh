#!/bin/sh
# Builds the CCF files of a plant in a project of its own, with an installed copy of mcanopen, and
# boots the plant with them:
#   sh examples/dcf-in-cmake/run.sh          on a virtual bus, needs nothing
#   sh examples/dcf-in-cmake/run.sh vcan0    on a SocketCAN interface that is up
. "$(dirname "$0")/../common.sh"

echo "== mcanopen installed in ${build#"$top"/}/installed"
cmake --install "$build" --prefix "$build/installed" >/dev/null
echo "== building examples/dcf-in-cmake"
plant=$build/dcf-in-cmake
cmake -S "$here" -B "$plant" -G Ninja -DCMAKE_PREFIX_PATH="$build/installed" >/dev/null
cmake --build "$plant"

echo "== ccfread valve-9.ccf"
"$build/installed/bin/ccfread" "$plant/valve-9.ccf"

echo "== three simulated devices on $bus"
start sim /dev/null "$tools/mcanopen" sim -q --bus "$bus" --node 5 "$here/pump.dcf" \
    --node 9 "$here/valve.dcf" --node 10 "$here/valve.dcf"
wait_for sim 'simulated devices on'

echo "== mcanopen boot --once --all network.xml"
"$tools/mcanopen" boot --once --all "$plant/network.xml"
