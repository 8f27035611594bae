// What the tests of rust_bridge.rs say, in C++20. It compiles and runs with the standard library alone:
// c++ -std=c++20 counterparts.cpp && ./a.out

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <cmath>
#include <concepts>
#include <cstdio>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

// ANCHOR: functions
double clamped_depth(double depth, double nearest) {
    return depth < nearest ? nearest : depth;
}
// ANCHOR_END: functions

// ANCHOR: tuples
std::tuple<double, double> polar(double x, double y) {
    return {std::hypot(x, y), std::atan2(y, x)};
}

void a_tuple_comes_apart_into_names() {
    auto [radius, angle] = polar(0.0, 2.0);
    assert(radius == 2.0 && angle == std::numbers::pi / 2);
}
// ANCHOR_END: tuples

// ANCHOR: slices
double mean(std::span<const double> values) {
    double sum = 0.0;
    for (double value : values) sum += value;
    return sum / values.size();
}

void arrays_and_vectors_are_both_read_as_spans() {
    std::array baselines{0.1, 0.5};
    std::vector depths{5.0, 10.0};
    depths.push_back(15.0);
    assert(mean(baselines) == 0.3 && mean(depths) == 10.0);
}
// ANCHOR_END: slices

// ANCHOR: structs
struct Stereo {
    double focal_length;
    double baseline;
    bool operator==(const Stereo&) const = default;
    // ANCHOR_END: structs

    // ANCHOR: methods
    double depth(double disparity) const {
        return focal_length * baseline / disparity;
    }
    // ANCHOR_END: methods
};

// ANCHOR: enums
struct None {};
struct Gaussian { double sigma; };
struct Uniform { double width; };
using Noise = std::variant<None, Gaussian, Uniform>;
// ANCHOR_END: enums

// ANCHOR: matching
template <class... F> struct Overloaded : F... { using F::operator()...; };

double variance(const Noise& noise) {
    return std::visit(Overloaded{
        [](None) { return 0.0; },
        [](Gaussian g) { return g.sigma * g.sigma; },
        [](Uniform u) { return u.width * u.width / 12.0; },
    }, noise);
}
// ANCHOR_END: matching

// ANCHOR: options
std::optional<double> inverse_depth(double disparity) {
    if (disparity > 0.0) return 1.0 / disparity;
    return std::nullopt;
}
// ANCHOR_END: options

// ANCHOR: let_else
double shift(std::optional<double> before, std::optional<double> after) {
    if (!before || !after) return 0.0;
    return *after - *before;
}
// ANCHOR_END: let_else

// ANCHOR: results
double focal_length(const std::string& text) {
    return std::stod(text);  // throws std::invalid_argument
}
// ANCHOR_END: results

using Point = std::array<double, 3>;

double norm(const Point& p) { return std::hypot(p[0], p[1], p[2]); }

// ANCHOR: borrows
double longest(const std::vector<Point>& points) {
    double length = 0.0;
    for (const Point& point : points) length = std::max(length, norm(point));
    return length;
}

void scale(std::vector<Point>& points, double factor) {
    for (Point& point : points)
        for (double& component : point) component *= factor;
}
// ANCHOR_END: borrows

// ANCHOR: closures
double derivative(auto f, double x) {
    double step = 1e-6;
    return (f(x + step) - f(x - step)) / (2.0 * step);
}

void a_lambda_captures_what_it_names() {
    Stereo rig{.focal_length = 400.0, .baseline = 0.5};
    double slope = derivative([&rig](double d) { return rig.depth(d); }, 40.0);
    assert(std::abs(slope + 0.125) < 1e-8);
}
// ANCHOR_END: closures

// ANCHOR: traits
template <class C>
concept Project = requires(const C& camera, const Point& point) {
    { camera.project(point) } -> std::same_as<std::optional<std::array<double, 2>>>;
};

