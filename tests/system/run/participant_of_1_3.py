#!/usr/bin/env python3
"""A multibody solver that speaks protocol 1.3 as it was, and shares no code with the programs that it is tried with: header,
checksum, messages and shared memory are written down here, and stay as they are when the protocol goes on. It knows bodies with
the same inertia about all axes, without joints and forces. Standard library only."""
import ctypes
import json
import math
import mmap
import platform
import socket
import struct
import sys

LAYOUT = 0x6da5c5873d6d05de  # hash over messages and records of 1.3, which the shared memory has as well
HELLO, WELCOME, REFUSE, CONFIGURE, CONFIGURED, PREDICT, ADVANCE, MOTION = range(1, 9)
SAVE, RESTORE, DONE, OBSERVE, BODIES, FINISH, REPORT, FAILURE = 11, 12, 13, 14, 15, 17, 18, 19
PREDICTS, ROLLS_BACK = 1, 2
ODD_0, ODD_1, WORD = 0x9e3779b97f4a7c15, 0xbb67ae8584caa73b, 2**64 - 1


def mixed(lane, word):
    lane ^= word
    return ((lane << 29 | lane >> 35) & WORD) * ODD_0 & WORD


def checksum(data, start=0):
    lanes = [start + ODD_0 & WORD, start ^ ODD_1, start - ODD_1 & WORD, ~start & WORD]
    words = [int.from_bytes(data[i:i + 8], "little") for i in range(0, len(data), 8)]
    whole = len(data) // 32 * 4
    for i in range(whole):
        lanes[i % 4] = mixed(lanes[i % 4], words[i])
    sum_ = lanes[0]
    for word in lanes[1:] + words[whole:] + [len(data)]:
        sum_ = mixed(sum_, word)
    return (sum_ ^ sum_ >> 32) * ODD_1 & WORD


class Header:
    FORM = struct.Struct("<4sHHHHIQQQQIIQ")

    def __init__(self, kind=0, run=0, generation=0, window=0, iteration=0):
        self.kind, self.run, self.generation, self.window, self.iteration = kind, run, generation, window, iteration

    def sealed(self, sequence, payload):
        def packed(sum_):
            return self.FORM.pack(b"TNDM", 1, 3, self.kind, 0, self.generation, self.run, self.window, sequence,
                                  len(payload), self.iteration, 0, sum_)
        return packed(checksum(payload, checksum(packed(0)))) + payload

    @classmethod
    def opened(cls, frame):
        (magic, major, minor, kind, _, generation, run, window, sequence, size, iteration, flags, sum_) = cls.FORM.unpack(frame[:64])
        header = cls(kind, run, generation, window, iteration)
        if (magic, major, minor) != (b"TNDM", 1, 3):
            sys.exit(f"error: a frame of {magic!r} {major}.{minor} came, this program speaks 1.3")
        if size != len(frame) - 64 or flags or header.sealed(sequence, frame[64:]) != frame:
            sys.exit(f"error: the checksum {sum_:x} is not that of 1.3")
        return header


class Ring:
    """One direction of the shared memory: bytes written and read, and a doorbell for each end."""

    def __init__(self, memory, head, bytes_, size):
        def word(kind, at):
            return kind.from_buffer(memory, head + at)
        self.written, self.read = word(ctypes.c_uint64, 0), word(ctypes.c_uint64, 64)
        self.bells = {bell: (word(ctypes.c_uint32, at), word(ctypes.c_uint32, at + 4)) for bell, at in (("data", 128), ("room", 192))}
        self.memory, self.bytes, self.size, self.gone = memory, bytes_, size, lambda: False

    def ring(self, bell):
        rings, sleepers = self.bells[bell]
        if sleepers.value:
            rings.value += 1
            ctypes.CDLL(None).syscall({"x86_64": 202, "aarch64": 98}[platform.machine()], ctypes.byref(rings), 1, 1, None, None, 0)

    def until(self, ready):
        while not ready():
            if self.gone():
                sys.exit("error: the coordinator closed its end")

    def put(self, data):
        for byte in data:
            self.until(lambda: self.written.value - self.read.value < self.size)
            self.memory[self.bytes + self.written.value % self.size] = byte
            self.written.value += 1
        self.ring("data")

    def take(self, count):
        taken = bytearray()
        while len(taken) < count:
            self.until(lambda: self.written.value > self.read.value)
            at = self.read.value % self.size
            some = min(count - len(taken), self.written.value - self.read.value, self.size - at)
            taken += self.memory[self.bytes + at:self.bytes + at + some]
            self.read.value += some
            self.ring("room")
        return bytes(taken)


