#!/usr/bin/env python3
"""Reads and writes frames of navigating robots, by docs/protocol.md and nothing else.

Takes lines from the standard input, and answers each with a line on the standard output:

    encode   a message in JSON     -> the frame in hexadecimal
    decode   a frame in hexadecimal -> the message in JSON, and the cells of its walls
    digest   the frames of all members of a round, with spaces between them -> the digest

A line that is refused is answered with an empty one, its reason goes to the standard error, and
the exit code is 1. Needs Python 3.8 or later and no package.
"""

import argparse
import json
import sys

VERSION = 2
MAX_FRAME = 127
MAX_TEAM = 8
MAX_EVIDENCE = 4
MAX_READINGS = 8
MAX_WAYPOINTS = 4
MAX_WALL_BYTES = 11
TAG_BYTES = 8

LAYOUT = (
    "sender u8; epoch u32; sequence u32; "
    "navigation 4: round u32; view u8; walls sequence scale u8 skipped u8 bits sequence u8; "
    "anchor cell u16; purpose Goal, Visit cell u16, Charge cell u16, Stand; "
    "counts u8; evidence cell u16 weight i8; readings u8; "
    "answer Listing u8, Scored digest 4 u8 scores sequence delay u8 price u8, "
    "Decided digest 4 u8 option scores option policy u8 probability u8 step u16; "
    "waypoints sequence cell u16"
)


class Refused(Exception):
    """Why a frame or a message is none."""


# Hashes


def fnv1a(data):
    state = 0xCBF29CE484222325
    for byte in data:
        state = (state ^ byte) * 0x100000001B3 % 2**64
    return state


def rotated(word, by):
    return (word << by | word >> (64 - by)) % 2**64


def sip_rounds(v, count):
    a, b, c, d = v
    for _ in range(count):
        a, c = (a + b) % 2**64, (c + d) % 2**64
        b, d = rotated(b, 13) ^ a, rotated(d, 16) ^ c
        a = rotated(a, 32)
        a, c = (a + d) % 2**64, (c + b) % 2**64
        d, b = rotated(d, 21) ^ a, rotated(b, 17) ^ c
        c = rotated(c, 32)
    return a, b, c, d


def siphash_2_4(key, data):
    k = [int.from_bytes(half, "little") for half in (key[:8], key[8:])]
    a, b = k[0] ^ 0x736F6D6570736575, k[1] ^ 0x646F72616E646F6D
    c, d = k[0] ^ 0x6C7967656E657261, k[1] ^ 0x7465646279746573
    whole = len(data) // 8 * 8
    padded = data + bytes(whole + 7 - len(data)) + bytes([len(data) % 256])
    for at in range(0, len(padded), 8):
        word = int.from_bytes(padded[at : at + 8], "little")
        a, b, c, d = sip_rounds((a, b, c, d ^ word), 2)
        a ^= word
    a, b, c, d = sip_rounds((a, b, c ^ 0xFF, d), 4)
    return (a ^ b ^ c ^ d).to_bytes(8, "little")


# Values: each can write one to bytes, and read one from the front of bytes


def take(data, count):
    if len(data) < count:
        raise Refused("the body ends too early")
    return data[:count], data[count:]


class Integer:
    """In one byte: two's complement if it has a sign."""

    def __init__(self, low, high):
        self.low, self.high = low, high

    def write(self, value):
        return bytes([self.checked(value) % 256])

    def read(self, data):
        (byte,), rest = take(data, 1)
        return byte if byte <= self.high else byte - 256, rest

    def checked(self, value):
        if type(value) is not int or not self.low <= value <= self.high:
            raise Refused("%r is no number from %d to %d" % (value, self.low, self.high))
        return value


class Varint(Integer):
    """Seven bits a byte, the lowest first."""

    def __init__(self, bits):
        super().__init__(0, 2**bits - 1)
        self.longest = (bits + 6) // 7

    def write(self, value):
        rest, written = self.checked(value), []
        while rest > 127:
            written.append(rest % 128 + 128)
            rest //= 128
        return bytes(written + [rest])

    def read(self, data):
        value = 0
        for at in range(self.longest):
            (byte,), data = take(data, 1)
            value += byte % 128 << 7 * at
            if byte < 128:
                return self.checked(value), data
        raise Refused("a number of more than %d bytes" % self.longest)


