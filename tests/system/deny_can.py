"""Runs a command that gets an error for each CAN socket: deny_can.py ERRNO COMMAND ...

As a container or a service manager does it that does not allow AF_CAN: by a seccomp filter.
"""
import ctypes
import os
import struct
import sys

PR_SET_SECCOMP, PR_SET_NO_NEW_PRIVS, MODE_FILTER = 22, 38, 2
LOAD, JUMP_EQUAL, RETURN = 0x20, 0x15, 0x06
ALLOW, ERRNO = 0x7FFF0000, 0x00050000
NUMBER, FIRST_ARGUMENT = 0, 16  # in struct seccomp_data
SOCKET_CALLS = (41, 359, 198)  # x86-64, x86, the others; one elsewhere has no argument like AF_CAN
AF_CAN = 29


def deny(error):
    count = len(SOCKET_CALLS)
    program = [(LOAD, 0, 0, NUMBER)]
    program += [(JUMP_EQUAL, count - n, 0, call) for n, call in enumerate(SOCKET_CALLS)]
    program += [(RETURN, 0, 0, ALLOW), (LOAD, 0, 0, FIRST_ARGUMENT), (JUMP_EQUAL, 0, 1, AF_CAN),
                (RETURN, 0, 0, ERRNO | error), (RETURN, 0, 0, ALLOW)]
    code = ctypes.create_string_buffer(b"".join(struct.pack("HBBI", *line) for line in program))
    header = struct.pack("HxxxxxxP", len(program), ctypes.addressof(code))
    prctl = ctypes.CDLL(None, use_errno=True).prctl
    if prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) or prctl(PR_SET_SECCOMP, MODE_FILTER, header, 0, 0):
        sys.exit(f"deny_can: {os.strerror(ctypes.get_errno())}")


deny(int(sys.argv[1]))
os.execvp(sys.argv[2], sys.argv[2:])
