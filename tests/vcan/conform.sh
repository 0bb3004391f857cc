#!/bin/sh
# mcanopen conform against our device on vcan0: tests/system/test_conform.py.
set -eu
MCANOPEN_TOOLS=$MCANOPEN_BUILD/tools
MCANOPEN_TEST_BUS=vcan0
export MCANOPEN_TOOLS MCANOPEN_TEST_BUS
exec python3 -B tests/system/test_conform.py Conform.test_with_eds
