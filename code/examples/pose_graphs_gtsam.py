"""The pose graphs of pose_graphs.rs in GTSAM, in the same lines: costs, and the least time of three solves.

usage: pose_graphs_gtsam.py FOLDER
"""
import sys
import time

import gtsam
import numpy as np

FOLDER = sys.argv[1]


def say(name, value):
    print(f"{name} {value:.9e}")


def timed(name, call):
    best = float("inf")
    for _ in range(3):
        begin = time.perf_counter()
        result = call()
        best = min(best, 1e3 * (time.perf_counter() - begin))
    say(f"{name}.ms", best)
    return result


def solve(name, graph, values, hold):
    """Gauss-Newton and Levenberg-Marquardt, until the cost falls by less than a billionth."""
    say(f"{name}.start", graph.error(values))
    held = gtsam.NonlinearFactorGraph(graph)
    held.add(hold)
    for way, parameters, optimizer in [
        ("gauss_newton", gtsam.GaussNewtonParams(), gtsam.GaussNewtonOptimizer),
        ("levenberg", gtsam.LevenbergMarquardtParams(), gtsam.LevenbergMarquardtOptimizer),
    ]:
        parameters.setRelativeErrorTol(1e-9)
        parameters.setAbsoluteErrorTol(0.0)
        parameters.setMaxIterations(100)

        def run():
            search = optimizer(held, values, parameters)
            return search, search.optimize()

        search, result = timed(f"{name}.{way}", run)
        say(f"{name}.{way}.cost", graph.error(result))
        say(f"{name}.{way}.steps", search.iterations())


def as_written(name):
    """Edges of Euler angles with the translation first in the information, which GTSAM keeps last."""
    graph, order = gtsam.NonlinearFactorGraph(), [3, 4, 5, 0, 1, 2]
    for line in open(name):
        _, first, second, *numbers = line.split()
        x, y, z, roll, pitch, yaw, *upper = map(float, numbers)
        information = np.zeros((6, 6))
        information[np.triu_indices(6)] = upper
        information += np.triu(information, 1).T
        measured = gtsam.Pose3(gtsam.Rot3.Ypr(yaw, pitch, roll), np.array([x, y, z]))
        noise = gtsam.noiseModel.Gaussian.Information(information[np.ix_(order, order)])
        graph.add(gtsam.BetweenFactorPose3(int(first), int(second), measured, noise))
    return graph


def chained(graph):
    """The poses that follow from the odometry."""
    odometry = {}
    for number in range(graph.size()):
        first, second = graph.at(number).keys()
        if second == first + 1:
            odometry[first] = graph.at(number).measured()
    values, pose = gtsam.Values(), gtsam.Pose3()
    values.insert(0, pose)
    for number in range(len(odometry)):
        pose = pose.compose(odometry[number])
        values.insert(number + 1, pose)
    return values


def chordal(graph):
    anchored = gtsam.NonlinearFactorGraph(graph)
    anchored.add(gtsam.PriorFactorPose3(0, gtsam.Pose3(), gtsam.noiseModel.Unit.Create(6)))
    return gtsam.InitializePose3.initialize(anchored)


sphere = f"{FOLDER}/sphere2500.txt"
read, _ = timed("sphere.reading", lambda: gtsam.load3D(sphere))
for name, graph in [("sphere", as_written(sphere)), ("sphere_as_read", read)]:
    hold = gtsam.NonlinearEqualityPose3(0, gtsam.Pose3())
    solve(f"{name}.chained", graph, chained(graph), hold)
    values = timed(f"{name}.chord", lambda: chordal(graph))
    solve(f"{name}.chordal", graph, values, gtsam.NonlinearEqualityPose3(0, values.atPose3(0)))
graph, values = timed("plane.reading", lambda: gtsam.load2D(f"{FOLDER}/w10000.graph"))
solve("plane", graph, values, gtsam.NonlinearEqualityPose2(0, values.atPose2(0)))
