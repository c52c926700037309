#!/usr/bin/env python3
"""Writes diamond.obj: a round brilliant with the proportions of Tolkowsky (1919), 57 facets and a girdle of 16, closed, flat.

The girdle has radius 1 and stands in y = 0 .. GIRDLE; the table faces +y, the culet is the point below. Eight kites of the
crown and eight of the pavilion are planes y = +-(1 - r cos(azimuth - 45 k degrees)) tan(angle), which fixes the heights of the
corners where neighbours meet; all other facets are triangles between corners. Run `python3 diamond.py` in this folder to make
the file again; it is the same every time."""
from math import cos, pi, radians, sin, tan

TABLE = 0.53                # diameter of the table over that of the girdle, corner to corner
CROWN = radians(34.5)       # slope of the crown's kites
PAVILION = radians(40.75)   # slope of the pavilion's kites
GIRDLE = 0.03               # height; Tolkowsky leaves it open
STAR = 0.5                  # the stars' share of the way from the table's edge to the girdle; likewise
LOWER = 0.77                # the lower halves' share of the way from the girdle to the culet; likewise

STEP = pi / 8
corners, facets = [], []


def ring(count, first, radius, y):
    """Corners at azimuths (first + 2 i) or, for 16 of them, i steps of 22.5 degrees; their indices."""
    stride = 16 // count
    for i in range(count):
        a = STEP * (first + stride * i)
        corners.append((radius * sin(a), y, radius * cos(a)))
    return list(range(len(corners) - count, len(corners)))


edge = TABLE * cos(STEP)  # from the axis to the middle of the table's edge
star = edge + STAR * (1 - edge)
lower = 1 - LOWER
table = ring(8, 0, TABLE, GIRDLE + (1 - TABLE) * tan(CROWN))
stars = ring(8, 1, star, GIRDLE + (1 - star * cos(STEP)) * tan(CROWN))
above = ring(16, 0, 1, GIRDLE)
below = ring(16, 0, 1, 0)
lowers = ring(8, 1, lower, -(1 - lower * cos(STEP)) * tan(PAVILION))
corners.append((0, -tan(PAVILION), 0))
culet = len(corners) - 1

facets += [table[0:4], [table[i] for i in (0, 3, 4, 7)], table[4:8]]  # the table, an octagon in three parts
for k in range(8):
    n = (k + 1) % 8
    a, b, c = 2 * k, 2 * k + 1, (2 * k + 2) % 16
    facets.append([table[k], stars[k - 1], above[a], stars[k]])    # kite of the crown
    facets.append([table[n], table[k], stars[k]])                  # star
    facets.append([stars[k], above[a], above[b]])                  # upper halves
    facets.append([stars[k], above[b], above[c]])
    facets.append([above[a], below[a], below[b], above[b]])        # girdle
    facets.append([above[b], below[b], below[c], above[c]])
    facets.append([lowers[k], below[b], below[a]])                 # lower halves
    facets.append([lowers[k], below[c], below[b]])
    facets.append([culet, lowers[k], below[a], lowers[k - 1]])     # kite of the pavilion

with open("diamond.obj", "w") as out:
    out.write("# A round brilliant, made by diamond.py\n")
    for corner in corners:
        out.write("v %.7f %.7f %.7f\n" % corner)
    for facet in facets:
        out.write("f " + " ".join(str(i + 1) for i in facet) + "\n")
