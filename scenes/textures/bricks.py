#!/usr/bin/env python3
"""Writes bricks.png (colours, sRGB) and bricks-normal.png (normal map): a running bond of 3 x 8 bricks, 256x256, seamless.

A brick is 1/3 of the tile long and 1/8 high, mortar included. The height of the surface is that of the mortar plus that of the
brick, which rises over a rounded edge, leans a little, and is rough (two octaves of value noise). The normal is that of the
height field, from differences of neighbouring pixels. Run `python3 bricks.py` in this folder to make both files again; they
are the same every time."""
from random import Random

from png import normal_color, write_png

SIZE, COLUMNS, COURSES = 256, 3, 8
MORTAR = 2.2      # half its width, pixels
EDGE = 3.5        # over which a brick rises, pixels
RISE = 5.0        # of a brick over the mortar, pixels

random = Random(11)


def noise_table(cells):
    return [[random.random() for _ in range(cells)] for _ in range(cells)]


def noise(table, x, y):
    """Value noise in [0, 1) at (x, y) in pixels, seamless."""
    cells = len(table)
    x, y = x * cells / SIZE, y * cells / SIZE
    i, j = int(x) % cells, int(y) % cells
    u, v = x - int(x), y - int(y)
    u, v = u * u * (3 - 2 * u), v * v * (3 - 2 * v)
    k, l = (i + 1) % cells, (j + 1) % cells
    below = table[j][i] * (1 - u) + table[j][k] * u
    above = table[l][i] * (1 - u) + table[l][k] * u
    return below * (1 - v) + above * v


coarse, fine, stain = noise_table(32), noise_table(96), noise_table(12)
bricks = [[{"shade": random.random(), "warmth": random.random(), "lean_x": random.uniform(-1, 1),
            "lean_y": random.uniform(-1, 1)} for _ in range(COLUMNS)] for _ in range(COURSES)]


def surface(x, y):
    """Height in pixels at the middle of pixel (x, y), y upwards; share of brick in it; the brick."""
    length, high = SIZE / COLUMNS, SIZE / COURSES
    course = y * COURSES // SIZE
    along = (x + 0.5 - (course % 2) * length / 2) % SIZE
    column = int(along / length) % COLUMNS
    s, t = along - column * length - length / 2, y + 0.5 - course * high - high / 2
    wobble = 1.2 * (noise(coarse, x, y) - 0.5)
    inside = min(length / 2 - abs(s), high / 2 - abs(t)) - MORTAR + wobble
    share = min(max(inside / EDGE, 0), 1)
    rise = 1 - (1 - share) * (1 - share)  # steep at the mortar, rounded at the top
    brick = bricks[course][column]
    rough = 1.5 * noise(coarse, x, y) + 0.6 * noise(fine, x, y)
    lean = 0.9 * (brick["lean_x"] * s / length + brick["lean_y"] * t / high)
    return rise * (RISE + lean) + rough * (0.5 + 0.5 * rise), share, brick


def color(x, y, share, brick):
    grain = 0.88 + 0.17 * noise(fine, x, y) + 0.12 * noise(stain, x, y)
    dark = 0.72 + 0.38 * brick["shade"]
    fired = (172 * dark, (82 + 22 * brick["warmth"]) * dark, (60 + 18 * brick["warmth"]) * dark)
    mortar = (176, 170, 158)
    mix = min(1.5 * share, 1)
    return tuple(4 * int(min(grain * (m + (f - m) * mix), 255) / 4) for f, m in zip(fired, mortar))


field = [[surface(x, y) for x in range(SIZE)] for y in range(SIZE)]
colors, normals = [], []
for y in reversed(range(SIZE)):  # the top row has the largest y
    colors.append([color(x, y, field[y][x][1], field[y][x][2]) for x in range(SIZE)])
    row = []
    for x in range(SIZE):
        slope_x = (field[y][(x + 1) % SIZE][0] - field[y][x - 1][0]) / 2
        slope_y = (field[(y + 1) % SIZE][x][0] - field[y - 1][x][0]) / 2
        row.append(normal_color(-slope_x, -slope_y, 1))
    normals.append(row)
write_png("bricks.png", colors)
write_png("bricks-normal.png", normals)
