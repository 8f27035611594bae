"""Checks a Jacobian written in Python against the book's, through two files."""

# ANCHOR: notebook
import csv, math, os, random, subprocess

COLUMNS = ["rx", "ry", "rz", "tx", "ty", "tz", "x", "y", "z"]


def by_hand(state):
    """Pixel and point block of a camera that is not turned."""
    x, y, z = (state[3 + k] + state[6 + k] for k in range(3))
    pixel = [400 * x / z + 320, 400 * y / z + 240]
    return pixel, [400 / z, 0, -400 * x / z**2, 0, 400 / z, -400 * y / z**2]


states = [[0, 0, 0] + [random.uniform(-1, 1) for _ in range(5)] + [random.uniform(4, 8)]
          for _ in range(1000)]
os.makedirs("target", exist_ok=True)
with open("target/states.csv", "w", newline="") as file:
    csv.writer(file).writerows([COLUMNS] + states)

subprocess.run(["cargo", "run", "-p", "vislam", "--example", "jacobians", "--",
                "400", "400", "320", "240", "target/states.csv", "target/jacobians.csv"], check=True)

with open("target/jacobians.csv") as file:
    rows = [[float(cell) for cell in row] for row in list(csv.reader(file))[1:]]
# ANCHOR_END: notebook

# ANCHOR: compare
for state, row in zip(states, rows, strict=True):
    pixel, point_block = by_hand(state)
    for mine, theirs in zip(pixel + point_block, row[:2] + row[14:], strict=True):
        assert math.isclose(mine, theirs, rel_tol=1e-9, abs_tol=1e-9), (state, mine, theirs)
print(f"{len(rows)} states agree")
# ANCHOR_END: compare