class Channel:
    def __init__(self, address):
        if not address.startswith("fd:"):
            sys.exit("error: this program is started by a coordinator")
        self.socket = socket.socket(fileno=int(address[3:]))
        _, (memory,), *_ = socket.recv_fds(self.socket, 1, 1)
        self.memory = mmap.mmap(memory, 0)
        magic, layout, head, size, ready = struct.unpack_from("<8sQQQI", self.memory)
        if (magic, head, ready, layout) != (b"TNTDSHM1", 576, 1, LAYOUT):
            sys.exit("error: the shared memory has another layout than this program's (start both sides from the same release)")
        self.inward, self.outward = Ring(self.memory, 64, 576, size), Ring(self.memory, 320, 576 + size, size)
        self.inward.gone = self.outward.gone = self.hung_up
        self.socket.send(b"\0")
        self.socket.setblocking(False)
        self.sequence = 0

    def hung_up(self):
        try:
            return self.socket.recv(1) == b""
        except BlockingIOError:
            return False

    def send(self, header, payload):
        self.sequence += 1
        frame = header.sealed(self.sequence, payload)
        self.outward.put(struct.pack("<Q", len(frame)) + frame)

    def receive(self):
        frame = self.inward.take(struct.unpack("<Q", self.inward.take(8))[0])
        return Header.opened(frame), frame[64:]


def array(items, count=None):
    return struct.pack("<Q", len(items) if count is None else count) + items + bytes(-len(items) % 8)


def text(words):
    return array(words.encode())


class Body:
    def __init__(self, index, scene):
        self.index, self.mass, self.inertia = index, scene["mass"], scene["inertia"][0]
        self.x, self.q = scene.get("position", [0, 0, 0]), scene.get("orientation", [1, 0, 0, 0])
        self.v, self.w = scene.get("velocity", [0, 0, 0]), scene.get("angular_velocity", [0, 0, 0])

    def moved(self, h, a, alpha):
        """The state after a window under constant accelerations: position, quaternion, velocity, angular velocity."""
        x = [x + h * v + h * h / 2 * a for x, v, a in zip(self.x, self.v, a)]
        turn = [h * w + h * h / 2 * b for w, b in zip(self.w, alpha)]
        half = math.hypot(*turn) / 2
        share = 0.5 if half == 0 else math.sin(half) / (2 * half)
        (pw, px, py, pz), (w, i, j, k) = [math.cos(half)] + [share * t for t in turn], self.q
        q = [pw * w - px * i - py * j - pz * k, pw * i + px * w + py * k - pz * j, pw * j - px * k + py * w + pz * i,
             pw * k + px * j - py * i + pz * w]
        return x, q, [v + h * a for v, a in zip(self.v, a)], [w + h * b for w, b in zip(self.w, alpha)], turn


