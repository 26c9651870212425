#pragma once

#include <utility>
#include <vector>

namespace meltscope {

/// Where the energy went, J since the start. absorbed + faces - losses = change of what the particles hold.
struct Ledger {
    double emitted = 0.0;         ///< by the lasers while on
    double absorbed = 0.0;        ///< from the lasers into the material
    double missed = 0.0;          ///< light that met no material
    double reflected = 0.0;       ///< light that met material and was not absorbed
    double radiated = 0.0;        ///< net loss from the free surface by radiation
    double convected = 0.0;       ///< loss from the free surface and from faces by convection
    double evaporated = 0.0;      ///< loss from the free surface by evaporation
    double conducted_out = 0.0;   ///< through faces of fixed temperature
    double face_flux_in = 0.0;    ///< through faces of fixed flux
    double added = 0.0;           ///< held by particles that were added during the run
    double stored_at_start = 0.0; ///< sum of m_p e_p
    double stored = 0.0;          ///< sum of m_p e_p when last worked out

    /// What surfaces and faces have taken from the material, J.
    double lost() const { return radiated + convected + evaporated; }

    /// Energy that is unaccounted for, as a share of the larger of what was absorbed and what is stored:
    /// round-off.
    double relative_residual() const;
};

/// The entries that are not zero, J, each with what it is in words, for people; the change of what is stored
/// comes last.
std::vector<std::pair<const char*, double>> in_words(const Ledger& ledger);

} // namespace meltscope
