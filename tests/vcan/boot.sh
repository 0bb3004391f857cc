#!/bin/sh
# Boots of tests/system/ on vcan0 in place of a virtual bus: the logs that candump takes equal the
# expected ones. Runs in tests/vcan/run.sh.
set -eu
MCANOPEN_TOOLS=$MCANOPEN_BUILD/tools
MCANOPEN_TEST_BUS=vcan0
MCANOPEN_TEST_BRIEF=yes
export MCANOPEN_TOOLS MCANOPEN_TEST_BUS MCANOPEN_TEST_BRIEF
for test in tests/system/test_boot.py tests/system/test_examples.py; do
    python3 -B "$test"
done
