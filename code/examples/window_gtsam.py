"""The window of window.rs in GTSAM: the least time of an iteration, and twice the cost at the end.

usage: window_gtsam.py WINDOW_CSV

The file is written by the record `window_speed`. Its lines are: `state`, a quaternion w x y z, position, velocity;
`bias`, gyroscope and accelerometer, of all states; `extrinsics`, the camera on the body; `noise`, the densities of
gyroscope, accelerometer and their walks; `camera`, fx fy cx cy and the sigma of a pixel; `sigmas`, of the first
state's turns, velocity and position and of the first bias; `landmark`, x y z; `pixel`, state, landmark, u, v;
`reading`, interval, seconds, gyroscope, accelerometer. Calibration, clock and gravity are known.
"""
import csv
import sys
import time
from collections import defaultdict

import gtsam
import numpy as np
from gtsam.symbol_shorthand import B, L, V, X

lines = defaultdict(list)
for kind, *numbers in csv.reader(open(sys.argv[1])):
    lines[kind].append(np.array([float(number) for number in numbers]))


def pose(numbers):
    return gtsam.Pose3(gtsam.Rot3.Quaternion(*numbers[:4]), numbers[4:7])


def diagonal(sigmas):
    return gtsam.noiseModel.Diagonal.Sigmas(np.asarray(sigmas))


gyro, accelerometer, gyro_walk, accelerometer_walk = lines["noise"][0]
*intrinsics, pixel_sigma = lines["camera"][0]
calibration = gtsam.Cal3_S2(intrinsics[0], intrinsics[1], 0.0, intrinsics[2], intrinsics[3])
sigmas, extrinsics = lines["sigmas"][0], pose(lines["extrinsics"][0])
bias = gtsam.imuBias.ConstantBias(lines["bias"][0][3:], lines["bias"][0][:3])

values, graph = gtsam.Values(), gtsam.NonlinearFactorGraph()
for k, state in enumerate(lines["state"]):
    values.insert(X(k), pose(state))
    values.insert(V(k), state[7:])
    values.insert(B(k), bias)
for k, point in enumerate(lines["landmark"]):
    values.insert(L(k), point)
noise = gtsam.noiseModel.Isotropic.Sigma(2, pixel_sigma)
for state, landmark, u, v in lines["pixel"]:
    graph.add(gtsam.GenericProjectionFactorCal3_S2(
        np.array([u, v]), noise, X(int(state)), L(int(landmark)), calibration, extrinsics))

parameters = gtsam.PreintegrationCombinedParams.MakeSharedU(9.81)
parameters.setGyroscopeCovariance(np.eye(3) * gyro**2)
parameters.setAccelerometerCovariance(np.eye(3) * accelerometer**2)
parameters.setIntegrationCovariance(np.zeros((3, 3)))
parameters.setBiasOmegaCovariance(np.eye(3) * gyro_walk**2)
parameters.setBiasAccCovariance(np.eye(3) * accelerometer_walk**2)
for k in range(len(lines["state"]) - 1):
    sums = gtsam.PreintegratedCombinedMeasurements(parameters, bias)
    for _, seconds, *reading in (line for line in lines["reading"] if line[0] == k):
        sums.integrateMeasurement(np.array(reading[3:]), np.array(reading[:3]), seconds)
    graph.add(gtsam.CombinedImuFactor(X(k), V(k), X(k + 1), V(k + 1), B(k), B(k + 1), sums))
graph.add(gtsam.PriorFactorPose3(X(0), values.atPose3(X(0)), diagonal([*sigmas[:3], *sigmas[6:9]])))
graph.add(gtsam.PriorFactorVector(V(0), values.atVector(V(0)), diagonal(sigmas[3:6])))
graph.add(gtsam.PriorFactorConstantBias(B(0), bias, diagonal([*sigmas[12:], *sigmas[9:12]])))

parameters = gtsam.LevenbergMarquardtParams()
parameters.setlambdaInitial(1e-4)
parameters.setDiagonalDamping(True)
least = float("inf")
for _ in range(20):
    search = gtsam.LevenbergMarquardtOptimizer(graph, values, parameters)
    before = float("inf")
    while before - search.error() > 1e-12 * search.error():
        before, start = search.error(), time.perf_counter()
        search.iterate()
        least = min(least, time.perf_counter() - start)
print(1e3 * least, 2.0 * search.error())
