#pragma once

#include "plate.hpp"

#include "meltscope/aligned.hpp"

#include <cstdint>

namespace meltscope::benchmarks {

/// The plate by the plainest fast means there are, for comparison: central differences of seven points on
/// the nodes of a uniform grid, forward Euler, the beam's power put into the half cells of the top, adiabatic
/// faces by mirror images. All threads; double precision.
class FiniteDifferences {
  public:
    explicit FiniteDifferences(const PlateCells& cells);

    /// Steps through the whole track in equal steps, each at most dx^2/(6 alpha), the limit of stability.
    void run();

    /// Rise in K at node (i, j, k), k from the bottom.
    double rise(std::int64_t i, std::int64_t j, std::int64_t k) const {
        return rise_[i + nx_ * (j + ny_ * k)];
    }

    std::int64_t steps() const { return steps_; }
    std::int64_t nodes() const { return nx_ * ny_ * nz_; }

  private:
    void step(double dt, double beam);

    double dx_;
    std::int64_t nx_, ny_, nz_, steps_;
    Field rise_, next_;    // K
    Field across_, along_; // shares of the power that each line of cells takes
};

} // namespace meltscope::benchmarks
