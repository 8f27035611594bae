"""The graph of two_keyframes.rs in GTSAM, of the book's factors and of GTSAM's own.

usage: two_keyframes_gtsam.py GRAPH_CSV

The file is written by the record `factrs_gtsam`. Its lines are: `state`, where the search begins, a quaternion w x y z,
position, velocity; `bias`, gyroscope and accelerometer; `landmark`, x y z; `extrinsics`, the camera on the body;
`camera`, fx fy cx cy, the sigma of a pixel and the threshold of Huber's kernel; `pixel`, keyframe, landmark, u, v;
`noise`, the densities of gyroscope, accelerometer and their walks; `step`, seconds; `reading`, gyroscope and
accelerometer; `known_state` and `known_bias`, what is said of the first keyframe, and `sigmas`, of its turns, velocity,
position and biases; `sums`, the readings as the book sums them up: seconds, turn as a quaternion, velocity and position,
`by_bias`, their derivatives by the biases, and `covariance`, both by rows.

What is printed, a line each: the estimate of the book's factors, then that of GTSAM's own (states as above with their
biases, then landmarks); GTSAM's turn as a quaternion, velocity and position; the least
milliseconds of a search for the second graph.
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


def only(kind):
    return lines[kind][0]


def pose(numbers):
    return gtsam.Pose3(gtsam.Rot3.Quaternion(*numbers[:4]), numbers[4:7])


def bias(numbers):
    return gtsam.imuBias.ConstantBias(numbers[3:], numbers[:3])


def numbers_of(rotation):
    quaternion = rotation.toQuaternion()
    return [quaternion.w(), quaternion.x(), quaternion.y(), quaternion.z()]


# ANCHOR: start
start = gtsam.Values()
for k in range(2):
    start.insert(X(k), pose(lines["state"][k]))
    start.insert(V(k), lines["state"][k][7:])
    start.insert(B(k), bias(lines["bias"][k]))
for j, point in enumerate(lines["landmark"]):
    start.insert(L(j), point)
# ANCHOR_END: start


# ANCHOR: pixels
def pixels_and_priors():
    """What both graphs share: GTSAM's own factors for pixels and priors."""
    graph, (fx, fy, cx, cy, sigma, threshold) = gtsam.NonlinearFactorGraph(), only("camera")
    camera, camera_on_body = gtsam.Cal3_S2(fx, fy, 0.0, cx, cy), pose(only("extrinsics"))
    kernel = gtsam.noiseModel.mEstimator.Huber.Create(threshold)
    noise = gtsam.noiseModel.Robust.Create(kernel, gtsam.noiseModel.Isotropic.Sigma(2, sigma))
    for k, j, u, v in lines["pixel"]:
        pixel, keys = np.array([u, v]), (X(int(k)), L(int(j)))
        graph.add(gtsam.GenericProjectionFactorCal3_S2(pixel, noise, *keys, camera, camera_on_body))
    known, sigmas = only("known_state"), gtsam.noiseModel.Diagonal.Sigmas
    turn, velocity, position, gyro, force = np.split(only("sigmas"), 5)
    graph.add(gtsam.PriorFactorPose3(X(0), pose(known), sigmas(np.hstack([turn, position]))))
    graph.add(gtsam.PriorFactorVector(V(0), known[7:], sigmas(velocity)))
    noise = sigmas(np.hstack([force, gyro]))
    graph.add(gtsam.PriorFactorConstantBias(B(0), bias(only("known_bias")), noise))
    return graph
# ANCHOR_END: pixels


# ANCHOR: inertial
gravity = np.array([0.0, 0.0, -9.81])
seconds, *sums = only("sums")
turn, fast, far = gtsam.Rot3.Quaternion(*sums[:4]), np.array(sums[4:7]), np.array(sums[7:10])
by_bias = only("by_bias").reshape(9, 6)


