#!/bin/sh
# A CAN controller without hardware: slcan on a pseudo terminal whose other end is this test. It has
# what vcan has not: a bit rate and error states. Runs in tests/vcan/run.sh.
set -eu
MCANOPEN_TOOLS=$MCANOPEN_BUILD/tools
PYTHONPATH=tests/system
export MCANOPEN_TOOLS PYTHONPATH
python3 -B tests/vcan/slcan.py || [ $? -eq 77 ] # NOT RUN: without slcan
