#include "meltscope/scenario/nearest_word.hpp"

#include <algorithm>
#include <cctype>
#include <cstddef>

namespace meltscope {
namespace {

char lower(char c) {
    return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
}

/// Optimal string alignment distance.
std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> before(b.size() + 1);
    std::vector<std::size_t> last(b.size() + 1);
    std::vector<std::size_t> row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) {
        last[j] = j;
    }
    for (std::size_t i = 1; i <= a.size(); ++i) {
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t changed = lower(a[i - 1]) == lower(b[j - 1]) ? 0 : 1;
            row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + changed});
            if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1])) {
                row[j] = std::min(row[j], before[j - 2] + 1);
            }
        }
        before.swap(last);
        last.swap(row);
    }
    return last[b.size()];
}

} // namespace

std::string nearest_word(std::string_view word, const std::vector<std::string>& candidates) {
    if (word.size() > 64) {
        return {};
    }
    std::string best;
    std::size_t best_distance = 0;
    for (const std::string& candidate : candidates) {
        // Half of the longer word wrong is no likeness; a word that only continues the typed one is.
        std::size_t distance = edit_distance(word, candidate);
        const std::size_t tolerated =
            std::max<std::size_t>(1, std::max(word.size(), candidate.size()) * 2 / 5);
        const bool beginning = word.size() >= 3 && candidate.starts_with(word);
        if ((distance > tolerated && !beginning) || (distance >= std::max(word.size(), candidate.size()))) {
            continue;
        }
        if (best.empty() || distance < best_distance) {
            best = candidate;
            best_distance = distance;
        }
    }
    return best;
}

} // namespace meltscope
