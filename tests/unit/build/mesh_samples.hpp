#pragma once

#include "meltscope/build/shapes.hpp"

#include <cstdint>
#include <cstring>
#include <string>

namespace meltscope {

/// A block as twelve triangles that face outwards.
inline Solid block_mesh(const Vec3& min, const Vec3& max) {
    Solid solid;
    for (int i = 0; i < 8; ++i) {
        solid.points.emplace_back((i & 1) != 0 ? max.x() : min.x(), (i & 2) != 0 ? max.y() : min.y(),
                                  (i & 4) != 0 ? max.z() : min.z());
    }
    solid.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                       {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    return solid;
}

/// A ball as a mesh: an octahedron of which each triangle is divided `depth` times into four.
inline Solid ball_mesh(const Vec3& center, double radius, int depth) {
    std::vector<std::array<Vec3, 3>> faces;
    for (const double x : {1.0, -1.0}) {
        for (const double y : {1.0, -1.0}) {
            for (const double z : {1.0, -1.0}) {
                const Vec3 a(x, 0, 0);
                const Vec3 b(0, y, 0);
                const Vec3 c(0, 0, z);
                x* y* z > 0.0 ? faces.push_back({a, b, c}) : faces.push_back({a, c, b});
            }
        }
    }
    for (int i = 0; i < depth; ++i) {
        std::vector<std::array<Vec3, 3>> finer;
        for (const auto& [a, b, c] : faces) {
            const Vec3 ab = (a + b).normalized();
            const Vec3 bc = (b + c).normalized();
            const Vec3 ca = (c + a).normalized();
            finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
        }
        faces = finer;
    }
    Solid solid;
    for (const auto& face : faces) {
        std::array<std::uint32_t, 3> triangle{};
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3 point = center + radius * face[i];
            std::size_t known = 0;
            while (known < solid.points.size() && solid.points[known] != point) {
                ++known;
            }
            if (known == solid.points.size()) {
                solid.points.push_back(point);
            }
            triangle[i] = static_cast<std::uint32_t>(known);
        }
        solid.triangles.push_back(triangle);
    }
    return solid;
}

inline std::string binary_stl(const Solid& solid) {
    std::string bytes(80, 'x');
    const auto add = [&](const auto& value) {
        char raw[sizeof(value)];
        std::memcpy(raw, &value, sizeof(value));
        bytes.append(raw, sizeof(value));
    };
    add(static_cast<std::uint32_t>(solid.triangles.size()));
    for (const auto& triangle : solid.triangles) {
        for (int i = 0; i < 3; ++i) {
            add(0.0f);
        }
        for (const std::uint32_t corner : triangle) {
            for (const double component : solid.points[corner]) {
                add(static_cast<float>(component));
            }
        }
        add(std::uint16_t{0});
    }
    return bytes;
}

inline std::string ascii_stl(const Solid& solid) {
    std::string text = "solid sample of 2 words\n";
    for (const auto& triangle : solid.triangles) {
        text += "  facet normal 0 0 0\n    outer loop\n";
        for (const std::uint32_t corner : triangle) {
            const Vec3& point = solid.points[corner];
            text += "      vertex " + std::to_string(point.x()) + " " + std::to_string(point.y()) + " " +
                    std::to_string(point.z()) + "\n";
        }
        text += "    endloop\n  endfacet\n";
    }
    return text + "endsolid sample\n";
}

} // namespace meltscope
