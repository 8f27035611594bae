"""Reads a graded flight and writes an answer to it: poses by readings alone, and covariances that admit it.

    python3 graded_flight.py FLIGHT ANSWER

FLIGHT and ANSWER are folders. It needs nothing but Python.
"""

import math, os, sys, tomllib


# ANCHOR: read
def read(folder):
    """Calibration, readings (nanoseconds, gyroscope, accelerometer) and pictures (nanoseconds, {track: (u, v)})."""
    with open(os.path.join(folder, "calibration.toml"), "rb") as file:
        calibration = tomllib.load(file)
    readings, pictures = [], {}
    for row in rows(os.path.join(folder, "imu.csv")):
        numbers = [float(cell) for cell in row[1:]]
        readings.append((int(row[0]), numbers[:3], numbers[3:]))
    for time, track, u, v, *_ in rows(os.path.join(folder, "tracks.csv")):
        pictures.setdefault(int(time), {})[int(track)] = (float(u), float(v))
    return calibration, readings, sorted(pictures.items())


def rows(path):
    """The cells below the line that names the columns."""
    with open(path, encoding="utf-8") as file:
        return [line.strip().split(",") for line in file if line.strip() and not line.startswith("#")]
# ANCHOR_END: read


# ANCHOR: write
def write(folder, poses):
    """Poses (nanoseconds, position, turn x y z w, 6x6 covariance) in the forms that are graded.

    The covariance is that of a turn in the body, in radians, then of the position in the world, in metres."""
    os.makedirs(folder, exist_ok=True)
    with open(os.path.join(folder, "trajectory.txt"), "w", encoding="utf-8") as trajectory, \
            open(os.path.join(folder, "covariance.txt"), "w", encoding="utf-8") as covariances:
        for nanoseconds, position, turn, covariance in poses:
            time = f"{nanoseconds // 10**9}.{nanoseconds % 10**9:09d}"
            upper = [covariance[row][column] for row in range(6) for column in range(row, 6)]
            print(time, *position, *turn, file=trajectory)
            print(time, *upper, file=covariances)
# ANCHOR_END: write


# ANCHOR: estimate
def estimate(calibration, readings, pictures):
    """Where the body is at each picture by the gyroscope alone; the place is not estimated at all."""
    late = round(1e9 * calibration["camera"]["time_offset"])
    begin = readings[0][0]
    stand = [gyro for time, gyro, _ in readings if time < begin + 1_500_000_000]
    bias = [sum(axis) / len(stand) for axis in zip(*stand)]
    turn, poses, k = [0.0, 0.0, 0.0, 1.0], [], 0
    for time in (time + late for time, _ in pictures):
        while k + 1 < len(readings) and readings[k + 1][0] <= time:
            dt = 1e-9 * (readings[k + 1][0] - readings[k][0])
            turn = turned(turn, [(gyro - off) * dt for gyro, off in zip(readings[k][1], bias)])
            k += 1
        seconds = 1e-9 * (time - begin)
        variances = [1e-3 + 1e-4 * seconds] * 3 + [1e-6 + seconds**4] * 3
        covariance = [[variances[i] if i == j else 0.0 for j in range(6)] for i in range(6)]
        poses.append((time, [0.0, 0.0, 0.0], turn, covariance))
    return poses
# ANCHOR_END: estimate


def turned(q, phi):
    """The turn q, followed by the turn phi of the body in its own frame."""
    angle = math.hypot(*phi)
    size = math.sin(angle / 2) / angle if angle > 0 else 0.5
    (x, y, z, w), (a, b, c), d = q, [size * each for each in phi], math.cos(angle / 2)
    return [w * a + x * d + y * c - z * b, w * b - x * c + y * d + z * a,
            w * c + x * b - y * a + z * d, w * d - x * a - y * b - z * c]


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    write(sys.argv[2], estimate(*read(sys.argv[1])))
