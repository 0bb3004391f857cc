"""python-canopen's SDO client on a socket of its own; its protocol is as it stands.

Its network has a thread that waits for frames and hands them on, which costs more than the transfer
inside user-mode-linux: here the client fetches its answers itself. It also counts frames, and loses
those that a test names. SdoTest is what tests of such clients share.
"""
import contextlib
import random
import socket
import struct
import subprocess

import canopen
from canopen.sdo.client import SdoClient
from canopen.sdo.exceptions import SdoError
from peers import plant

REQUEST, RESPONSE, SFF_MASK = 0x600, 0x580, 0x7FF
FRAME = struct.Struct("=IB3x8s")

DEVICE = plant.TOOLS.parent / "tests" / "sdo_device"
NODE, LARGEST, EXPEDITED, BLOCK = 5, 100000, 4, 7 * 127  # bytes
DOMAIN, TEXT, OCTETS, CHECKED, NUMBERS, TIME, TIME_SPAN = (
    0x2000, 0x2001, 0x2002, 0x2003, 0x2010, 0x2011, 0x2012)
TOO_LONG, TOO_SHORT = 0x06070012, 0x06070013


class Wire(canopen.Network):
    """Frames of one CAN-ID are received, by who asks for them."""

    def __init__(self, interface, can_id, limit):
        super().__init__()
        self.socket = socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
        self.socket.setsockopt(socket.SOL_CAN_RAW, socket.CAN_RAW_FILTER,
                               struct.pack("=II", can_id, SFF_MASK))
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVTIMEO,
                               struct.pack("ll", int(limit), 0))
        self.socket.bind((interface,))
        self.sent, self.lost = 0, set()

    def send_message(self, can_id, data, remote=False):
        self.sent += 1
        if self.sent not in self.lost:
            self.socket.send(FRAME.pack(can_id, len(data), bytes(data)))

    def receive(self):
        """The data of the next frame, None when none comes."""
        try:
            return FRAME.unpack(self.socket.recv(FRAME.size))[2]
        except BlockingIOError:
            return None


class Client(SdoClient):
    """Counts from when lose() was last called."""

    def __init__(self, interface, node, limit, request=REQUEST, response=RESPONSE):
        super().__init__(request + node, response + node, canopen.ObjectDictionary())
        self.network = Wire(interface, response + node, limit)
        self.RESPONSE_TIMEOUT = limit
        self.received, self.lost = 0, set()

    def read_response(self):
        while self.responses.empty():
            data = self.network.receive()
            if data is None:
                raise canopen.SdoCommunicationError("No SDO response received")
            self.received += 1
            if self.received not in self.lost:
                self.responses.put(data)
        return super().read_response()

    def lose(self, requests=(), responses=()):
        """Frames by their numbers, 1 is the next one."""
        self.network.sent, self.network.lost = 0, set(requests)
        self.received, self.lost = 0, set(responses)

    def wait_for_abort(self):
        """The code; answers before it are passed over."""
        while True:
            try:
                self.read_response()
            except canopen.SdoAbortedError as error:
                return error.code

    def settle(self):
        """Answers of a transfer that is no more are passed over; returns what 1000h says."""
        self.send_request(bytes((0x40, 0x00, 0x10, 0, 0, 0, 0, 0)))
        while True:
            data = self.network.receive()
            if data is None or data[:4] == b"\x43\x00\x10\x00":
                return data and data[4:]

    def close(self):
        self.network.socket.close()

    # ---- transfers: python-canopen's streams, without buffers ----

    def open_to_write(self, index, sub, **how):
        return self.open(index, sub, "wb", buffering=0, **how)

    def open_to_read(self, index, sub, **how):
        return self.open(index, sub, "rb", buffering=0, block_transfer=True, **how)

    def write_segments(self, index, sub, data, size):
        stream = self.open_to_write(index, sub, size=size, force_segment=True)
        with closing(stream):
            for position in range(0, len(data), 7):
                stream.write(data[position:position + 7])

    def write_segmented(self, index, sub, data):
        self.write_segments(index, sub, data, len(data))

    def write_without_size(self, index, sub, data):
        """The last segment is empty."""
        self.write_segments(index, sub, data, None)

    def write_blocks(self, index, sub, data, **how):
        """It ends no transfer of no bytes, or without size, by itself."""
        stream = self.open_to_write(index, sub, block_transfer=True, **how)
        with closing(stream):
            for position in range(0, len(data) or 1, 7):
                stream.send(data[position:position + 7], position + 7 >= len(data))

    def write_block(self, index, sub, data):
        self.write_blocks(index, sub, data, size=len(data))

    def write_block_without_crc(self, index, sub, data):
        self.write_blocks(index, sub, data, size=len(data), request_crc_support=False)

    def write_block_without_size(self, index, sub, data):
        self.write_blocks(index, sub, data)

    def read_block(self, index, sub):
        with self.open_to_read(index, sub) as stream:
            return stream.readall()

    def read_block_without_crc(self, index, sub):
        """It takes the server's ability for a promise, and would compare with the 0 there."""
        with self.open_to_read(index, sub, request_crc_support=False) as stream:
            stream.crc_supported = False
            return stream.readall()


