// Reads a graded flight and writes an answer to it: poses by readings alone, and covariances that admit it.
//
//     c++ -std=c++20 -O2 -o graded_flight graded_flight.cpp && ./graded_flight FLIGHT ANSWER
//
// FLIGHT and ANSWER are folders. It needs nothing but the standard library.

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

// ANCHOR: read
using Row = std::vector<std::string>;
using Vector = std::array<double, 3>;
struct Reading { std::int64_t nanoseconds; Vector gyro, accelerometer; };

// The cells below the line that names the columns.
std::vector<Row> rows(const std::filesystem::path& path) {
    std::ifstream file(path);
    if (!file) throw std::runtime_error("cannot read " + path.string());
    std::vector<Row> table;
    for (std::string line, cell; std::getline(file, line);) {
        if (line.empty() || line[0] == '#') continue;
        std::istringstream cells(line);
        for (table.emplace_back(); std::getline(cells, cell, ',');) table.back().push_back(cell);
    }
    return table;
}

std::vector<Reading> readings(const std::filesystem::path& flight) {
    std::vector<Reading> all;
    for (const Row& row : rows(flight / "imu.csv")) {
        auto number = [&](int column) { return std::stod(row.at(column)); };
        all.push_back({std::stoll(row.at(0)), {number(1), number(2), number(3)}, {number(4), number(5), number(6)}});
    }
    return all;
}
// ANCHOR_END: read

// ANCHOR: pictures
using Picture = std::map<int, std::array<double, 2>>;  // pixels by track

std::map<std::int64_t, Picture> pictures(const std::filesystem::path& flight) {
    std::map<std::int64_t, Picture> all;
    for (const Row& row : rows(flight / "tracks.csv"))
        all[std::stoll(row.at(0))][std::stoi(row.at(1))] = {std::stod(row.at(2)), std::stod(row.at(3))};
    return all;
}

// A number of calibration.toml, the first of its name: `rate` is that of the camera.
double calibrated(const std::filesystem::path& flight, const std::string& name) {
    std::ifstream file(flight / "calibration.toml");
    for (std::string line; std::getline(file, line);)
        if (line.starts_with(name + " = ")) return std::stod(line.substr(name.size() + 3));
    throw std::runtime_error("calibration.toml has no " + name);
}
// ANCHOR_END: pictures

// ANCHOR: write
using Turn = std::array<double, 4>;  // a quaternion: x, y, z, w
struct Pose {
    std::int64_t nanoseconds;
    Vector position;
    Turn turn;
    std::array<std::array<double, 6>, 6> covariance;  // a turn in the body, then the position in the world
};

void write(const std::filesystem::path& folder, const std::vector<Pose>& poses) {
    std::filesystem::create_directories(folder);
    std::ofstream trajectory(folder / "trajectory.txt"), covariances(folder / "covariance.txt");
    for (std::ofstream* file : {&trajectory, &covariances}) file->precision(17);
    for (const Pose& pose : poses) {
        std::string rest = std::to_string(pose.nanoseconds % 1'000'000'000);
        rest.insert(0, 9 - rest.size(), '0');
        const std::string time = std::to_string(pose.nanoseconds / 1'000'000'000) + "." + rest;
        trajectory << time;
        for (double number : pose.position) trajectory << ' ' << number;
        for (double number : pose.turn) trajectory << ' ' << number;
        covariances << time;
        for (int row = 0; row < 6; ++row)
            for (int column = row; column < 6; ++column) covariances << ' ' << pose.covariance[row][column];
        trajectory << '\n', covariances << '\n';
    }
}
// ANCHOR_END: write

// The turn, followed by a turn of the body in its own frame.
Turn turned(const Turn& q, const Vector& phi) {
    const double angle = std::hypot(phi[0], phi[1], phi[2]);
    const double size = angle > 0 ? std::sin(angle / 2) / angle : 0.5, d = std::cos(angle / 2);
    const auto [x, y, z, w] = q;
    const double a = size * phi[0], b = size * phi[1], c = size * phi[2];
    return {w * a + x * d + y * c - z * b, w * b - x * c + y * d + z * a,
            w * c + x * b - y * a + z * d, w * d - x * a - y * b - z * c};
}

// Where the body is at each picture by the gyroscope alone; the place is not estimated at all.
std::vector<Pose> estimate(const std::filesystem::path& flight) {
    const auto all = readings(flight);
    const auto late = static_cast<std::int64_t>(std::llround(1e9 * calibrated(flight, "time_offset")));
    const auto begin = all.at(0).nanoseconds;
    Vector bias{};
    std::size_t stood = 0;
    for (; stood < all.size() && all[stood].nanoseconds < begin + 1'500'000'000; ++stood)
        for (int axis = 0; axis < 3; ++axis) bias[axis] += all[stood].gyro[axis];
    for (double& axis : bias) axis /= static_cast<double>(stood);
    std::vector<Pose> poses;
    Turn turn{0, 0, 0, 1};
    std::size_t k = 0;
    for (const auto& [camera, seen] : pictures(flight)) {
        const auto time = camera + late;
        for (; k + 1 < all.size() && all[k + 1].nanoseconds <= time; ++k) {
            const double dt = 1e-9 * static_cast<double>(all[k + 1].nanoseconds - all[k].nanoseconds);
            Vector phi{};
            for (int axis = 0; axis < 3; ++axis) phi[axis] = (all[k].gyro[axis] - bias[axis]) * dt;
            turn = turned(turn, phi);
        }
        const double seconds = 1e-9 * static_cast<double>(time - begin);
        Pose pose{time, {}, turn, {}};
        for (int axis = 0; axis < 6; ++axis)
            pose.covariance[axis][axis] = axis < 3 ? 1e-3 + 1e-4 * seconds : 1e-6 + std::pow(seconds, 4);
        poses.push_back(pose);
    }
    return poses;
}

int main(int count, char** arguments) {
    if (count != 3) {
        std::cerr << "usage: graded_flight FLIGHT ANSWER\n";
        return 2;
    }
    try {
        write(arguments[2], estimate(arguments[1]));
    } catch (const std::exception& error) {
        std::cerr << error.what() << '\n';
        return 1;
    }
}
