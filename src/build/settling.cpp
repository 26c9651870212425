#include "balls_in_box.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace meltscope {

namespace {

/// Gaps below which a ball is in touch. What `distance` describes is approached step by step, hence less
/// closely.
constexpr double touching = 1e-7;
constexpr double touching_ground = 1e-4;
/// How deep a ball may go into what `distance` describes, by its radius: half of the overlap that is allowed.
constexpr double deepest_in_ground = 0.01;
/// Slope (sine) below which a ball lies still.
constexpr double level = 1e-3;
/// Longest way in one go along what a ball touches; it loses touch by the square of that.
constexpr double longest_slide = 0.05;
/// Longest way before the neighbours are looked up again.
constexpr double margin = 0.5;

/// All balls by cell, so that those near a place are found; knows when one has moved.
class BallCells {
  public:
    explicit BallCells(const BallsInBox& bed) : size_(bed.size) {
        for (const double radius : bed.radius) {
            largest_radius_ = std::max(largest_radius_, radius);
        }
        for (const Ball& ball : bed.fixed) {
            largest_radius_ = std::max(largest_radius_, ball.radius);
        }
        count_ = (size_.array() / (2.0 * largest_radius_ + margin)).floor().max(1.0).cast<std::int64_t>();
        members_.resize(static_cast<std::size_t>(count_.prod()));
        for (std::size_t i = 0; i < bed.center.size(); ++i) {
            members_[cell(bed.center[i])].push_back(static_cast<std::uint32_t>(i));
        }
        for (std::size_t i = 0; i < bed.fixed.size(); ++i) {
            members_[cell(bed.fixed[i].center)].push_back(static_cast<std::uint32_t>(bed.center.size() + i));
        }
    }

    void move(std::uint32_t ball, const Vec3& from, const Vec3& to) {
        const std::size_t old_cell = cell(from);
        const std::size_t new_cell = cell(to);
        if (old_cell != new_cell) {
            std::erase(members_[old_cell], ball);
            members_[new_cell].push_back(ball);
        }
    }

    /// Balls other than i that it can touch within the margin from where it is.
    void find_near(const BallsInBox& bed, std::size_t i, std::vector<Ball>& near) const {
        near.clear();
        const Index3 home = cell_index(bed.center[i]);
        const Index3 low = (home - 1).max(0);
        const Index3 high = (home + 1).min(count_ - 1);
        for (std::int64_t z = low.z(); z <= high.z(); ++z) {
            for (std::int64_t y = low.y(); y <= high.y(); ++y) {
                for (std::int64_t x = low.x(); x <= high.x(); ++x) {
                    for (const std::uint32_t j : members_[flat({x, y, z})]) {
                        const Ball ball = j < bed.center.size() ? Ball{bed.center[j], bed.radius[j]}
                                                                : bed.fixed[j - bed.center.size()];
                        const double reach = bed.radius[i] + ball.radius + margin;
                        if (j != i && (ball.center - bed.center[i]).squaredNorm() < reach * reach) {
                            near.push_back(ball);
                        }
                    }
                }
            }
        }
    }

  private:
    Index3 cell_index(const Vec3& place) const {
        const Eigen::Array3d raw = (place.array() * count_.cast<double>() / size_.array()).floor();
        return raw.max(0.0).min((count_ - 1).cast<double>()).cast<std::int64_t>();
    }
    std::size_t flat(const Index3& c) const {
        return static_cast<std::size_t>((c.z() * count_.y() + c.y()) * count_.x() + c.x());
    }
    std::size_t cell(const Vec3& place) const { return flat(cell_index(place)); }

    Vec3 size_;
    double largest_radius_ = 0.0;
    Index3 count_;
    std::vector<std::vector<std::uint32_t>> members_;
};

/// The steepest way down that leads into none of the contacts, whose normals point to the ball: the part of
/// -z that lies in the cone v . n >= 0 for all n. It is -z itself, or lies in the plane of one contact, or
/// along the line of two; of these, the longest that keeps clear of all contacts. Zero if the ball is held.
Vec3 way_down(const std::vector<Vec3>& normals) {
    const Vec3 down = -Vec3::UnitZ();
    Vec3 best = Vec3::Zero();
    const auto consider = [&](const Vec3& way) {
        if (way.squaredNorm() > best.squaredNorm() &&
            std::all_of(normals.begin(), normals.end(),
                        [&](const Vec3& normal) { return way.dot(normal) >= -1e-10 * way.norm(); })) {
            best = way;
        }
    };
    consider(down);
    for (std::size_t k = 0; k < normals.size(); ++k) {
        consider(down - down.dot(normals[k]) * normals[k]);
        for (std::size_t l = 0; l < k; ++l) {
            const Vec3 line = normals[k].cross(normals[l]);
            if (line.squaredNorm() > 1e-12) {
                consider(down.dot(line) / line.squaredNorm() * line);
            }
        }
    }
    return best;
}

/// One ball on its way down.
class Descent {
  public:
    Descent(BallsInBox& bed, const BallCells& cells, std::size_t ball)
        : bed_(bed), cells_(cells), ball_(ball) {}