U8, I8, U16, U32 = Integer(0, 255), Integer(-128, 127), Varint(16), Varint(32)


class Array:
    """A fixed number of values, one after another."""

    def __init__(self, item, count):
        self.item, self.count = item, count

    def write(self, values):
        if not isinstance(values, list) or len(values) != self.count:
            raise Refused("no list of %d" % self.count)
        return b"".join(self.item.write(value) for value in values)

    def read(self, data):
        values = []
        for _ in range(self.count):
            value, data = self.item.read(data)
            values.append(value)
        return values, data


class Sequence:
    """A count, then the values."""

    def __init__(self, item, most):
        self.item, self.most = item, most

    def write(self, values):
        if not isinstance(values, list) or len(values) > self.most:
            raise Refused("no list of at most %d" % self.most)
        return U32.write(len(values)) + Array(self.item, len(values)).write(values)

    def read(self, data):
        count, data = U32.read(data)
        if count > self.most:
            raise Refused("%d values where at most %d fit" % (count, self.most))
        return Array(self.item, count).read(data)


class Option:
    """0, or 1 and a value."""

    def __init__(self, item):
        self.item = item

    def write(self, value):
        return b"\0" if value is None else b"\1" + self.item.write(value)

    def read(self, data):
        (flag,), data = take(data, 1)
        if flag > 1:
            raise Refused("%d where only 0 or 1 can be" % flag)
        return self.item.read(data) if flag else (None, data)


def named(name, action, argument):
    try:
        return action(argument)
    except Refused as reason:
        raise Refused("%s: %s" % (name, reason)) from None


class Record:
    """Named values in their order."""

    def __init__(self, **fields):
        self.fields = fields

    def write(self, value):
        if not isinstance(value, dict) or set(value) != set(self.fields):
            raise Refused("it must have %s and nothing else" % ", ".join(self.fields or ["nothing"]))
        return b"".join(named(name, field.write, value[name]) for name, field in self.fields.items())

    def read(self, data):
        value = {}
        for name, field in self.fields.items():
            value[name], data = named(name, field.read, data)
        return value, data


class Either:
    """The number of one of several forms, then its value; those without a value are only named."""

    def __init__(self, *forms):
        self.forms = forms

    def write(self, value):
        for number, (name, content) in enumerate(self.forms):
            if content is None and value == name:
                return U32.write(number)
            if content is not None and isinstance(value, dict) and list(value) == [name]:
                return U32.write(number) + content.write(value[name])
        raise Refused("%r is none of %s" % (value, ", ".join(name for name, _ in self.forms)))

    def read(self, data):
        number, data = U32.read(data)
        if number >= len(self.forms):
            raise Refused("form %d of %d" % (number, len(self.forms)))
        name, content = self.forms[number]
        if content is None:
            return name, data
        value, data = content.read(data)
        return {name: value}, data