@contextlib.contextmanager
def closing(stream):
    """Ends the transfer. After an abort its own close() would send yet another segment, and tell of
    the abort that answers that."""
    try:
        yield
    except SdoError:
        forget(stream)
        raise
    stream.close()


def forget(stream):
    """The transfer is left as it is, nothing more is sent for it."""
    stream._done, stream._initialized, stream._error = True, False, True
    stream.close()


class SdoTest(plant.PlantTest):
    """A device of sdo_device.c and a client of it. No two values are the same: what is read is what
    was written last.
    """

    def setUp(self):
        super().setUp()
        self.device = self.start([DEVICE], stdin=subprocess.PIPE)
        self.device.wait_for("on the bus (0)")
        self.random = random.Random(self.id())
        self.sdo = self.connect()

    def connect(self, **ids):
        client = Client(self.bus.name, NODE, plant.LIMIT, **ids)
        self.addCleanup(client.close)
        return client

    def tearDown(self):
        self.device.popen.stdin.close()
        self.assertEqual(self.device.wait(), 0, self.device.story())

    def value(self, size):
        """None begins with FFh, which one of the handlers does not want."""
        data = bytearray(self.random.randbytes(size))
        data[:1] = bytes(byte & 0x7F for byte in data[:1])
        return bytes(data)

    def assert_refused(self, code, action, *arguments):
        with self.assertRaises(canopen.SdoAbortedError, msg=f"{arguments}") as caught:
            action(*arguments)
        self.assertEqual(f"{caught.exception.code:08X}", f"{code:08X}", f"{action.__name__}")

    def read_segments(self, index, sub):
        """Expedited where that is possible, as python-canopen sees it."""
        stream = self.sdo.open(index, sub, "rb", buffering=0)
        data = stream.readall()
        self.assertEqual(stream.size, len(data))
        self.assertEqual(stream.exp_data is not None, 1 <= len(data) <= EXPEDITED, f"{len(data)}")
        return data

    def assert_read(self, data, index=DOMAIN, sub=0):
        self.assertEqual(self.read_segments(index, sub), data, f"{index:04X}h:{sub:02X}")

    def segment_writers(self):
        sdo = self.sdo
        return [sdo.download, sdo.write_segmented, sdo.write_without_size]

    def block_writers(self):
        sdo = self.sdo
        return [sdo.write_block, sdo.write_block_without_crc, sdo.write_block_without_size]

    def block_readers(self):
        return [self.sdo.read_block, self.sdo.read_block_without_crc]

    def writers(self):
        return [*self.segment_writers(), *self.block_writers()]

    def readers(self):
        return [self.read_segments, *self.block_readers()]

    def open_channel(self):
        """The client of 1201h."""
        for sub, can_id in ((1, 0x6A0), (2, 0x6A1)):
            self.sdo.download(0x1201, sub, struct.pack("<I", can_id))
        return self.connect(request=0x6A0 - NODE, response=0x6A1 - NODE)
