"""The samples and scenes of robust_two_view.rs in PoseLib: microseconds of a solve, errors and times of the motions.

usage: robust_two_view_poselib.py FILE

The lines of the file are: `camera`, fx fy cx cy and the gate in pixels; `sample`, five pairs of rays; `scene`, the true
motion as a quaternion w x y z and a translation, and pairs of pixels.
"""
import sys
import time

import numpy as np
import poselib

samples, scenes = [], []
for line in open(sys.argv[1]):
    kind, *numbers = line.split()
    numbers = np.array(numbers, dtype=float)
    if kind == "camera":
        camera, gate = numbers[:4], numbers[4]
    elif kind == "sample":
        rays = numbers.reshape(5, 2, 3)
        rays /= np.linalg.norm(rays, axis=2, keepdims=True)
        samples.append((rays[:, 0].copy(), rays[:, 1].copy()))
    else:
        pixels = numbers[7:].reshape(-1, 2, 2)
        scenes.append((numbers[:4], numbers[4:7], pixels[:, 0].copy(), pixels[:, 1].copy()))


def microseconds(solve):
    least = float("inf")
    for _ in range(20):
        start = time.perf_counter()
        for first, second in samples:
            solve(first, second)
        least = min(least, time.perf_counter() - start)
    return 1e6 * least / len(samples)


def rotation(q):
    w, x, y, z = q
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ])


def degrees_off(pose, q, t):
    cosine = (np.trace(pose.R.T @ rotation(q)) - 1) / 2
    turn = np.degrees(np.arccos(np.clip(cosine, -1, 1)))
    found = pose.t / np.linalg.norm(pose.t)
    tilt = np.degrees(np.arctan2(np.linalg.norm(np.cross(found, t)), found @ t))
    return max(turn, tilt)


# A solver that does next to nothing: what the call itself costs.
call = microseconds(lambda first, second: poselib.relpose_upright_planar_2pt(first, second))
print(f"poselib.call_us {call}")
print(f"poselib.all_us {microseconds(poselib.essential_matrix_5pt)}")
print(f"poselib.front_us {microseconds(poselib.relpose_5pt)}")
model = {"model": "PINHOLE", "width": 640, "height": 480, "params": list(camera)}
errors, seconds, draws = [], 0.0, 0
for seed, (q, t, first, second) in enumerate(scenes):
    options = {"max_epipolar_error": gate, "success_prob": 0.9999, "seed": seed, "max_iterations": 100000}
    least = float("inf")
    for _ in range(2):
        start = time.perf_counter()
        pose, info = poselib.estimate_relative_pose(first, second, model, model, options, {})
        least = min(least, time.perf_counter() - start)
    seconds, draws = seconds + least, draws + info["iterations"]
    errors.append(degrees_off(pose, q, t))
median, most = np.quantile(errors, [0.5, 0.95])
print(f"poselib.median {median}")
print(f"poselib.most {most}")
print(f"poselib.ms {1e3 * seconds / len(scenes)}")
print(f"poselib.draws {draws / len(scenes)}")
