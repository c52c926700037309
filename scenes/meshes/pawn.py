#!/usr/bin/env python3
"""Writes pawn.obj: a chess pawn, turned on a lathe, closed, standing on y = 0. No normals: the reader computes them.

The profile (radius, height) is made of arcs, one cubic Bezier curve for the waist, and lines. Run `python3 pawn.py` in this
folder to make the file again; it is the same every time."""
from math import acos, cos, degrees, pi, radians, sin

AROUND = 48


def arc(x, y, r, begin, end, segments):
    angles = [radians(begin + (end - begin) * i / segments) for i in range(segments + 1)]
    return [(x + r * cos(a), y + r * sin(a)) for a in angles]


def bezier(p, segments):
    def at(t, k):
        s = 1 - t
        return s * s * s * p[0][k] + 3 * s * s * t * p[1][k] + 3 * s * t * t * p[2][k] + t * t * t * p[3][k]
    return [(at(i / segments, 0), at(i / segments, 1)) for i in range(segments + 1)]


NECK, HEAD = 0.17, 0.29
profile = [(0.0, 0.0), (0.42, 0.0)]
profile += arc(0.46, 0.06, 0.06, -90, 90, 6)  # foot
profile += arc(0.40, 0.18, 0.06, -90, 60, 5)  # ring
profile += bezier([(0.42, 0.25), (0.25, 0.36), (NECK + 0.02, 0.70), (NECK, 0.98)], 14)
profile += [(0.25, 0.983)] + arc(0.30, 1.015, 0.032, -90, 90, 6) + [(0.25, 1.047)]  # collar
profile += arc(0.0, 1.30, HEAD, -degrees(acos(NECK / HEAD)), 90, 16)[:-1] + [(0.0, 1.30 + HEAD)]

with open("pawn.obj", "w") as out:
    out.write("# A chess pawn, made by pawn.py\n")
    out.write("v 0 %.4f 0\nv 0 %.4f 0\n" % (profile[0][1], profile[-1][1]))
    rings = profile[1:-1]
    for r, y in rings:
        for j in range(AROUND):
            a = 2 * pi * j / AROUND
            out.write("v %.4f %.4f %.4f\n" % (r * cos(a), y, -r * sin(a)))
    for j in range(AROUND):
        k = (j + 1) % AROUND
        out.write("f 1 %d %d\n" % (3 + k, 3 + j))
        for i in range(len(rings) - 1):
            a, b = 3 + i * AROUND, 3 + (i + 1) * AROUND
            out.write("f %d %d %d %d\n" % (a + j, a + k, b + k, b + j))
        b = 3 + (len(rings) - 1) * AROUND
        out.write("f 2 %d %d\n" % (b + j, b + k))
