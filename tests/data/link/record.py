#!/usr/bin/env python3
"""Records what rtnetlink tells while commands run: record.py NAME COMMAND... >FILE

Each command, then the request for the interface NAME, becomes a line "# what was done"; below it
each datagram of the kernel that it has brought, as a line of hexadecimal digits. vcan.txt is from a
Linux 6.1 as tests/vcan/run.sh starts it:

    record.py vcan9 'ip link add vcan9 type vcan' 'ip link set vcan9 up' ...

slcan.txt is of a CAN controller, slcan on a pseudo terminal whose other end reported its errors.
"""
import socket
import struct
import subprocess
import sys

ROUTE, LINK_GROUP, GET_LINK, REQUEST, IFNAME = 0, 1, 18, 1, 3


def tell(news, title):
    print("#", title)
    while True:
        try:
            print(news.recv(65536).hex())
        except BlockingIOError:
            return


def ask(news, name):
    text = name.encode() + b"\0"
    attribute = struct.pack("HH", 4 + len(text), IFNAME) + text
    attribute += bytes(-len(attribute) % 4)
    body = bytes(16) + attribute
    news.send(struct.pack("IHHII", 16 + len(body), GET_LINK, REQUEST, 1, 0) + body)
    tell(news, "request for " + name)


def main():
    news = socket.socket(socket.AF_NETLINK, socket.SOCK_RAW, ROUTE)
    news.bind((0, LINK_GROUP))
    news.setblocking(False)
    ask(news, sys.argv[1])
    for command in sys.argv[2:]:
        subprocess.run(command, shell=True, check=True)
        tell(news, command)
    ask(news, sys.argv[1])


if __name__ == "__main__":
    main()
