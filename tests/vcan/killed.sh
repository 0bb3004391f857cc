#!/bin/sh
# Devices and managers killed at each step of a boot: tests/system/test_killed.py on interfaces that
# it makes. Runs in tests/vcan/run.sh.
set -eu
MCANOPEN_TOOLS=$MCANOPEN_BUILD/tools
MCANOPEN_TEST_BUS=new
MCANOPEN_TEST_BRIEF=yes
export MCANOPEN_TOOLS MCANOPEN_TEST_BUS MCANOPEN_TEST_BRIEF
exec python3 -B tests/system/test_killed.py \
    Killed.test_missed Killed.test_at_once Killed.test_manager
