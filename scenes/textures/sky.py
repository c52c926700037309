#!/usr/bin/env python3
"""Writes sky.exr: light from all around, 160x80 in longitude and latitude, half floats, linear sRGB, not compressed.

A pale sky over a dim ground, and three soft boxes: rectangles in longitude and latitude with soft edges. Rows run from the zenith
to the nadir. A box at longitude 0 lies in -z, one at 90 degrees in +x. Run `python3 sky.py` in this folder to make the file
again; it is the same every time."""
import struct

WIDTH, HEIGHT = 160, 80
ZENITH, HORIZON, GROUND = (0.16, 0.26, 0.48), (0.54, 0.66, 0.86), (0.16, 0.14, 0.12)
# longitude and latitude of the middle, half widths, width of the edge, all in degrees; radiance
BOXES = [((60, 42), (22, 20), 5, (15, 13.5, 11)), ((-115, 30), (8, 26), 4, (7, 8, 10)), ((165, 55), (24, 8), 5, (6, 6, 6))]


def step(x):
    x = min(max(x, 0), 1)
    return x * x * (3 - 2 * x)


def radiance(longitude, latitude):
    up = step(abs(latitude) / 70)
    far = ZENITH if latitude > 0 else GROUND
    haze = step((latitude + 8) / 5)  # between the ground's and the sky's side of the horizon
    near = [g + (h - g) * haze for g, h in zip(GROUND, HORIZON)]
    color = [n + (f - n) * up for n, f in zip(near, far)]
    for (x, y), (half_x, half_y), edge, light in BOXES:
        across = abs((longitude - x + 180) % 360 - 180)
        share = step((half_x - across) / edge + 0.5) * step((half_y - abs(latitude - y)) / edge + 0.5)
        color = [c + (l - c) * share for c, l in zip(color, light)]
    return color


def attribute(name, kind, value):
    return name + b"\0" + kind + b"\0" + struct.pack("<i", len(value)) + value


HALF, LINEAR = 1, 0
channels = b"".join(c + b"\0" + struct.pack("<iB3xii", HALF, LINEAR, 1, 1) for c in (b"B", b"G", b"R")) + b"\0"
window = struct.pack("<iiii", 0, 0, WIDTH - 1, HEIGHT - 1)
header = struct.pack("<ii", 20000630, 2)  # magic number, version
header += attribute(b"channels", b"chlist", channels) + attribute(b"compression", b"compression", b"\0")
header += attribute(b"dataWindow", b"box2i", window) + attribute(b"displayWindow", b"box2i", window)
header += attribute(b"lineOrder", b"lineOrder", b"\0") + attribute(b"pixelAspectRatio", b"float", struct.pack("<f", 1))
header += attribute(b"screenWindowCenter", b"v2f", struct.pack("<ff", 0, 0))
header += attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1)) + b"\0"

rows = []
for j in range(HEIGHT):
    pixels = [radiance(360 * (i + 0.5) / WIDTH, 90 - 180 * j / (HEIGHT - 1)) for i in range(WIDTH)]
    data = b"".join(struct.pack("<%de" % WIDTH, *(p[c] for p in pixels)) for c in (2, 1, 0))
    rows.append(struct.pack("<ii", j, len(data)) + data)
first = len(header) + 8 * HEIGHT
with open("sky.exr", "wb") as out:
    out.write(header + b"".join(struct.pack("<Q", first + j * len(rows[0])) for j in range(HEIGHT)) + b"".join(rows))
