#!/usr/bin/env python3
"""Writes hammered.png: the normal map of hammered metal, 256x256, seamless.

Dents are paraboloids around points of a jittered grid; the height is their lower envelope, softened where two meet:
h = -S log(sum over the points of exp(-|p - p_i|^2 / S)), so that the gradient is the mean of 2 (p - p_i) with these weights.
Lengths in grid cells. Run `python3 hammered.py` in this folder to make the file again; it is the same every time."""
from math import exp
from random import Random

from png import normal_color, write_png

SIZE, CELLS, JITTER, SOFT, DEPTH = 256, 9, 0.36, 0.05, 0.13

random = Random(7)
points = [[(x + 0.5 + JITTER * (2 * random.random() - 1), y + 0.5 + JITTER * (2 * random.random() - 1))
           for x in range(CELLS)] for y in range(CELLS)]

rows = []
for j in range(SIZE):
    y = CELLS * (1 - (j + 0.5) / SIZE)  # the top row has the largest y
    row = []
    for i in range(SIZE):
        x = CELLS * (i + 0.5) / SIZE
        near = []
        for b in range(int(y) - 2, int(y) + 3):
            for a in range(int(x) - 2, int(x) + 3):
                px, py = points[b % CELLS][a % CELLS]
                near.append((x - px - (a - a % CELLS), y - py - (b - b % CELLS)))
        least = min(u * u + v * v for u, v in near)
        weights = [exp((least - u * u - v * v) / SOFT) for u, v in near]
        total = sum(weights)
        slope_x = 2 * sum(w * u for w, (u, v) in zip(weights, near)) / total
        slope_y = 2 * sum(w * v for w, (u, v) in zip(weights, near)) / total
        row.append(normal_color(-DEPTH * slope_x, -DEPTH * slope_y, 1))
    rows.append(row)
write_png("hammered.png", rows)
