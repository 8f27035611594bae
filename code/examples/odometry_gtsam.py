"""The batch of a flight in GTSAM 4.3: errors, seconds and cost.

usage: odometry_gtsam.py TRACKS_CSV GROUNDTRUTH_CSV FROM_SECONDS EVERY GATE_PIXELS [EXPORT_JSON]

TRACKS_CSV has readings and tracks in one file, as GTSAM's examples have them; GROUNDTRUTH_CSV is EuRoC's. There is a
state at every EVERY-th picture from FROM_SECONDS on, with combined inertial factors between the states, and a projection
with Huber's kernel for each time that a landmark is seen. The ground truth gives the start, some centimetres and half a
degree off, and chooses the landmarks: it is a help that an estimator does not have. A landmark is kept when three states
or more see it, 0.2 m or more in front of each and less than 40 m in front of the nearest, and no pixel is farther off than the gate from where the ground
truth would have it.

Prints the root mean square error of the positions in centimetres, aligned by yaw and shift and by any rotation and shift;
the least seconds of three searches; their cost; and how many states, landmarks and iterations there are. EXPORT_JSON
receives the same problem and its solution as `odometry.rs --start` reads it.
"""
import csv
import json
import sys
import time
from collections import defaultdict

import gtsam
import numpy as np
from gtsam.symbol_shorthand import B, L, V, X

GRAVITY, HUBER, PIXEL = 9.81, 1.345, 1.0 / 458.0
DENSITIES = {"gyro": 1.6968e-4, "accelerometer": 2.0e-3, "gyro_walk": 1.9393e-5, "accelerometer_walk": 3.0e-3}
POSE_SIGMAS, VELOCITY_SIGMA, BIAS_SIGMAS = [0.05, 0.05] + [1e-4] * 4, 0.1, [0.3] * 3 + [0.15] * 3


class Flight:
    """Readings, pictures and the truth by seconds since the file begins."""

    def __init__(self, tracks_path, truth_path):
        meta, readings, self.tracks, self.times = {}, [], defaultdict(dict), {}
        with open(tracks_path) as file:
            for row in csv.DictReader(file):
                if row["row_type"] == "meta":
                    meta[row["key"]] = row["value"]
                elif row["row_type"] == "imu":
                    readings.append([float(row[name]) for name in ("t_rel", "gx", "gy", "gz", "ax", "ay", "az")])
                else:
                    picture, track = int(row["frame_idx"]), int(row["landmark_id"])
                    self.times[picture] = float(row["t_rel"])
                    self.tracks[picture][track] = np.array([float(row["u_norm"]), float(row["v_norm"])])
        self.readings = np.array(readings)
        turn = gtsam.Rot3.Quaternion(*(float(meta["T_ci_q" + axis]) for axis in "wxyz"))
        self.body_from_camera = gtsam.Pose3(turn, np.array([float(meta["T_ci_t" + axis]) for axis in "xyz"]))
        begin = int(round(float(meta["t0_abs"]) * 1e9))
        with open(truth_path) as file:
            rows = [line.split(",") for line in file if not line.startswith("#")]
        self.truth_times = np.array([1e-9 * (int(row[0]) - begin) for row in rows])
        self.truth_rows = np.array([[float(number) for number in row[1:]] for row in rows])

    def truth(self, seconds):
        """Pose, velocity and biases of the row that is nearest in time."""
        row = self.truth_rows[np.argmin(np.abs(self.truth_times - seconds))]
        pose = gtsam.Pose3(gtsam.Rot3.Quaternion(*row[3:7]), row[:3])
        return pose, row[7:10], gtsam.imuBias.ConstantBias(row[13:16], row[10:13])


def diagonal(sigmas):
    return gtsam.noiseModel.Diagonal.Sigmas(np.asarray(sigmas, dtype=float))