template <Project C>
int seen(const C& camera, const std::vector<Point>& points) {
    return std::ranges::count_if(points, [&](const Point& point) {
        return camera.project(point).has_value();
    });
}
// ANCHOR_END: traits

struct Pinhole {
    double f, cx, cy;
    std::optional<std::array<double, 2>> project(const Point& p) const {
        if (p[2] <= 0.05) return std::nullopt;
        return std::array{f * p[0] / p[2] + cx, f * p[1] / p[2] + cy};
    }
};

// ANCHOR: const_generics
template <int D>
double squared_error(const std::array<double, D>& residual,
                     const std::array<std::array<double, D>, D>& information) {
    double sum = 0.0;
    for (int i = 0; i < D; ++i)
        for (int k = 0; k < D; ++k) sum += residual[i] * information[i][k] * residual[k];
    return sum;
}
// ANCHOR_END: const_generics

// ANCHOR: tests
namespace units {
inline double degrees(double radians) { return radians * 180.0 / std::numbers::pi; }
}

void half_a_turn_is_180_degrees() {
    assert(std::abs(units::degrees(std::numbers::pi) - 180.0) < 1e-12);
}
// ANCHOR_END: tests

int main() {
    {
        // ANCHOR: bindings
        const auto focal_length = 400.0;
        auto pixel = 320.0;
        pixel += focal_length * 0.04;
        // ANCHOR_END: bindings
        assert(pixel == 336.0);
    }
    {
        std::array depths{2.0, 4.0};
        // ANCHOR: loops
        double cost = 0.0;
        for (std::size_t index = 0; index < depths.size(); ++index) {
            cost += index * depths[index];
        }
        for (int k = 0; k < 3; ++k) {
            cost += k;
        }
        // ANCHOR_END: loops
        assert(cost == 7.0);
    }
    {
        // ANCHOR: derived
        Stereo rig{.focal_length = 400.0, .baseline = 0.5};
        Stereo wider = rig;
        wider.baseline = 1.0;
        assert(rig != wider);
        std::printf("sees %g m\n", rig.depth(40.0));
        // ANCHOR_END: derived
        assert(rig.depth(40.0) == 5.0);
    }
    {
        // ANCHOR: moves
        std::vector track{336.0, 296.0};
        auto copy = track;
        auto moved = std::move(track);
        // `track` is still a name, of a vector that is empty in practice.
        // ANCHOR_END: moves
        assert(moved == copy);
    }
    {
        // ANCHOR: iterators
        std::vector left{336.0, 340.0}, right{296.0, 320.0};
        std::vector<double> disparities(left.size());
        std::ranges::transform(left, right, disparities.begin(), std::minus{});
        double largest = std::ranges::max(disparities);
        // ANCHOR_END: iterators
        assert(disparities == (std::vector{40.0, 20.0}) && largest == 40.0);
    }
    assert(clamped_depth(0.01, 0.05) == 0.05);
    a_tuple_comes_apart_into_names();
    arrays_and_vectors_are_both_read_as_spans();
    assert(variance(Gaussian{2.0}) == 4.0 && variance(Uniform{6.0}) == 3.0 && variance(None{}) == 0.0);
    assert(!inverse_depth(-1.0) && shift(2.0, 5.0) == 3.0 && shift(std::nullopt, 5.0) == 0.0);
    assert(focal_length(" 400 ") == 400.0);
    std::vector<Point> points{{0.0, 3.0, 4.0}, {0.0, 0.0, 0.0}};
    scale(points, 2.0);
    assert(longest(points) == 10.0);
    a_lambda_captures_what_it_names();
    assert(seen(Pinhole{400.0, 320.0, 240.0}, {{0.2, -0.1, 5.0}, {0.0, 0.0, -5.0}}) == 1);
    assert((squared_error<2>({1.0, 2.0}, {{{1.0, 0.0}, {0.0, 1.0}}}) == 5.0));
    half_a_turn_is_180_degrees();
}
