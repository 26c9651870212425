#include "balls_in_box.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace meltscope {

namespace {

/// Pairs of balls that are or may soon be in touch; the first always moves. Ball i >= count of moving ones is
/// fixed ball i - count.
class PairList {
  public:
    explicit PairList(const BallsInBox& bed) {
        for (const double radius : bed.radius) {
            largest_radius_ = std::max(largest_radius_, radius);
        }
        fixed_ = bed.fixed;
        for (const Ball& ball : fixed_) {
            largest_radius_ = std::max(largest_radius_, ball.radius);
        }
        rebuild(bed);
    }

    /// Lists anew if the balls have moved so far that a pair could be missing.
    void update(const BallsInBox& bed) {
        const double far = 0.25 * margin * margin;
        for (std::size_t i = 0; i < bed.center.size(); ++i) {
            if ((bed.center[i] - listed_at_[i]).squaredNorm() > far) {
                rebuild(bed);
                return;
            }
        }
    }

    const std::vector<std::pair<std::uint32_t, std::uint32_t>>& pairs() const { return pairs_; }

  private:
    static constexpr double margin = 0.15; ///< gap up to which pairs are listed

    void rebuild(const BallsInBox& bed) {
        listed_at_ = bed.center;
        const std::size_t moving = bed.center.size();
        const std::size_t all = moving + fixed_.size();
        const auto place = [&](std::size_t i) -> const Vec3& {
            return i < moving ? bed.center[i] : fixed_[i - moving].center;
        };
        const auto reach = [&](std::size_t i) {
            return i < moving ? bed.radius[i] : fixed_[i - moving].radius;
        };

        // Cells no smaller than the largest distance at which a pair is listed; what lies outside the box is
        // counted to the nearest cell, which keeps neighbours in neighbouring cells.
        const double cell = 2.0 * largest_radius_ + margin;
        const Index3 count = (bed.size.array() / cell).floor().max(1.0).cast<std::int64_t>();
        const auto cell_of = [&](std::size_t i) {
            const Eigen::Array3d raw = (place(i).array() * count.cast<double>() / bed.size.array()).floor();
            return Index3(raw.max(0.0).min((count - 1).cast<double>()).cast<std::int64_t>());
        };
        const auto flat = [&](const Index3& c) {
            return static_cast<std::size_t>((c.z() * count.y() + c.y()) * count.x() + c.x());
        };
        std::vector<std::vector<std::uint32_t>> members(static_cast<std::size_t>(count.prod()));
        for (std::size_t i = 0; i < all; ++i) {
            members[flat(cell_of(i))].push_back(static_cast<std::uint32_t>(i));
        }

        pairs_.clear();
        for (std::size_t i = 0; i < moving; ++i) {
            const Index3 home = cell_of(i);
            const Index3 low = (home - 1).max(0);
            const Index3 high = (home + 1).min(count - 1);
            for (Index3 c = low; c.z() <= high.z(); ++c.z()) {
                for (c.y() = low.y(); c.y() <= high.y(); ++c.y()) {
                    for (c.x() = low.x(); c.x() <= high.x(); ++c.x()) {
                        for (const std::uint32_t j : members[flat(c)]) {
                            const double near = reach(i) + reach(j) + margin;
                            if (j > i && (place(j) - place(i)).squaredNorm() < near * near) {
                                pairs_.emplace_back(static_cast<std::uint32_t>(i), j);
                            }
                        }
                    }
                }
            }
        }
    }

    double largest_radius_ = 0.0;
    std::vector<Ball> fixed_;
    std::vector<Vec3> listed_at_;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs_;
};

/// Asks the distance function only where a ball may be in touch: the distance cannot fall faster than a ball
/// moves.
class GroundContact {
  public:
    explicit GroundContact(const BallsInBox& bed)
        : asked_at_(bed.center.size(), Vec3::Constant(HUGE_VAL)), answer_(bed.center.size(), 0.0) {}

    /// Depth of ball i's lowest point below the surface; above zero in touch.
    double depth(const BallsInBox& bed, std::size_t i) {
        const double moved = (bed.center[i] - asked_at_[i]).norm();
        if (!(answer_[i] - moved > bed.radius[i])) {
            answer_[i] = bed.distance(bed.center[i]);
            asked_at_[i] = bed.center[i];
            return bed.radius[i] - answer_[i];
        }
        return 0.0;
    }