def inertial_parameters():
    parameters = gtsam.PreintegrationCombinedParams.MakeSharedU(GRAVITY)
    parameters.setGyroscopeCovariance(np.eye(3) * DENSITIES["gyro"] ** 2)
    parameters.setAccelerometerCovariance(np.eye(3) * DENSITIES["accelerometer"] ** 2)
    parameters.setIntegrationCovariance(np.eye(3) * 1e-10)
    parameters.setBiasOmegaCovariance(np.eye(3) * DENSITIES["gyro_walk"] ** 2)
    parameters.setBiasAccCovariance(np.eye(3) * DENSITIES["accelerometer_walk"] ** 2)
    return parameters


class Batch:
    def __init__(self, flight, pictures, gate):
        self.flight, self.pictures = flight, pictures
        self.truth = [flight.truth(flight.times[picture]) for picture in pictures]
        self.graph, self.start, self.sightings = gtsam.NonlinearFactorGraph(), gtsam.Values(), {}
        for k, (pose, velocity, bias) in enumerate(self.truth):
            self.start.insert(X(k), pose)
            self.start.insert(V(k), velocity)
            self.start.insert(B(k), bias)
        self.add_priors()
        self.add_readings()
        self.add_landmarks(gate)
        self.shake()

    def add_priors(self):
        pose, velocity, _ = self.truth[0]
        self.graph.add(gtsam.PriorFactorPose3(X(0), pose, diagonal(POSE_SIGMAS)))
        self.graph.add(gtsam.PriorFactorVector(V(0), velocity, diagonal([VELOCITY_SIGMA] * 3)))
        nothing = gtsam.imuBias.ConstantBias(np.zeros(3), np.zeros(3))
        self.graph.add(gtsam.PriorFactorConstantBias(B(0), nothing, diagonal(BIAS_SIGMAS)))

    def add_readings(self):
        parameters, times = inertial_parameters(), self.flight.readings[:, 0]
        for k in range(1, len(self.pictures)):
            begin, end = (self.flight.times[self.pictures[at]] for at in (k - 1, k))
            inside = self.flight.readings[(times >= begin - 1e-4) & (times < end - 1e-4)]
            sums = gtsam.PreintegratedCombinedMeasurements(parameters, self.truth[k][2])
            for reading, until in zip(inside, [*inside[1:, 0], end]):
                sums.integrateMeasurement(reading[4:], reading[1:4], until - reading[0])
            self.graph.add(gtsam.CombinedImuFactor(X(k - 1), V(k - 1), X(k), V(k), B(k - 1), B(k), sums))

    def add_landmarks(self, gate):
        seen = defaultdict(list)
        for k, picture in enumerate(self.pictures):
            for track, pixel in self.flight.tracks[picture].items():
                seen[track].append((k, pixel))
        huber = gtsam.noiseModel.mEstimator.Huber.Create(HUBER)
        noise = gtsam.noiseModel.Robust.Create(huber, gtsam.noiseModel.Isotropic.Sigma(2, PIXEL))
        lens, mounting = gtsam.Cal3_S2(1.0, 1.0, 0.0, 0.0, 0.0), self.flight.body_from_camera
        for track, sightings in seen.items():
            point = self.place(sightings, gate * PIXEL, lens) if len(sightings) > 2 else None
            if point is None:
                continue
            self.sightings[track] = sightings
            self.start.insert(L(track), point)
            for k, pixel in sightings:
                self.graph.add(gtsam.GenericProjectionFactorCal3_S2(pixel, noise, X(k), L(track), lens, mounting))

    def place(self, sightings, gate, lens):
        """Where the rays of a track meet, if all cameras see it near enough to where they did."""
        poses = [self.truth[k][0].compose(self.flight.body_from_camera) for k, _ in sightings]
        cameras = gtsam.CameraSetCal3_S2([gtsam.PinholeCameraCal3_S2(pose, lens) for pose in poses])
        try:
            point = gtsam.triangulatePoint3(cameras, [pixel for _, pixel in sightings], 1e-9, False)
        except RuntimeError:
            return None
        local = np.array([pose.transformTo(point) for pose in poses])
        if not 0.2 < local[:, 2].min() < 40.0:
            return None
        off = local[:, :2] / local[:, 2:] - np.array([pixel for _, pixel in sightings])
        return point if np.linalg.norm(off, axis=1).max() <= gate else None

    def shake(self):
        """Moves the start away from the truth."""
        random = np.random.default_rng(1)
        for k in range(1, len(self.pictures)):
            step = random.normal(0.0, [0.01] * 3 + [0.03] * 3)
            self.start.update(X(k), self.start.atPose3(X(k)).retract(step))
            self.start.update(V(k), self.start.atVector(V(k)) + random.normal(0.0, 0.05, 3))

    def solve(self):
        parameters, least = gtsam.LevenbergMarquardtParams(), float("inf")
        parameters.setMaxIterations(60)
        for _ in range(3):
            begin = time.perf_counter()
            search = gtsam.LevenbergMarquardtOptimizer(self.graph, self.start, parameters)
            values = search.optimize()
            least = min(least, time.perf_counter() - begin)
        return values, least, search.iterations()

    def error(self, values, freedom):
        """The root mean square of the distances that an alignment leaves, in centimetres."""
        estimate = np.array([values.atPose3(X(k)).translation() for k in range(len(self.pictures))])
        truth = np.array([pose.translation() for pose, _, _ in self.truth])
        a, b = estimate - estimate.mean(axis=0), truth - truth.mean(axis=0)
        moment = b.T @ a
        if freedom == 4:
            turn = gtsam.Rot3.Yaw(np.arctan2(moment[1, 0] - moment[0, 1], moment[0, 0] + moment[1, 1])).matrix()
        else:
            left, _, right = np.linalg.svd(moment)
            turn = left @ np.diag([1.0, 1.0, np.linalg.det(left @ right)]) @ right
        return 100.0 * np.sqrt(((a @ turn.T - b) ** 2).sum(axis=1).mean())

    def exported(self, values):
        def state(values, k):
            pose, bias = values.atPose3(X(k)), values.atConstantBias(B(k))
            q = pose.rotation().toQuaternion()
            return {"world_from_body_wxyz": [q.w(), q.x(), q.y(), q.z()], "position": pose.translation().tolist(),
                    "velocity": values.atVector(V(k)).tolist(),
                    "bias_accelerometer": bias.accelerometer().tolist(), "bias_gyroscope": bias.gyroscope().tolist()}

        def landmark(track, sightings):
            return {"start": self.start.atPoint3(L(track)).tolist(), "batch": values.atPoint3(L(track)).tolist(),
                    "seen": [[k, *pixel.tolist()] for k, pixel in sightings]}

        states = range(len(self.pictures))
        prior = {"pose_sigmas_rotation_then_position": POSE_SIGMAS, "velocity_sigma": VELOCITY_SIGMA,
                 "bias_sigmas_accelerometer_then_gyroscope": BIAS_SIGMAS}
        return {"times": [self.flight.times[picture] for picture in self.pictures], "frames": self.pictures,
                "densities": DENSITIES, "sigma_normalized": PIXEL, "huber": HUBER, "gravity": GRAVITY, "prior": prior,
                "start": [state(self.start, k) for k in states], "batch": [state(values, k) for k in states],
                "landmarks": {str(track): landmark(track, seen) for track, seen in self.sightings.items()},
                "cost": self.graph.error(values)}


def main(tracks_path, truth_path, begin, every, gate, export=None):
    flight = Flight(tracks_path, truth_path)
    pictures = [picture for picture in sorted(flight.times) if flight.times[picture] >= float(begin) - 1e-6]
    batch = Batch(flight, pictures[:: int(every)], float(gate))
    values, seconds, iterations = batch.solve()
    counts = len(batch.pictures), len(batch.sightings), iterations
    print(batch.error(values, 4), batch.error(values, 6), seconds, batch.graph.error(values), *counts)
    if export:
        with open(export, "w") as file:
            json.dump(batch.exported(values), file)


if __name__ == "__main__":
    main(*sys.argv[1:])
