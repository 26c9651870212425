#include "machine_probe.hpp"

#include "stopwatch.hpp"

#include "meltscope/aligned.hpp"
#include "meltscope/lanes.hpp"

#include <omp.h>

#include <array>
#include <cstdint>
#include <vector>

namespace meltscope {
namespace {

constexpr int probe_runs = 7;
constexpr int chains = 12; ///< enough for two units of four cycles each, few enough for sixteen registers

/// Runs the chains `rounds` times; what they come to must be used, or the compiler leaves them out.
double multiply_add(std::int64_t rounds, double start) {
    std::array<Lanes, chains> x;
    for (int n = 0; n < chains; ++n)
        x[std::size_t(n)] = Lanes(start + n);
    const Lanes factor(0.999999), summand(1e-6);
    for (std::int64_t round = 0; round < rounds; ++round)
        for (Lanes& value : x)
            value = value * factor + summand;
    Lanes sum(0.0);
    for (const Lanes& value : x)
        sum += value;
    return reduce(sum);
}

} // namespace

double probe_fma_gflops() {
    constexpr std::int64_t rounds = 4'000'000;
    std::vector<double> rates;
    volatile double used = 0.0;
    for (int n = 0; n < probe_runs; ++n) {
        double total = 0.0;
        const Stopwatch watch;
#pragma omp parallel reduction(+ : total)
        total += multiply_add(rounds, 1.0 + n);
        const double seconds = watch.seconds();
        used = used + total;
        rates.push_back(2e-9 * double(rounds) * chains * lane_count * omp_get_max_threads() / seconds);
    }
    return median(rates);
}

double probe_triad_gb_per_s() {
    constexpr std::int64_t size = 8'000'000; // 64 MB an array
    Field a(size), b(size), c(size);
#pragma omp parallel for schedule(static)
    for (std::int64_t i = 0; i < size; ++i) {
        a[std::size_t(i)] = 0.0;
        b[std::size_t(i)] = 1.0;
        c[std::size_t(i)] = 2.0;
    }
    std::vector<double> rates;
    for (int n = 0; n < probe_runs; ++n) {
        const double scale = 3.0 + n;
        const Stopwatch watch;
#pragma omp parallel for schedule(static)
        for (std::int64_t i = 0; i < size; ++i)
            a[std::size_t(i)] = b[std::size_t(i)] + scale * c[std::size_t(i)];
        rates.push_back(24e-9 * double(size) / watch.seconds());
    }
    return median(rates);
}

} // namespace meltscope