  private:
    std::vector<Vec3> asked_at_;
    std::vector<double> answer_;
};

/// Elastic forces of stiffness one on every moving ball; returns the largest overlap by diameter.
double compute_forces(const BallsInBox& bed, const PairList& list, GroundContact& ground,
                      std::vector<Vec3>& force) {
    const std::size_t moving = bed.center.size();
    double worst = 0.0;
    for (std::size_t i = 0; i < moving; ++i) {
        const double radius = bed.radius[i];
        force[i].setZero();
        if (bed.distance) {
            const double depth = ground.depth(bed, i);
            if (depth > 0.0) {
                force[i] = depth * ground_normal(bed, i);
                worst = std::max(worst, 0.5 * depth / radius);
            }
        }
    }
    for (const auto& [i, j] : list.pairs()) {
        const bool moves = j < moving;
        const Vec3 apart = bed.center[i] - (moves ? bed.center[j] : bed.fixed[j - moving].center);
        const double radius = moves ? bed.radius[j] : bed.fixed[j - moving].radius;
        const double touch = bed.radius[i] + radius;
        const double square = apart.squaredNorm();
        if (square >= touch * touch) {
            continue;
        }
        const double separation = std::sqrt(square);
        const Vec3 normal = separation > 0.0 ? Vec3(apart / separation) : Vec3(Vec3::UnitZ());
        const Vec3 push = (touch - separation) * normal;
        force[i] += push;
        if (moves) {
            force[j] -= push;
        }
        worst = std::max(worst, 0.5 * (touch - separation) / std::min(bed.radius[i], radius));
    }
    return worst;
}

} // namespace

bool part_balls(BallsInBox& bed, double allowed_overlap) {
    const std::size_t count = bed.center.size();
    PairList list(bed);
    GroundContact ground(bed);
    std::vector<Vec3> force(count, Vec3::Zero());
    std::vector<Vec3> velocity(count, Vec3::Zero());
    // FIRE with its authors' parameters; masses and stiffness are one, a ball has about ten contacts.
    constexpr int max_steps = 6000;
    constexpr double start_mixing = 0.1;
    constexpr double longest_dt = 0.3;
    constexpr double longest_move = 0.05; // less than what pairs are listed ahead for
    double dt = 0.1;
    double mixing = start_mixing;
    int steps_downhill = 0;
    for (int step = 0; step < max_steps; ++step) {
        list.update(bed);
        if (compute_forces(bed, list, ground, force) <= allowed_overlap) {
            return true;
        }
        double power = 0.0;
        double force_square = 0.0;
        double velocity_square = 0.0;
        for (std::size_t i = 0; i < count; ++i) {
            velocity[i] += dt * force[i];
            power += force[i].dot(velocity[i]);
            force_square += force[i].squaredNorm();
            velocity_square += velocity[i].squaredNorm();
        }
        if (power > 0.0) {
            const double turn = mixing * std::sqrt(velocity_square / force_square);
            for (std::size_t i = 0; i < count; ++i) {
                velocity[i] = (1.0 - mixing) * velocity[i] + turn * force[i];
            }
            if (++steps_downhill > 5) {
                dt = std::min(1.1 * dt, longest_dt);
                mixing *= 0.99;
            }
        } else {
            std::fill(velocity.begin(), velocity.end(), Vec3::Zero());
            dt *= 0.5;
            mixing = start_mixing;
            steps_downhill = 0;
        }
        for (std::size_t i = 0; i < count; ++i) {
            const double length = dt * velocity[i].norm();
            if (length > longest_move) {
                velocity[i] *= longest_move / length;
            }
            const Eigen::Array3d reach = Eigen::Array3d::Constant(bed.radius[i]);
            const Eigen::Array3d moved = bed.center[i] + dt * velocity[i];
            bed.center[i] = moved.max(reach).min(bed.size.array() - reach); // the sides are hard
        }
    }
    return false;
}

double largest_overlap(const BallsInBox& bed) {
    std::vector<Vec3> unused(bed.center.size());
    GroundContact ground(bed);
    return compute_forces(bed, PairList(bed), ground, unused);
}

} // namespace meltscope
