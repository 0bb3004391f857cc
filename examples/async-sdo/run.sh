#!/bin/sh
# Asks the simulated devices of the first example, all side by side:
#   sh examples/async-sdo/run.sh          on a virtual bus, needs nothing
#   sh examples/async-sdo/run.sh vcan0    on a SocketCAN interface that is up
. "$(dirname "$0")/../common.sh"
network=$here/../boot-network/network.xml

echo "== four simulated devices on $bus"
start sim /dev/null "$tools/mcanopen" sim -q --bus "$bus" "$network"
wait_for sim 'simulated devices on'

echo "== async-sdo examples/boot-network/network.xml"
"$build/examples/async-sdo" "$network"
