#include "finite_differences.hpp"

namespace meltscope::benchmarks {
namespace {

/// Share of a Gaussian beam at `centre` (m) that falls on the cell of each node along a line that begins at
/// `first`.
void beam_shares(double first, double dx, double centre, Field& share) {
    const double sigma = 0.25 * Plate::d4sigma;
    const auto up_to = [&](double x) { return 0.5 * std::erf((x - centre) / (std::sqrt(2.0) * sigma)); };
    const std::int64_t last = std::int64_t(share.size()) - 1;
    double before = up_to(first);
    for (std::int64_t i = 0; i <= last; ++i) {
        const double after = up_to(i == last ? first + double(i) * dx : first + (double(i) + 0.5) * dx);
        share[i] = after - before;
        before = after;
    }
}

} // namespace

FiniteDifferences::FiniteDifferences(const PlateCells& cells)
    : dx_(cells.dx), nx_(cells.x + 1), ny_(cells.y + 1), nz_(cells.z + 1),
      steps_(std::int64_t(std::ceil(Plate::end_time * 6.0 * Plate::diffusivity / (dx_ * dx_)))),
      rise_(nodes(), 0.0), next_(nodes(), 0.0), across_(ny_, 0.0), along_(nx_, 0.0) {
    beam_shares(-0.5 * Plate::width, dx_, 0.0, across_);
}

void FiniteDifferences::run() {
    const double dt = Plate::end_time / double(steps_);
    for (std::int64_t n = 0; n < steps_; ++n)
        step(dt, Plate::start + Plate::speed * (double(n) + 0.5) * dt);
}

void FiniteDifferences::step(double dt, double beam) {
    beam_shares(0.0, dx_, beam, along_);
    const double a = Plate::diffusivity * dt / (dx_ * dx_);
    const double keep = 1.0 - 6.0 * a;
    // The top's cells are half as high; so are those at the sides as wide.
    const double heat =
        Plate::absorbed_power * dt / (Plate::density * Plate::heat_capacity * 0.5 * dx_ * dx_ * dx_);
    const std::int64_t plane = nx_ * ny_;
#pragma omp parallel for collapse(2) schedule(static)
    for (std::int64_t k = 0; k < nz_; ++k)
        for (std::int64_t j = 0; j < ny_; ++j) {
            const auto mirrored = [](std::int64_t n, std::int64_t count) {
                return n < 0 ? 1 : n == count ? count - 2 : n;
            };
            const double* row = &rise_[nx_ * j + plane * k];
            const double* south = &rise_[nx_ * mirrored(j - 1, ny_) + plane * k];
            const double* north = &rise_[nx_ * mirrored(j + 1, ny_) + plane * k];
            const double* below = &rise_[nx_ * j + plane * mirrored(k - 1, nz_)];
            const double* above = &rise_[nx_ * j + plane * mirrored(k + 1, nz_)];
            double* to = &next_[nx_ * j + plane * k];
            const auto update = [&](std::int64_t i, std::int64_t west, std::int64_t east) {
                return keep * row[i] +
                       a * ((row[west] + row[east]) + (south[i] + north[i]) + (below[i] + above[i]));
            };
            to[0] = update(0, 1, 1);
#pragma omp simd
            for (std::int64_t i = 1; i < nx_ - 1; ++i)
                to[i] = update(i, i - 1, i + 1);
            to[nx_ - 1] = update(nx_ - 1, nx_ - 2, nx_ - 2);
            if (k == nz_ - 1) {
                const double line = heat * across_[j] * (j == 0 || j == ny_ - 1 ? 2.0 : 1.0);
                to[0] += 2.0 * line * along_[0];
#pragma omp simd
                for (std::int64_t i = 1; i < nx_ - 1; ++i)
                    to[i] += line * along_[i];
                to[nx_ - 1] += 2.0 * line * along_[nx_ - 1];
            }
        }
    rise_.swap(next_);
}

} // namespace meltscope::benchmarks
