#!/usr/bin/env python3
"""Writes sweep.obj: the ground of a photographer's studio, which bends up into a wall without an edge. No normals: the reader
computes them.

Ground at y = 0 from z = 10 back to z = -2, a quarter circle of radius 3, a wall at z = -5 up to y = 9; 24 wide. Run
`python3 sweep.py` in this folder to make the file again; it is the same every time."""
from math import cos, pi, sin

RADIUS, SEGMENTS, HALF_WIDTH = 3.0, 24, 12.0

profile = [(10.0, 0.0)]
for i in range(SEGMENTS + 1):
    a = pi / 2 * i / SEGMENTS
    profile.append((-2 - RADIUS * sin(a), RADIUS - RADIUS * cos(a)))
profile.append((-5.0, 9.0))

with open("sweep.obj", "w") as out:
    out.write("# The ground and the wall of a studio, made by sweep.py\n")
    for z, y in profile:
        for x in (-HALF_WIDTH, HALF_WIDTH):
            out.write("v %.4f %.4f %.4f\n" % (x, y, z))
    for i in range(len(profile) - 1):
        k = 2 * i + 1
        out.write("f %d %d %d %d\n" % (k, k + 1, k + 3, k + 2))
