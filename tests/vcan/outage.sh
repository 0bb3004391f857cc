#!/bin/sh
# mcanopen boot and mcanopen sim on an interface of this test's own that goes down, is removed and
# made again, or has errors. Runs in tests/vcan/run.sh.
set -eu
MCANOPEN_TOOLS=$MCANOPEN_BUILD/tools
MCANOPEN_TEST_BUS=vcan1
PYTHONPATH=tests/system
export MCANOPEN_TOOLS MCANOPEN_TEST_BUS PYTHONPATH
python3 -B tests/vcan/outage.py
