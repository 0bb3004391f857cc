#!/bin/sh
# Real devices, simulated and booted as one network on vcan0: tests/system/test_corpus.py. Without
# the corpus it is not run, and says so.
set -eu
MCANOPEN_TOOLS=$MCANOPEN_BUILD/tools
MCANOPEN_TEST_BUS=vcan0
export MCANOPEN_TOOLS MCANOPEN_TEST_BUS
exec python3 -B tests/system/test_corpus.py RealDevices.test_configured
