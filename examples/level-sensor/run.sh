#!/bin/sh
# The device of docs/make-a-device.md, tested as a conformance test does:
#   sh examples/level-sensor/run.sh          on a virtual bus, needs nothing
#   sh examples/level-sensor/run.sh vcan0    on a SocketCAN interface that is up
# Installs what the build needs (Debian, as root or through sudo) and builds.
. "$(dirname "$0")/../common.sh"

echo "== the device on $bus; what it stores is in ${build#"$top"/}.sensor"
levels=$build.levels
make_input "$levels"
mkdir -p "$build.sensor"
start level-sensor "$levels" "$build/examples/level-sensor" "$build.sensor"
wait_for level-sensor 'on the bus'

echo "== mcanopen conform -n 5 --eds examples/level-sensor/level-sensor.eds"
"$tools/mcanopen" conform --bus "$bus" -n 5 --eds "$here/level-sensor.eds"

echo "== mcanopen dump $bus: the level passes the limit, an emergency is 085"
start dump /dev/null "$tools/mcanopen" dump "$bus"
wait_for dump 'listening on'
echo 950 >"$levels"
wait_for dump '085#0090'
echo 500 >"$levels"
wait_for dump '085#0000'
grep '085#' "$build.dump.log"
