#include "viz/options.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace meltscope::viz {

namespace {

constexpr std::array<std::pair<Backend, std::string_view>, 6> backend_names{{{Backend::automatic, "auto"},
                                                                             {Backend::x11, "x11"},
                                                                             {Backend::xvfb, "xvfb"},
                                                                             {Backend::egl, "egl"},
                                                                             {Backend::osmesa, "osmesa"},
                                                                             {Backend::none, "none"}}};

void require_known(const std::string& word, const std::vector<std::string>& known, std::string_view kind) {
    if (std::find(known.begin(), known.end(), word) == known.end()) {
        throw VizError(
            fmt::format("there is no {} '{}'; choose from {}", kind, word, fmt::join(known, ", ")));
    }
}

} // namespace

const std::vector<std::string>& view_names() {
    static const std::vector<std::string> names{"overview", "section", "top", "pool", "dashboard"};
    return names;
}

const std::vector<std::string>& field_names() {
    static const std::vector<std::string> names{"temperature", "phi", "phi_hat", "mass"};
    return names;
}

Backend backend_from_name(std::string_view name) {
    std::vector<std::string_view> known;
    for (const auto& [backend, word] : backend_names) {
        if (word == name) {
            return backend;
        }
        known.push_back(word);
    }
    throw VizError(
        fmt::format("there is no render backend '{}'; choose from {}", name, fmt::join(known, ", ")));
}

std::string_view backend_name(Backend backend) {
    for (const auto& [candidate, word] : backend_names) {
        if (candidate == backend) {
            return word;
        }
    }
    return "unknown";
}

void validate(const RenderOptions& options) {
    for (const std::string& view : options.views) {
        require_known(view, view_names(), "view");
    }
    require_known(options.field, field_names(), "field");
    require_known(options.colormap, colormap_names(), "colour map");
    for (const int pixels : options.size) {
        if (pixels < 64 || pixels > 16384) {
            throw VizError(
                fmt::format("a picture of {} x {} pixels is not possible; each side must be 64 to 16384",
                            options.size[0], options.size[1]));
        }
    }
    if (options.color_range) {
        const auto [low, high] = *options.color_range;
        if (!std::isfinite(low) || !std::isfinite(high) || !(low < high)) {
            throw VizError(
                fmt::format("the colour range {} to {} is empty; the first must be the smaller", low, high));
        }
    }
}

} // namespace meltscope::viz
