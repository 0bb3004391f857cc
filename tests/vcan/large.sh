#!/bin/sh
# The largest network: tests/system/test_large.py on vcan0. Runs in tests/vcan/run.sh.
set -eu
MCANOPEN_TOOLS=$MCANOPEN_BUILD/tools
MCANOPEN_TEST_BUS=vcan0
export MCANOPEN_TOOLS MCANOPEN_TEST_BUS
exec python3 -B tests/system/test_large.py
