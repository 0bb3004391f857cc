#!/bin/sh
# dcftest --online against our device on vcan0: tests/system/test_dcftest_online.py.
set -eu
MCANOPEN_TOOLS=$MCANOPEN_BUILD/tools
MCANOPEN_TEST_BUS=vcan0
export MCANOPEN_TOOLS MCANOPEN_TEST_BUS
exec python3 -B tests/system/test_dcftest_online.py Online.test_values Online.test_left_out \
    Online.test_nothing_but_reading
