#!/bin/sh
# Boots a small plant of simulated devices:
#   sh examples/boot-network/run.sh          on a virtual bus, needs nothing
#   sh examples/boot-network/run.sh vcan0    on a SocketCAN interface that is up
# Installs what the build needs (Debian, as root or through sudo) and builds.
. "$(dirname "$0")/../common.sh"

echo "== four simulated devices on $bus"
start sim /dev/null "$tools/mcanopen" sim -q --bus "$bus" "$here/network.xml"
wait_for sim 'simulated devices on'

echo "== mcanopen boot --once --all examples/boot-network/network.xml"
"$tools/mcanopen" boot --once --all "$here/network.xml"
