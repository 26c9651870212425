#include "meltscope/run/ledger.hpp"

#include <algorithm>
#include <cmath>

namespace meltscope {

double Ledger::relative_residual() const {
    const double gained = absorbed + face_flux_in + added - lost() - conducted_out;
    const double scale = std::max({std::abs(stored), std::abs(stored_at_start), std::abs(absorbed)});
    return scale > 0.0 ? (stored - stored_at_start - gained) / scale : 0.0;
}

} // namespace meltscope