def residual(values):
    """What two keyframes say of the readings between them, less what the book's sums say."""
    (first, second), (v, w) = map(values.atPose3, (X(0), X(1))), map(values.atVector, (V(0), V(1)))
    b, later = (np.hstack([b.gyroscope(), b.accelerometer()]) for b in
                map(values.atConstantBias, (B(0), B(1))))
    shift = by_bias @ (b - only("known_bias"))
    body = first.rotation().inverse()
    faster = body.rotate(w - v - gravity * seconds)
    farther = second.translation() - first.translation() - v * seconds
    farther = body.rotate(farther - 0.5 * gravity * seconds**2)
    measured = turn.compose(gtsam.Rot3.Expmap(shift[:3]))
    phi = gtsam.Rot3.Logmap(measured.between(body.compose(second.rotation())))
    return np.hstack([phi, faster - fast - shift[3:6], farther - far - shift[6:], later - b])
# ANCHOR_END: inertial


STEP = 1e-5


def column(values, key, size, axis):
    """A derivative of the residual, by the difference of two values."""
    ends = []
    for sign in (1.0, -1.0):
        moved = gtsam.VectorValues()
        moved.insert(key, sign * STEP * np.eye(size)[axis])
        ends.append(residual(values.retract(moved)))
    return (ends[0] - ends[1]) / (2.0 * STEP)


def inertial(factor, values, jacobians):
    if jacobians is not None:
        for i, (key, size) in enumerate(zip(factor.keys(), (6, 3, 6) * 2)):
            columns = [column(values, key, size, axis) for axis in range(size)]
            jacobians[i] = np.array(columns).T
    return residual(values)


keys = [X(0), V(0), B(0), X(1), V(1), B(1)]
noise = gtsam.noiseModel.Gaussian.Covariance(only("covariance").reshape(15, 15))
identical = pixels_and_priors()
identical.add(gtsam.CustomFactor(noise, keys, inertial))

# ANCHOR: own
gyro, force, gyro_walk, force_walk = only("noise")
parameters = gtsam.PreintegrationCombinedParams.MakeSharedU(9.81)
parameters.setGyroscopeCovariance(np.eye(3) * gyro**2)
parameters.setAccelerometerCovariance(np.eye(3) * force**2)
parameters.setIntegrationCovariance(np.zeros((3, 3)))
parameters.setBiasOmegaCovariance(np.eye(3) * gyro_walk**2)
parameters.setBiasAccCovariance(np.eye(3) * force_walk**2)
readings = gtsam.PreintegratedCombinedMeasurements(parameters, bias(only("known_bias")))
for reading in lines["reading"]:
    readings.integrateMeasurement(reading[3:], reading[:3], only("step")[0])
own = pixels_and_priors()
own.add(gtsam.CombinedImuFactor(X(0), V(0), X(1), V(1), B(0), B(1), readings))
# ANCHOR_END: own


def search(graph, parameters):
    return gtsam.LevenbergMarquardtOptimizer(graph, start, parameters).optimize()


def show(numbers):
    print(" ".join(repr(float(number)) for number in numbers))


exactly = gtsam.LevenbergMarquardtParams()
exactly.setRelativeErrorTol(1e-15)
exactly.setAbsoluteErrorTol(1e-15)
for graph in (identical, own):
    found, estimate = search(graph, exactly), []
    for k in range(2):
        state, b = found.atPose3(X(k)), found.atConstantBias(B(k))
        estimate += [*numbers_of(state.rotation()), *state.translation(), *found.atVector(V(k))]
        estimate += [*b.gyroscope(), *b.accelerometer()]
    show(estimate + [x for j in range(len(lines["landmark"])) for x in found.atPoint3(L(j))])
show([*numbers_of(readings.deltaRij()), *readings.deltaVij(), *readings.deltaPij()])
least = float("inf")
for _ in range(50):
    began = time.perf_counter()
    search(own, gtsam.LevenbergMarquardtParams())
    least = min(least, time.perf_counter() - began)
print(1e3 * least)
