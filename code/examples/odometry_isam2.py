"""ISAM2 of GTSAM 4.3 on a flight, picture by picture, nothing forgotten: errors and seconds.

usage: odometry_isam2.py TRACKS_CSV GROUNDTRUTH_CSV FROM_SECONDS EVERY GATE_PIXELS SINCE_SECONDS

The same factors and the same help by the ground truth as in odometry_gtsam.py. A picture brings its state, the readings
before it, its pixels, and the landmarks whose third picture it is, with all their pixels until then. A landmark gets a
prior of three metres where the truth has it, because a body that stands gives it no depth and ISAM2 stops there.

Prints the root mean square error of the positions in centimetres, aligned by yaw and shift: of each state when it was
the newest, when it was two seconds old, and in the end; then the seconds of all updates, without those of reading the
estimates out. What is read meanwhile is of a run that linearizes again at each update, the rest of one that does so at
each tenth, as ISAM2 has it by itself. States before SINCE_SECONDS of the recording are not judged. Then a line for each of the three: how far
off a state is every one and a half seconds.
"""
import sys
import time

import gtsam
import numpy as np
from gtsam.symbol_shorthand import L, X

sys.dont_write_bytecode = True
from odometry_gtsam import Batch, Flight  # noqa: E402

DELAY, LANDMARK_SIGMA, SHOWN = 2.0, 3.0, 1.5


def picture_of(key):
    """The number of the state that a key belongs to; none for a landmark."""
    symbol = gtsam.Symbol(key)
    return None if chr(symbol.chr()) == "l" else symbol.index()


class Pictures:
    """A batch, dealt out by the picture that brings each factor and each variable."""

    def __init__(self, batch):
        self.batch = batch
        self.ready = {track: sightings[2][0] for track, sightings in batch.sightings.items()}
        count = len(batch.pictures)
        self.factors = [gtsam.NonlinearFactorGraph() for _ in range(count)]
        self.values = [gtsam.Values() for _ in range(count)]
        for at in range(batch.graph.size()):
            factor = batch.graph.at(at)
            self.factors[max(map(self.brought_by, factor.keys()))].add(factor)
        noise = gtsam.noiseModel.Isotropic.Sigma(3, LANDMARK_SIGMA)
        for track, picture in self.ready.items():
            point = batch.start.atPoint3(L(track))
            self.factors[picture].add(gtsam.PriorFactorPoint3(L(track), point, noise))
        for key in batch.start.keys():
            self.insert(key)

    def brought_by(self, key):
        picture = picture_of(key)
        return self.ready[gtsam.Symbol(key).index()] if picture is None else picture

    def insert(self, key):
        values, start = self.values[self.brought_by(key)], self.batch.start
        kinds = {"x": start.atPose3, "v": start.atVector, "b": start.atConstantBias, "l": start.atPoint3}
        values.insert(key, kinds[chr(gtsam.Symbol(key).chr())](key))

    def fly(self, read):
        """Seconds of all updates; the estimate is read out after each of them if that is asked for."""
        parameters = gtsam.ISAM2Params()
        parameters.setFactorization("QR")
        if read:
            parameters.relinearizeSkip = 1
        smoother, seconds = gtsam.ISAM2(parameters), 0.0
        for at, (factors, values) in enumerate(zip(self.factors, self.values)):
            begin = time.perf_counter()
            smoother.update(factors, values)
            seconds += time.perf_counter() - begin
            if read:
                read(at, smoother.calculateEstimate())
        return seconds, smoother.calculateEstimate()


def errors(estimate, truth):
    """In centimetres, after the turn about the vertical and the shift that bring positions nearest to the true ones."""
    off, true = estimate - estimate.mean(axis=0), truth - truth.mean(axis=0)
    cross = off[:, 0] @ true[:, 1] - off[:, 1] @ true[:, 0]
    yaw = np.arctan2(cross, (off[:, :2] * true[:, :2]).sum())
    turn = gtsam.Rot3.Rz(yaw).matrix()
    return 100 * np.linalg.norm(off @ turn.T - true, axis=1)


def main(tracks, groundtruth, begin, every, gate, since):
    flight = Flight(tracks, groundtruth)
    pictures = [p for p in sorted(flight.tracks) if flight.times[p] >= float(begin) - 1e-6][:: int(every)]
    dealt = Pictures(Batch(flight, pictures, float(gate)))
    times = np.array([flight.times[picture] for picture in pictures])
    truth = np.array([pose.translation() for pose, _, _ in dealt.batch.truth])
    back = int(round(DELAY / (times[1] - times[0])))
    newest, delayed = [], []

    def read(at, estimate):
        newest.append(estimate.atPose3(X(at)).translation())
        if at >= back:
            delayed.append(estimate.atPose3(X(at - back)).translation())

    dealt.fly(read)
    seconds, last = dealt.fly(None)
    smoothed = [last.atPose3(X(at)).translation() for at in range(len(pictures))]
    judged = times >= float(since) - 1e-6
    off = [errors(np.array(path)[judged[: len(path)]], truth[: len(path)][judged[: len(path)]])
           for path in (newest, delayed, smoothed)]
    print(*(f"{np.sqrt((path**2).mean()):.4f}" for path in off), f"{seconds:.4f}")
    stride = int(round(SHOWN / (times[1] - times[0])))
    for path in off:
        print(*(f"{number:.4f}" for number in path[::stride]))


if __name__ == "__main__":
    main(*sys.argv[1:])
