#!/bin/sh
# Two managers, traffic that is not CANopen's, no bus: tests/system/test_foreign.py on vcan0.
set -eu
MCANOPEN_TOOLS=$MCANOPEN_BUILD/tools
MCANOPEN_TEST_BUS=vcan0
export MCANOPEN_TOOLS MCANOPEN_TEST_BUS
exec python3 -B tests/system/test_foreign.py