HEADER = Record(sender=U8, epoch=U32, sequence=U32)
WALL = Record(scale=U8, skipped=U8, bits=Sequence(U8, MAX_WALL_BYTES))
PROPOSAL = Record(round=U32, view=U8, walls=Sequence(WALL, MAX_TEAM // 2))
PURPOSE = Either(("Goal", None), ("Visit", U16), ("Charge", U16), ("Stand", None))
KNOWN = Record(cell=U16, weight=I8)


class Seen:
    """Anchor and purpose; one byte that counts two lists, the first in its low half; the lists."""

    names = {"anchor", "purpose", "evidence", "readings"}

    def write(self, fact):
        if not isinstance(fact, dict) or set(fact) != self.names:
            raise Refused("a fact must have %s and nothing else" % ", ".join(sorted(self.names)))
        evidence, readings = fact["evidence"], fact["readings"]
        for values, most in ((evidence, MAX_EVIDENCE), (readings, MAX_READINGS)):
            if not isinstance(values, list) or len(values) > most:
                raise Refused("no list of at most %d" % most)
        start = named("anchor", U16.write, fact["anchor"]) + named("purpose", PURPOSE.write, fact["purpose"])
        counts = bytes([len(evidence) | len(readings) << 4])
        lists = named("evidence", Array(KNOWN, len(evidence)).write, evidence)
        return start + counts + lists + named("readings", Array(U8, len(readings)).write, readings)

    def read(self, data):
        fact = {}
        fact["anchor"], data = named("anchor", U16.read, data)
        fact["purpose"], data = named("purpose", PURPOSE.read, data)
        (counts,), data = take(data, 1)
        if counts & 0xF > MAX_EVIDENCE or counts >> 4 > MAX_READINGS:
            raise Refused("counts of %d and %d" % (counts & 0xF, counts >> 4))
        fact["evidence"], data = named("evidence", Array(KNOWN, counts & 0xF).read, data)
        fact["readings"], data = named("readings", Array(U8, counts >> 4).read, data)
        return fact, data


FACT = Seen()
CHOICE = Record(policy=U8, probability=U8)
DIGEST = Array(U8, 4)


def message_of(policies):
    scores = Sequence(Record(delay=U8, price=U8), policies)
    scored = Record(digest=DIGEST, scores=scores)
    decided = Record(digest=DIGEST, scores=Option(scores), choice=Option(CHOICE), step=U16)
    answer = Either(("Listing", U8), ("Scored", scored), ("Decided", decided))
    rounds = Record(proposal=PROPOSAL, fact=FACT, answer=answer)
    return Record(rounds=rounds, waypoints=Sequence(U16, MAX_WAYPOINTS))


# Consistent overhead byte stuffing


def stuff(plain):
    return b"".join(bytes([len(run) + 1]) + run for run in plain.split(b"\0"))


def unstuff(stuffed):
    runs = []
    while stuffed:
        length, rest = stuffed[0] - 1, stuffed[1:]
        if length > len(rest):
            raise Refused("no COBS form")
        runs.append(rest[:length])
        stuffed = rest[length:]
    return b"\0".join(runs)


# Frames


class Team:
    """What robots must share to read each other's frames."""

    def __init__(self, options):
        self.key, self.mission = options.key, options.mission
        self.robots, self.cells, self.policies = options.robots, options.cells, options.policies
        context = LAYOUT.encode() + U32.checked(options.channel).to_bytes(4, "little")
        self.context = fnv1a(context + self.mission.to_bytes(8, "little"))
        self.message = message_of(self.policies)

    def encode(self, text):
        said = json.loads(text)
        if not isinstance(said, dict) or set(said) != {"sender", "epoch", "sequence", "message"}:
            raise Refused("it must have sender, epoch, sequence, message and nothing else")
        message = said.pop("message")
        header, body = HEADER.write(said), self.message.write(message)
        self.check(said["sender"], message)
        if len(body) > 72 + 2 * self.policies:
            raise Refused("a message of %d bytes" % len(body))
        signed = bytes([VERSION]) + header + body
        frame = b"\0" + stuff(signed + self.tag(signed)) + b"\0"
        if len(frame) > MAX_FRAME:
            raise Refused("a frame of %d bytes" % len(frame))
        return frame.hex()

    def decode(self, text):
        said = self.read(bytes.fromhex(text))
        walls = [wall_cells(wall, self.cells) for wall in said["message"]["rounds"]["proposal"]["walls"]]
        return json.dumps({**said, "cells": walls})

    def digest(self, text):
        said = [self.read(bytes.fromhex(frame)) for frame in text.split()]
        said.sort(key=lambda one: one["sender"])
        proposals = [one["message"]["rounds"]["proposal"] for one in said]
        if not said or any(proposal != proposals[0] for proposal in proposals):
            raise Refused("not of one round")
        if sum(1 << one["sender"] for one in said) != proposals[0]["view"]:
            raise Refused("not one frame of each member")
        data = PROPOSAL.write(proposals[0])
        for one in said:
            data += U32.write(one["epoch"]) + FACT.write(one["message"]["rounds"]["fact"])
        return siphash_2_4(self.mission.to_bytes(8, "little") + bytes(8), data)[:4].hex()

    def read(self, frame):
        if frame[:1] != b"\0" or frame[-1:] != b"\0":
            raise Refused("no delimiter at both ends")
        stuffed = frame[1:-1]
        if not stuffed:
            raise Refused("too short")
        if len(stuffed) > MAX_FRAME - 2:
            raise Refused("longer than the longest frame")
        if 0 in stuffed:
            raise Refused("no COBS form")
        plain = unstuff(stuffed)
        signed, tag = plain[:-TAG_BYTES], plain[-TAG_BYTES:]
        if not signed:
            raise Refused("too short")
        if signed[0] != VERSION:
            raise Refused("version %d" % signed[0])
        if len(signed) < 2:
            raise Refused("too short")
        if tag != self.tag(signed):
            raise Refused("wrong tag")
        said, rest = HEADER.read(signed[1:])
        said["message"], rest = self.message.read(rest)
        if rest:
            raise Refused("bytes after the message")
        self.check(said["sender"], said["message"])
        return said

    def tag(self, signed):
        return siphash_2_4(self.key, self.context.to_bytes(8, "little") + signed)

    def check(self, sender, message):
        """What the layout does not say."""
        rounds, waypoints = message["rounds"], message["waypoints"]
        proposal, fact, answer = rounds["proposal"], rounds["fact"], rounds["answer"]
        if sender >= self.robots:
            raise Refused("the sender is not in the team")
        room = MAX_EVIDENCE - -(-len(fact["readings"]) // 2) - len(fact["evidence"])
        if len(waypoints) > room:
            raise Refused("there are more way-points than the frame has room for")
        if proposal["view"] >> self.robots:
            raise Refused("the view has a robot that the team does not have")
        if bin(proposal["view"]).count("1") + len(proposal["walls"]) != self.robots:
            raise Refused("there is not one wall for each robot left out")
        if answer.get("Listing", 0) > self.policies:
            raise Refused("more policies are done than a list can have")
        decided = answer.get("Decided", {})
        if decided.get("choice"):
            scores = decided["scores"]
            if decided["choice"]["policy"] >= (self.policies if scores is None else len(scores)):
                raise Refused("the chosen policy is beyond the end of the list")
        named = waypoints + [fact["anchor"]] + [known["cell"] for known in fact["evidence"]]
        if isinstance(fact["purpose"], dict):
            named += fact["purpose"].values()
        if max(named) >= self.cells:
            raise Refused("a cell is outside this robot's map")


def wall_cells(wall, cells):
    scale, first = min(wall["scale"], 16), 8 * wall["skipped"]
    bits = sum(byte << 8 * at for at, byte in enumerate(wall["bits"])) << first
    return [cell for cell in range(cells) if bits >> (cell >> scale) & 1]


def key(text):
    if len(bytes.fromhex(text)) != 16:
        raise ValueError(text)
    return bytes.fromhex(text)


def main():
    parser = argparse.ArgumentParser(description="Frames of navigating robots.")
    parser.add_argument("command", choices=["encode", "decode", "digest"])
    parser.add_argument("--key", type=key, required=True, help="16 bytes in hexadecimal")
    parser.add_argument("--channel", type=int, default=0)
    parser.add_argument("--mission", type=int, required=True, help="the number of the mission")
    parser.add_argument("--robots", type=int, required=True, help="in the team")
    parser.add_argument("--cells", type=int, required=True, help="of the map")
    parser.add_argument("--policies", type=int, default=16, help="K")
    options = parser.parse_args()
    answer, failed = getattr(Team(options), options.command), False
    for at, line in enumerate(sys.stdin, 1):
        try:
            print(answer(line.strip()))
        except (Refused, ValueError) as reason:
            print("line %d: %s" % (at, reason), file=sys.stderr)
            print()
            failed = True
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
