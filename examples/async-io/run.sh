#!/bin/sh
# A device made with the slave library, booted by the manager:
#   sh examples/async-io/run.sh          on a virtual bus, needs nothing
#   sh examples/async-io/run.sh vcan0    on a SocketCAN interface that is up
# Installs what the build needs (Debian, as root or through sudo) and builds.
. "$(dirname "$0")/../common.sh"

echo "== the device on $bus"
start async-io /dev/null "$build/examples/async-io"
wait_for async-io 'on the bus'

echo "== mcanopen boot --once examples/async-io/network.xml"
"$tools/mcanopen" boot --once "$here/network.xml"

echo "== mcanopen dump -n 10 $bus: TPDO 1 is 185, its last four bytes count"
"$tools/mcanopen" dump -n 10 "$bus"
