#pragma once

#include "meltscope/scenario/scenario.hpp"

#include <string>
#include <utility>
#include <vector>

/// The words of a scenario file and what they stand for; reader and writer share them.
namespace meltscope::words {

template <class E>
using Meanings = std::vector<std::pair<std::string, E>>;

inline const Meanings<PhysicsSpec::Diffusion> diffusion{{"temperature", PhysicsSpec::Diffusion::temperature},
                                                        {"energy", PhysicsSpec::Diffusion::energy}};
inline const Meanings<PhysicsSpec::Transfer> transfer{{"affine", PhysicsSpec::Transfer::affine},
                                                      {"flip", PhysicsSpec::Transfer::flip}};
inline const Meanings<PhysicsSpec::Deposit> deposit{{"surface", PhysicsSpec::Deposit::surface},
                                                    {"band", PhysicsSpec::Deposit::band}};
inline const Meanings<BeamProfile> profile{{"gaussian", BeamProfile::gaussian},
                                           {"top_hat", BeamProfile::top_hat},
                                           {"super_gaussian", BeamProfile::super_gaussian},
                                           {"volumetric", BeamProfile::volumetric}};
inline const Meanings<PercentileBasis> percentiles{{"number", PercentileBasis::number},
                                                   {"volume", PercentileBasis::volume}};
inline const Meanings<OutputSpec::Particles> particles{{"surface", OutputSpec::Particles::surface},
                                                       {"melt", OutputSpec::Particles::melt},
                                                       {"all", OutputSpec::Particles::all},
                                                       {"none", OutputSpec::Particles::none}};
inline const Meanings<OutputSpec::Compression> compression{{"none", OutputSpec::Compression::none},
                                                           {"lz4", OutputSpec::Compression::lz4},
                                                           {"zlib", OutputSpec::Compression::zlib}};
inline const Meanings<OutputSpec::Precision> precision{{"float32", OutputSpec::Precision::float32},
                                                       {"float64", OutputSpec::Precision::float64}};
inline const Meanings<OutputSpec::ParticlesFormat> particles_format{
    {"vtp", OutputSpec::ParticlesFormat::vtp}, {"vtu", OutputSpec::ParticlesFormat::vtu}};
inline const Meanings<OutputSpec::PoolRows> pool_rows{{"output", OutputSpec::PoolRows::output},
                                                      {"step", OutputSpec::PoolRows::step}};
inline const Meanings<RenderSpec::OnBacklog> on_backlog{{"wait", RenderSpec::OnBacklog::wait},
                                                        {"drop", RenderSpec::OnBacklog::drop}};
inline const Meanings<RenderSpec::Background> background{{"dark", RenderSpec::Background::dark},
                                                         {"light", RenderSpec::Background::light}};

/// The word for a value.
template <class E>
std::string of(const Meanings<E>& meanings, E value) {
    for (const auto& [word, meaning] : meanings) {
        if (meaning == value) {
            return word;
        }
    }
    return {};
}

} // namespace meltscope::words
