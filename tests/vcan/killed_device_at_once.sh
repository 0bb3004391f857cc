#!/bin/sh
exec sh tests/vcan/faults/on_two_buses.sh tests/system/test_killed.py Killed.test_device_at_once
