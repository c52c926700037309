"""Writes an 8-bit PNG file with three channels: rows from top to bottom, each a list of (red, green, blue) in 0 .. 255."""
import struct
import zlib


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def filtered(row, before):
    """The row, each byte less the one to its left (filter 1) or above (filter 2): the one of smaller residuals."""
    left = bytes((x - (row[i - 3] if i >= 3 else 0)) & 255 for i, x in enumerate(row))
    up = bytes((x - y) & 255 for x, y in zip(row, before))
    cost = [sum(min(x, 256 - x) for x in residual) for residual in (left, up)]
    return b"\x01" + left if cost[0] <= cost[1] else b"\x02" + up


def write_png(name, rows):
    lines, before = [], bytes(3 * len(rows[0]))
    for row in rows:
        line = bytes(c for pixel in row for c in pixel)
        lines.append(filtered(line, before))
        before = line
    header = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 2, 0, 0, 0)
    with open(name, "wb") as out:
        out.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(b"".join(lines), 9)) +
                  chunk(b"IEND", b""))


def normal_color(x, y, z):
    """The colour of a normal in its tangent frame: (n + 1) / 2."""
    length = (x * x + y * y + z * z) ** 0.5
    return tuple(int(127.5 * (c / length + 1) + 0.5) for c in (x, y, z))
