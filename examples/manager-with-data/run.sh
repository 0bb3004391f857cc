#!/bin/sh
# A manager that handles process data, and the devices of the examples async-io and cia401-io:
#   sh examples/manager-with-data/run.sh          on a virtual bus, needs nothing
#   sh examples/manager-with-data/run.sh vcan0    on a SocketCAN interface that is up
# Installs what the build needs (Debian, as root or through sudo) and builds.
. "$(dirname "$0")/../common.sh"

echo "== two devices on $bus"
buttons=$build.buttons
make_input "$buttons"
start cia401-io "$buttons" "$build/examples/cia401-io"
start async-io /dev/null "$build/examples/async-io"
wait_for cia401-io 'on the bus'
wait_for async-io 'on the bus'

echo "== manager-with-data examples/manager-with-data/network.xml"
start manager /dev/null "$build/examples/manager-with-data" "$here/network.xml"
wait_for manager 'network is up'
cat "$build.manager.log"

echo "== mcanopen dump $bus: buttons 1 and 3 pressed, and what comes of it"
start dump /dev/null "$tools/mcanopen" dump "$bus"
wait_for dump 'listening on'
echo 05 >"$buttons"
wait_for cia401-io 'outputs 05'
wait_for dump '202#05'
grep -e '182#' -e '205#' -e '185#0500' -e '202#' "$build.dump.log"
