#pragma once

#include "meltscope/run/snapshot.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace meltscope {

/// A box of nodes, first and last inclusive.
struct NodeRange {
    std::array<std::int64_t, 3> first{}, last{};
};

/// The regions of the material above an isotherm: nodes hotter than it, in the material or at its surface,
/// joined where they share a cell. The lattice and the fields must outlive the object.
class HotRegions {
  public:
    HotRegions(const NodeLattice& nodes, const std::vector<double>& temperature,
               const std::vector<double>& phi, double isotherm);

    int count() const { return count_; }
    /// What holds all regions and their neighbours.
    const NodeRange& box() const { return box_; }
    /// The region of a node of the box; -1 if it is in none.
    int at(std::int64_t i, std::int64_t j, std::int64_t k) const { return label_[slot(i, j, k)]; }
    /// The node in the fields.
    std::int64_t index(std::int64_t i, std::int64_t j, std::int64_t k) const {
        return i + nodes_.count[0] * (j + nodes_.count[1] * k);
    }
    /// m
    Vec3 place(std::int64_t i, std::int64_t j, std::int64_t k) const {
        return nodes_.origin + nodes_.spacing * Vec3(double(i), double(j), double(k));
    }

  private:
    std::size_t slot(std::int64_t i, std::int64_t j, std::int64_t k) const {
        return std::size_t((i - box_.first[0]) +
                           size_[0] * ((j - box_.first[1]) + size_[1] * (k - box_.first[2])));
    }
    bool belongs(std::int64_t node) const;
    bool find_box();
    void label();

    const NodeLattice& nodes_;
    const std::vector<double>& temperature_;
    const std::vector<double>& phi_;
    double isotherm_;
    NodeRange box_;
    std::array<std::int64_t, 3> size_{};
    std::vector<int> label_;
    int count_ = 0;
};

} // namespace meltscope