class Solver:
    def __init__(self, scene):
        if scene["mbd"].get("joints") or scene["mbd"].get("forces"):
            sys.exit("error: mbd: this program knows neither joints nor forces")
        self.bodies = [Body(index, body) for index, body in enumerate(scene["mbd"]["bodies"])]
        with_walls = {wall.get("body") for wall in scene.get("dem", {}).get("walls", [])}
        self.boundary = [body for body, data in zip(self.bodies, scene["mbd"]["bodies"]) if data["name"] in with_walls]
        self.gravity = scene.get("gravity", [0, 0, -9.81])

    def motions(self, h, loads, keep):
        records = b""
        for body in self.bodies:
            mean = loads.get(body.index, [0.0] * 6)
            a, alpha = [0.0] * 3, [0.0] * 3
            if keep:
                a = [g + f / body.mass for g, f in zip(self.gravity, mean)]
                alpha = [t / body.inertia for t in mean[3:]]
            x, q, v, w, turn = body.moved(h, a, alpha)
            work = sum(f * s for f, s in zip(mean, [e - b for e, b in zip(x, body.x)] + turn))
            if body in self.boundary:
                records += struct.pack("<II45d", body.index, 0, *body.x, *body.q, *x, *q, *body.v, *body.w, *v, *w, *a, *a, *alpha,
                                       *alpha, *[h * f for f in mean], work)
            if keep:
                body.x, body.q, body.v, body.w = x, q, v, w
        return array(records, len(self.boundary))

    def observed(self, time):
        energy, records = 0.0, b""
        for b in self.bodies:
            energy += b.mass * (sum(v * v for v in b.v) / 2 - sum(g * x for g, x in zip(self.gravity, b.x)))
            energy += b.inertia * sum(w * w for w in b.w) / 2
            records += struct.pack("<II13d", b.index, 0, *b.x, *b.q, *b.v, *b.w)
        return struct.pack("<q", time) + array(records, len(self.bodies)) + array(b"") + struct.pack("<d", energy)


def loads_of(payload):
    """Mean force and torque by body: after the window (3 words) and the particles' account (19), 20 words for each body."""
    (count,) = struct.unpack_from("<Q", payload, 176)
    rows = [struct.unpack_from("<II6d", payload, 184 + 160 * row) for row in range(count)]
    return {row[0]: list(row[2:]) for row in rows}


def main():
    channel = Channel(sys.argv[sys.argv.index("--shm") + 1])
    channel.send(Header(HELLO), struct.pack("<QQQq", 1, LAYOUT, PREDICTS | ROLLS_BACK, 0) + text("old_bodies 1.3") + text("here"))
    solver, saved = None, None
    while True:
        order, payload = channel.receive()
        if order.kind in (REFUSE, FAILURE):
            sys.exit("error: the coordinator refuses: " + payload[16:].decode(errors="replace"))
        if order.kind == WELCOME:
            continue
        answer = Header(DONE, order.run, order.generation, order.window, order.iteration)
        said = b""
        if order.kind == CONFIGURE:
            (size,) = struct.unpack_from("<Q", payload)
            solver = Solver(json.loads(payload[8:8 + size]))
            answer.kind, said = CONFIGURED, solver.motions(0.0, {}, False) + text('{"mbd_steps": 0}')
        elif order.kind in (PREDICT, ADVANCE):
            _, begin, end = struct.unpack_from("<Qqq", payload)
            loads = loads_of(payload) if order.kind == ADVANCE else {}
            answer.kind, said = MOTION, payload[:24] + solver.motions(1e-9 * (end - begin), loads, order.kind == ADVANCE)
        elif order.kind == SAVE:
            saved = [dict(vars(body)) for body in solver.bodies]
        elif order.kind == RESTORE:
            for body, state in zip(solver.bodies, saved):
                vars(body).update(state)
        elif order.kind == OBSERVE:
            answer.kind, said = BODIES, solver.observed(struct.unpack("<q", payload)[0])
        elif order.kind == FINISH:
            channel.send(Header(REPORT, order.run, order.generation, order.window, order.iteration), text('{"mbd_steps": 1}'))
            return
        else:
            sys.exit(f"error: 1.3 has no order {order.kind} for this solver")
        channel.send(answer, said)


main()