    void run() {
        constexpr int max_steps = 1000;
        double travelled = margin;
        for (int step = 0; step < max_steps; ++step) {
            if (travelled > margin - longest_slide) {
                cells_.find_near(bed_, ball_, near_);
                travelled = 0.0;
            }
            find_contacts();
            Vec3 way = way_down(normals_);
            if (way.norm() < level) {
                return;
            }
            way.normalize();
            const double length =
                clear_of_ground(way, free_way(way, normals_.empty() ? margin - travelled : longest_slide));
            if (length == 0.0) {
                return; // held in a dip
            }
            bed_.center[ball_] += length * way;
            travelled += length;
        }
    }

  private:
    const Vec3& place() const { return bed_.center[ball_]; }
    double radius() const { return bed_.radius[ball_]; }

    void find_contacts() {
        normals_.clear();
        for (int axis = 0; axis < 3; ++axis) {
            if (place()[axis] - radius() < touching) {
                normals_.emplace_back(Vec3::Unit(axis));
            }
            if (axis < 2 && bed_.size[axis] - radius() - place()[axis] < touching) {
                normals_.emplace_back(-Vec3::Unit(axis));
            }
        }
        for (const Ball& other : near_) {
            const Vec3 apart = place() - other.center;
            const double separation = apart.norm();
            if (separation - radius() - other.radius < touching && separation > 0.0) {
                normals_.emplace_back(apart / separation);
            }
        }
        ground_gap_ = bed_.distance ? bed_.distance(place()) - radius() : HUGE_VAL;
        if (ground_gap_ < touching_ground) {
            normals_.push_back(ground_normal(bed_, ball_));
        }
    }

    /// How far the ball can go along `way` until it meets something that it does not touch yet.
    double free_way(const Vec3& way, double longest) const {
        double length = longest;
        for (int axis = 0; axis < 3; ++axis) {
            const double gap =
                way[axis] < 0.0 ? place()[axis] - radius() : bed_.size[axis] - radius() - place()[axis];
            if (gap >= touching) {
                length = std::min(length, gap / std::max(std::abs(way[axis]), 1e-12));
            }
        }
        for (const Ball& other : near_) {
            const Vec3 apart = place() - other.center;
            const double touch = radius() + other.radius;
            const double closing = -apart.dot(way);
            const double square = closing * closing - apart.squaredNorm() + touch * touch;
            if (closing > 0.0 && square > 0.0 && apart.norm() - touch >= touching) {
                length = std::min(length, closing - std::sqrt(square));
            }
        }
        if (ground_gap_ >= touching_ground) {
            length = std::min(length, ground_gap_);
        }
        return length;
    }

    /// The move shortened until it does not lead into what `distance` describes: where that is concave, the
    /// one normal that a ball has of it does not keep the ball out.
    double clear_of_ground(const Vec3& way, double length) const {
        if (!bed_.distance) {
            return length;
        }
        constexpr int most_halvings = 8;
        for (int i = 0; i < most_halvings; ++i, length *= 0.5) {
            if (bed_.distance(place() + length * way) > (1.0 - deepest_in_ground) * radius()) {
                return length;
            }
        }
        return 0.0;
    }

    BallsInBox& bed_;
    const BallCells& cells_;
    std::size_t ball_;
    std::vector<Ball> near_;
    std::vector<Vec3> normals_;
    double ground_gap_ = HUGE_VAL;
};

} // namespace

Vec3 ground_normal(const BallsInBox& bed, std::size_t i) {
    const double step = 1e-3 * bed.radius[i];
    Vec3 normal;
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3 offset = step * Vec3::Unit(axis);
        normal[axis] = bed.distance(bed.center[i] + offset) - bed.distance(bed.center[i] - offset);
    }
    const double length = normal.norm();
    return length > 1e-3 * step ? Vec3(normal / length) : Vec3(Vec3::UnitZ());
}

void settle_balls(BallsInBox& bed) {
    constexpr int max_sweeps = 1000;
    constexpr double still = 1e-4; // a sweep that moves no ball farther is the last
    BallCells cells(bed);
    std::vector<std::uint32_t> order(bed.center.size());
    std::iota(order.begin(), order.end(), 0u);
    for (int sweep = 0; sweep < max_sweeps; ++sweep) {
        std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
            return bed.center[a].z() - bed.radius[a] < bed.center[b].z() - bed.radius[b];
        });
        double farthest = 0.0;
        for (const std::uint32_t ball : order) {
            const Vec3 before = bed.center[ball];
            Descent(bed, cells, ball).run();
            cells.move(ball, before, bed.center[ball]);
            farthest = std::max(farthest, (bed.center[ball] - before).norm());
        }
        if (farthest < still) {
            return;
        }
    }
}

} // namespace meltscope
