#include "meltscope/run/ledger.hpp"

#include <algorithm>
#include <cmath>

namespace meltscope {

double Ledger::relative_residual() const {
    const double gained = absorbed + face_flux_in + added - lost() - conducted_out;
    const double scale = std::max({std::abs(stored), std::abs(stored_at_start), std::abs(absorbed)});
    return scale > 0.0 ? (stored - stored_at_start - gained) / scale : 0.0;
}

std::vector<std::pair<const char*, double>> in_words(const Ledger& ledger) {
    std::vector<std::pair<const char*, double>> entries{
        {"emitted by the lasers", ledger.emitted},
        {"missed the material", ledger.missed},
        {"reflected", ledger.reflected},
        {"absorbed", ledger.absorbed},
        {"flowed in through faces", ledger.face_flux_in},
        {"added with particles", ledger.added},
        {"radiated", ledger.radiated},
        {"convected", ledger.convected},
        {"evaporated", ledger.evaporated},
        {"conducted out through faces", ledger.conducted_out},
        {"change of what is stored", ledger.stored - ledger.stored_at_start}};
    std::erase_if(entries, [](const auto& entry) { return entry.second == 0.0; });
    return entries;
}

} // namespace meltscope
