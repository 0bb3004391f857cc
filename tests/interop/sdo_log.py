"""Reads what SDO downloads did from a log of a bus: an own decoder, from frames to values."""
import struct

REQUEST, RESPONSE, ABORT = 0x600, 0x580, 4
SEGMENT, INITIATE = 0, 1  # client command specifiers
SEGMENT_DONE, INITIATED = 1, 3  # server command specifiers


class Download:
    """One transfer that is under way."""

    def __init__(self, data):
        self.index, self.sub = struct.unpack_from("<HB", data, 1)
        self.expedited, with_size = bool(data[0] & 2), bool(data[0] & 1)
        self.size = struct.unpack_from("<I", data, 4)[0] if with_size else None
        self.toggle, self.complete, self.value = 0, self.expedited, b""
        if self.expedited:
            self.size = 4 - (data[0] >> 2 & 3) if with_size else 4
            self.value = data[4:4 + self.size]

    def add_segment(self, data):
        if data[0] >> 4 & 1 != self.toggle:
            raise ValueError(f"toggle bit of {self.index:04X}h:{self.sub:02X}")
        self.toggle ^= 1
        self.value += data[1:8 - (data[0] >> 1 & 7)]
        self.complete = bool(data[0] & 1)


class Downloads:
    """Feed it the frames of a bus; 'values' is {node: {(index, sub): bytes}}, the last ones that
    a server has confirmed; 'history' the same in order: (node, index, sub, bytes)."""

    def __init__(self, frames=()):
        self.values, self.history, self.aborts = {}, [], []
        self.running = {}
        for frame in frames:
            self.feed(frame)

    def feed(self, frame):
        can_id, _, data = frame.partition("#")
        if len(can_id) != 3 or len(data) != 16:
            return
        node, service, data = int(can_id, 16) & 0x7F, int(can_id, 16) & 0x780, bytes.fromhex(data)
        if service == REQUEST:
            self._request(node, data)
        elif service == RESPONSE and node in self.running:
            self._response(node, data)

    def _request(self, node, data):
        specifier = data[0] >> 5
        if specifier == INITIATE:
            self.running[node] = Download(data)
        elif specifier == SEGMENT and node in self.running:
            self.running[node].add_segment(data)
        else:
            self.running.pop(node, None)

    def _response(self, node, data):
        download, specifier = self.running[node], data[0] >> 5
        if specifier == ABORT:
            self.aborts.append((node, *struct.unpack_from("<HBI", data, 1)))
            del self.running[node]
        elif specifier not in (INITIATED, SEGMENT_DONE):
            raise ValueError(f"node {node} answers a download with {data.hex()}")
        elif download.complete and (specifier == INITIATED) == download.expedited:
            self._done(node, download)

    def _done(self, node, download):
        if download.size is not None and download.size != len(download.value):
            raise ValueError(f"{download.size} bytes announced, {len(download.value)} sent")
        key = download.index, download.sub
        self.values.setdefault(node, {})[key] = download.value
        self.history.append((node, *key, download.value))
        del self.running[node]
