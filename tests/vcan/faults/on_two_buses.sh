#!/bin/sh
# A system test with a gate, on vcan0 and a second bus behind the gate: on_two_buses.sh TEST ...
set -eu
MCANOPEN_TOOLS=$MCANOPEN_BUILD/tools
MCANOPEN_TEST_BUS=vcan0
MCANOPEN_TEST_INNER_BUS=vcan20
MCANOPEN_TEST_BRIEF=yes
export MCANOPEN_TEST_BRIEF MCANOPEN_TOOLS MCANOPEN_TEST_BUS MCANOPEN_TEST_INNER_BUS
ip link add vcan20 type vcan
trap 'ip link del vcan20' EXIT
ip link set vcan20 up
python3 -B "$@"
