"""The incremental mapper of COLMAP on a list of matches, as `reconstruct --matches FILE` writes it.

usage: reconstruct_pycolmap.py FILE [CENTRES]

Equal pixels of a picture are one keypoint. Matches are verified by COLMAP pair by pair, with the intrinsics given, and
the mapper leaves these as they are. The last line is that of `reconstruct`: the costs over the sightings of its own points,
in undistorted pixels. Written for pycolmap 4.2.
"""
import sys
import tempfile
import time
from collections import defaultdict
from pathlib import Path

import numpy as np
import pycolmap

cameras, keypoints, numbers, matches = [], [], [], defaultdict(set)
for line in open(sys.argv[1]):
    if line.startswith("camera"):
        cameras.append([float(x) for x in line.split()[1:]])
        keypoints.append([])
        numbers.append({})
        continue
    a, u, v, b, s, t = line.split()
    ends = []
    for picture, x, y in ((int(a), u, v), (int(b), s, t)):
        known = numbers[picture]
        if (x, y) not in known:
            known[x, y] = len(known)
            keypoints[picture].append((float(x), float(y)))
        ends.append((picture, known[x, y]))
    (a, i), (b, j) = sorted(ends)
    matches[a, b].add((i, j))

# COLMAP wants pixels inside the picture.
size = [np.ceil(np.abs(np.array(points)).max(axis=0)) + 1 for points in keypoints]
folder = Path(tempfile.mkdtemp())
database = pycolmap.Database.open(folder / "database.db")
for number, (fx, fy, cx, cy) in enumerate(cameras):
    width, height = (int(2 * x) for x in size[number])
    parameters = [fx, fy, cx + width / 2, cy + height / 2]
    camera = pycolmap.Camera(
        camera_id=number + 1, model="PINHOLE", width=width, height=height, params=parameters
    )
    camera.has_prior_focal_length = True
    database.write_camera(camera, use_camera_id=True)
    rig = pycolmap.Rig(rig_id=number + 1)
    rig.add_ref_sensor(camera.sensor_id)
    database.write_rig(rig, use_rig_id=True)
    image = pycolmap.Image(name=f"{number:04}.png", camera_id=number + 1, image_id=number + 1)
    frame = pycolmap.Frame(frame_id=number + 1, rig_id=number + 1)
    frame.add_data_id(image.data_id)
    database.write_frame(frame, use_frame_id=True)
    image.frame_id = number + 1
    database.write_image(image, use_image_id=True)
    shifted = np.array(keypoints[number]) + size[number].astype(int)
    database.write_keypoints(number + 1, shifted.astype(np.float32))
with open(folder / "pairs.txt", "w") as pairs:
    for (a, b), found in sorted(matches.items()):
        database.write_matches(a + 1, b + 1, np.array(sorted(found), dtype=np.uint32))
        pairs.write(f"{a:04}.png {b:04}.png\n")
database.close()

began = time.perf_counter()
pycolmap.verify_matches(folder / "database.db", folder / "pairs.txt")
options = pycolmap.IncrementalPipelineOptions()
options.ba_refine_focal_length = False
options.ba_refine_principal_point = False
options.ba_refine_extra_params = False
options.extract_colors = False
(folder / "out").mkdir()
maps = pycolmap.incremental_mapping(folder / "database.db", folder, folder / "out", options)
seconds = time.perf_counter() - began
best = max(maps.values(), key=lambda found: found.num_reg_images()) if maps else None
if best is None:
    print(f"registered 0  of {len(cameras)}  truncated nan  cost nan  centres_percent nan  seconds {seconds:.2f}")
    sys.exit()
squares = []
for image in best.images.values():
    if not image.has_pose:
        continue
    for point in image.points2D:
        if point.has_point3D():
            pixel = image.project_point(best.points3D[point.point3D_id].xyz)
            squares.append(16.0 if pixel is None else float(np.sum((pixel - point.xy) ** 2)))
squares = np.array(squares)
percent = float("nan")
if len(sys.argv) > 2:
    # As `reconstruct --centres` writes them, by picture.
    truth = np.loadtxt(sys.argv[2])
    own, other = [], []
    for image in best.images.values():
        if image.has_pose:
            own.append(image.projection_center())
            other.append(truth[int(image.name[:4])])
    own, other = np.array(own), np.array(other)
    a, b = own - own.mean(0), other - other.mean(0)
    u, s, vt = np.linalg.svd(b.T @ a)
    sign = np.diag([1, 1, np.sign(np.linalg.det(u @ vt))])
    rotation = u @ sign @ vt
    scale = np.trace(np.diag(s) @ sign) / np.sum(a * a)
    off = np.linalg.norm(scale * a @ rotation.T - b, axis=1)
    extent = max(np.linalg.norm(x - y) for x in other for y in other)
    percent = 100 * off.max() / extent
print(f"{best.num_points3D()} points")
print(
    f"registered {best.num_reg_images()}  of {len(cameras)}  truncated {0.5 * np.minimum(squares, 16).sum():.2f}  "
    f"cost {0.5 * squares.sum():.2f}  centres_percent {percent:.4f}  seconds {seconds:.2f}"
)
