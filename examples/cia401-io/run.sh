#!/bin/sh
# A digital I/O device after CiA 401, configured and watched by the manager:
#   sh examples/cia401-io/run.sh          on a virtual bus, needs nothing
#   sh examples/cia401-io/run.sh vcan0    on a SocketCAN interface that is up
# Installs what the build needs (Debian, as root or through sudo) and builds.
. "$(dirname "$0")/../common.sh"

echo "== the device on $bus"
buttons=$build.buttons
make_input "$buttons"
start cia401-io "$buttons" "$build/examples/cia401-io"
wait_for cia401-io 'on the bus'

echo "== mcanopen boot examples/cia401-io/network.xml"
start boot /dev/null "$tools/mcanopen" boot "$here/network.xml"
wait_for boot 'network is up'
cat "$build.boot.log"

echo "== mcanopen dump $bus: buttons 1 and 3 pressed, TPDO 1 is 182"
start dump /dev/null "$tools/mcanopen" dump "$bus"
wait_for dump 'listening on'
echo 05 >"$buttons"
wait_for dump '182#05'
grep '182#' "$build.dump.log"
