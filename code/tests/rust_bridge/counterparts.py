"""What the tests of rust_bridge.rs say, in Python 3.10 and its standard library: python3 counterparts.py"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Protocol


# ANCHOR: functions
def clamped_depth(depth: float, nearest: float) -> float:
    return nearest if depth < nearest else depth
# ANCHOR_END: functions


# ANCHOR: tuples
def polar(x: float, y: float) -> tuple[float, float]:
    return math.hypot(x, y), math.atan2(y, x)


def test_a_tuple_comes_apart_into_names():
    radius, angle = polar(0.0, 2.0)
    assert (radius, angle) == (2.0, math.pi / 2)
# ANCHOR_END: tuples


# ANCHOR: slices
def mean(values: Sequence[float]) -> float:
    return sum(values) / len(values)


def test_tuples_and_lists_are_both_sequences():
    baselines = (0.1, 0.5)
    depths = [5.0, 10.0]
    depths.append(15.0)
    assert (mean(baselines), mean(depths)) == (0.3, 10.0)
# ANCHOR_END: slices


# ANCHOR: structs
@dataclass(frozen=True)
class Stereo:
    focal_length: float
    baseline: float
    # ANCHOR_END: structs

    # ANCHOR: methods
    def depth(self, disparity: float) -> float:
        return self.focal_length * self.baseline / disparity
    # ANCHOR_END: methods


# ANCHOR: enums
@dataclass
class Gaussian:
    sigma: float


@dataclass
class Uniform:
    width: float


Noise = None | Gaussian | Uniform
# ANCHOR_END: enums


# ANCHOR: matching
def variance(noise: Noise) -> float:
    match noise:
        case None:
            return 0.0
        case Gaussian(sigma):
            return sigma * sigma
        case Uniform(width):
            return width * width / 12.0
# ANCHOR_END: matching


# ANCHOR: options
def inverse_depth(disparity: float) -> float | None:
    return 1.0 / disparity if disparity > 0.0 else None
# ANCHOR_END: options


# ANCHOR: let_else
def shift(before: float | None, after: float | None) -> float:
    if before is None or after is None:
        return 0.0
    return after - before
# ANCHOR_END: let_else


# ANCHOR: results
def focal_length(text: str) -> float:
    return float(text)  # raises ValueError
# ANCHOR_END: results


# ANCHOR: borrows
def longest(points: list[list[float]]) -> float:
    return max(math.hypot(*point) for point in points)


def scale(points: list[list[float]], factor: float) -> None:
    for point in points:
        point[:] = [factor * component for component in point]
# ANCHOR_END: borrows


# ANCHOR: closures
def derivative(f: Callable[[float], float], x: float) -> float:
    step = 1e-6
    return (f(x + step) - f(x - step)) / (2 * step)


def test_a_lambda_sees_the_names_around_it():
    rig = Stereo(focal_length=400.0, baseline=0.5)
    slope = derivative(lambda disparity: rig.depth(disparity), 40.0)
    assert math.isclose(slope, -0.125, rel_tol=1e-8)
# ANCHOR_END: closures


Point = tuple[float, float, float]


# ANCHOR: traits
class Project(Protocol):
    def project(self, point: Point) -> tuple[float, float] | None: ...


def seen(camera: Project, points: list[Point]) -> int:
    return sum(camera.project(point) is not None for point in points)
# ANCHOR_END: traits


class Pinhole:
    def project(self, point: Point) -> tuple[float, float] | None:
        x, y, z = point
        return (400 * x / z + 320, 400 * y / z + 240) if z > 0.05 else None


# ANCHOR: const_generics
def squared_error(residual: list[float], information: list[list[float]]) -> float:
    # The size is known when the program runs, and a wrong one is found then.
    sizes = range(len(residual))
    return sum(residual[i] * information[i][k] * residual[k] for i in sizes for k in sizes)
# ANCHOR_END: const_generics


# ANCHOR: tests
# units.py
def degrees(radians: float) -> float:
    return math.degrees(radians)


# test_units.py
def test_half_a_turn_is_180_degrees():
    assert math.isclose(degrees(math.pi), 180.0)
# ANCHOR_END: tests


def test_bindings():
    # ANCHOR: bindings
    focal_length = 400.0
    pixel = 320.0
    pixel += focal_length * 0.04
    # ANCHOR_END: bindings
    assert pixel == 336.0


def test_loops():
    depths = [2.0, 4.0]
    # ANCHOR: loops
    cost = 0.0
    for index, depth in enumerate(depths):
        cost += index * depth
    for k in range(3):
        cost += k
    # ANCHOR_END: loops
    assert cost == 7.0


def test_dataclass():
    # ANCHOR: derived
    rig = Stereo(focal_length=400.0, baseline=0.5)
    wider = replace(rig, baseline=1.0)
    assert rig != wider
    print(f"{rig} sees {rig.depth(40.0)} m")
    # ANCHOR_END: derived
    assert rig.depth(40.0) == 5.0


def test_names():
    # ANCHOR: moves
    track = [336.0, 296.0]
    copy = track.copy()
    same = track
    # `track` and `same` are two names of one list.
    # ANCHOR_END: moves
    assert same == copy and same is track


def test_comprehensions():
    # ANCHOR: iterators
    left = [336.0, 340.0]
    right = [296.0, 320.0]
    disparities = [l - r for l, r in zip(left, right)]
    largest = max(disparities)
    # ANCHOR_END: iterators
    assert (disparities, largest) == ([40.0, 20.0], 40.0)


def test_the_rest():
    assert clamped_depth(0.01, 0.05) == 0.05
    assert [variance(n) for n in (None, Gaussian(2.0), Uniform(6.0))] == [0.0, 4.0, 3.0]
    assert inverse_depth(-1.0) is None
    assert (shift(2.0, 5.0), shift(None, 5.0)) == (3.0, 0.0)
    assert focal_length(" 400 ") == 400.0
    points = [[0.0, 3.0, 4.0], [0.0, 0.0, 0.0]]
    scale(points, 2.0)
    assert longest(points) == 10.0
    assert seen(Pinhole(), [(0.2, -0.1, 5.0), (0.0, 0.0, -5.0)]) == 1
    assert squared_error([1.0, 2.0], [[1.0, 0.0], [0.0, 1.0]]) == 5.0


if __name__ == "__main__":
    tests = [test for name, test in list(globals().items()) if name.startswith("test_")]
    for test in tests:
        test()
    print(f"{len(tests)} tests passed")
