#!/usr/bin/env python3
"""Writes knot.obj: a trefoil knot as a tube with vertex normals. Deterministic; run it to make the file again."""
from math import cos, pi, sin

AROUND, ALONG, RADIUS = 12, 120, 0.13


def curve(t):
    return [(2 + cos(3 * t)) * cos(2 * t) / 3, (2 + cos(3 * t)) * sin(2 * t) / 3, sin(3 * t) / 3]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    length = sum(x * x for x in a) ** 0.5
    return [x / length for x in a]


with open("knot.obj", "w") as out:
    out.write("# A trefoil knot, made by knot.py\n")
    normals = []
    for i in range(ALONG):
        t, h = 2 * pi * i / ALONG, 1e-4
        p = curve(t)
        tangent = unit([b - a for a, b in zip(curve(t - h), curve(t + h))])
        side = unit(cross(tangent, [0, 0, 1]))
        up = cross(side, tangent)
        for j in range(AROUND):
            a = 2 * pi * j / AROUND
            n = [cos(a) * s + sin(a) * u for s, u in zip(side, up)]
            normals.append(n)
            out.write("v %.4f %.4f %.4f\n" % tuple(x + RADIUS * y for x, y in zip(p, n)))
    for n in normals:
        out.write("vn %.3f %.3f %.3f\n" % tuple(n))
    for i in range(ALONG):
        for j in range(AROUND):
            k = (j + 1) % AROUND
            corners = [i * AROUND + j, i * AROUND + k, (i + 1) % ALONG * AROUND + k, (i + 1) % ALONG * AROUND + j]
            out.write("f " + " ".join("%d//%d" % (c + 1, c + 1) for c in corners) + "\n")
