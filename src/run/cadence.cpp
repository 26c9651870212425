#include "meltscope/run/cadence.hpp"

#include <algorithm>
#include <cmath>

namespace meltscope {

bool same_instant(double a, double b) {
    if (a == never || b == never)
        return a == b;
    return std::abs(a - b) <= 1e-12 * std::max(std::abs(a), std::abs(b));
}

double next_due(const Cadence& cadence, double time) {
    if (!cadence.every)
        return never;
    const double every = *cadence.every;
    double k = std::floor(time / every);
    while (k * every <= time || same_instant(k * every, time))
        ++k;
    return k * every;
}

bool is_due(const Cadence& cadence, double time, std::int64_t step) {
    if (cadence.every && same_instant(std::round(time / *cadence.every) * *cadence.every, time))
        return true;
    return cadence.every_steps && step % *cadence.every_steps == 0;
}

} // namespace meltscope
