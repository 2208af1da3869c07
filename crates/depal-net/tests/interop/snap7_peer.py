"""The other end of an S7 connection, played with python-snap7 (2.1.0: the C++ library, 3.3.0: pure Python).

    snap7_peer.py plc PORT COUNT      offers the data block and runs COUNT handshakes of a controller's program
    snap7_peer.py client PORT COUNT   runs them against a block that is offered at PORT

Prints one line of JSON at the end. Exit code 0: every handshake went as it should.
"""

import ctypes
import json
import struct
import sys
import threading
import time

BLOCK_BYTES = 9696
PATIENCE_S = 20.0


class Memory:
    """The block as memory that a server of ours offers."""

    def __init__(self, port):
        import snap7
        from snap7.server import Server
        from snap7.type import SrvArea

        # The pure Python version writes to a bytearray, the C++ library to an array of C.
        if int(version().split(".")[0]) >= 3:
            self.bytes = bytearray(BLOCK_BYTES)
        else:
            self.bytes = (ctypes.c_uint8 * BLOCK_BYTES)()
        self.server = Server(log=False)
        self.server.register_area(SrvArea.DB, 1, self.bytes)
        self.server.start(tcp_port=port)

    def read(self, first, count):
        return bytes(bytearray(self.bytes[first : first + count]))

    def write(self, first, data):
        for place, byte in enumerate(data):
            self.bytes[first + place] = byte


class Remote:
    """The block at somebody else's."""

    def __init__(self, port):
        from snap7.client import Client

        self.client = Client()
        self.client.connect("127.0.0.1", 0, 1, tcp_port=port)

    def read(self, first, count):
        return bytes(self.client.db_read(1, first, count))

    def write(self, first, data):
        self.client.db_write(1, first, bytearray(data))


class Program:
    """What a controller's program does."""

    def __init__(self, block):
        self.block = block
        self.heartbeats = 0

    def int_at(self, first):
        return struct.unpack(">h", self.block.read(first, 2))[0]

    def bool_at(self, first):
        return self.block.read(first, 1)[0] & 1

    def wait(self, what, done):
        deadline = time.monotonic() + PATIENCE_S
        while not done():
            if time.monotonic() > deadline:
                raise SystemExit(f"waited {PATIENCE_S} s for: {what}")
            time.sleep(0.0005)

    def call(self, command, pose_type=0, pose_number=0, project=0):
        self.block.write(2, struct.pack(">4h", command, pose_type, pose_number, project))
        self.block.write(0, [1])
        self.wait("Acknowledge", lambda: self.bool_at(194) == 1)
        self.block.write(0, [0])
        self.wait("Acknowledge falls", lambda: self.bool_at(194) == 0)
        self.wait("Status", lambda: self.int_at(200) != 0)
        return self.int_at(200)

    def expect(self, what, found, expected):
        if found != expected:
            raise SystemExit(f"{what}: expected {expected}, found {found}")

    def cycle(self):
        """Three handshakes: state, start, fetch; and the points as the test's vision side finds them."""
        self.expect("901", self.call(901), 1101)
        self.expect("101", self.call(101, project=1), 1102)
        self.expect("102", self.call(102, project=1), 1100)
        self.wait("Status of Pose Sent", lambda: self.bool_at(202) == 1)
        self.expect("number of poses", self.int_at(204), 3)
        x = [struct.unpack(">f", self.block.read(208 + 24 * row, 4))[0] for row in range(3)]
        self.expect("x of the poses", x, [100.0, 200.0, 300.0])
        labels = list(struct.unpack(">4h", self.block.read(1168, 8)))
        self.expect("labels", labels, [1, 2, 3, 0])
        self.block.write(202, [0])


def version():
    from importlib.metadata import version

    return version("python-snap7")


def main():
    mode, port, count = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    block = Memory(port) if mode == "plc" else Remote(port)
    program = Program(block)
    is_over = threading.Event()

    def write_on():
        """A program writes its other parameters all the time: positions, and the state of the robot."""
        value = 0
        while not is_over.is_set():
            value = (value + 1) % 1000
            block.write(12, struct.pack(">12f", *[float(value)] * 12))
            block.write(104, struct.pack(">h", value))
            time.sleep(0.0002)

    writer = threading.Thread(target=write_on, daemon=True)
    if mode == "plc":
        writer.start()
    print("ready", flush=True)
    started = time.monotonic()
    done = 0
    while done < count:
        program.cycle()
        done += 3
    took = time.monotonic() - started
    is_over.set()
    # Vision keeps out of the controller's half.
    if mode == "client":
        try:
            block.client.db_read(1, 9690, 10)
            raise SystemExit("a read past the end succeeded")
        except Exception as error:  # noqa: BLE001: each version has its own kinds
            if isinstance(error, SystemExit):
                raise
        program.expect("length of the block", len(block.read(0, BLOCK_BYTES)), BLOCK_BYTES)
    print(json.dumps({"version": version(), "handshakes": done, "seconds": round(took, 3)}), flush=True)
    # The C++ server's threads need not end in order.
    sys.stdout.flush()
    import os

    os._exit(0)


main()
