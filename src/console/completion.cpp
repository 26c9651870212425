#include "meltscope/console/commands.hpp"
#include "meltscope/console/parameters.hpp"
#include "meltscope/scenario/scenario.hpp"

#include <algorithm>
#include <filesystem>

namespace meltscope {
namespace {

std::vector<std::string> beginning_with(const std::string& word, const std::vector<std::string>& candidates) {
    std::vector<std::string> fitting;
    for (const std::string& candidate : candidates)
        if (candidate.starts_with(word))
            fitting.push_back(candidate);
    return fitting;
}

std::vector<std::string> command_names() {
    std::vector<std::string> names;
    for (const Command& command : command_table())
        names.push_back(command.name);
    return names;
}

std::vector<std::string> files(const std::string& word) {
    const std::filesystem::path given = word;
    const std::filesystem::path folder = given.has_parent_path() ? given.parent_path() : ".";
    const std::string beginning = given.filename().string();
    std::vector<std::string> found;
    std::error_code unreadable;
    for (const auto& entry : std::filesystem::directory_iterator(folder, unreadable)) {
        const std::string name = entry.path().filename().string();
        std::error_code gone;
        if (name.starts_with(beginning) && (name[0] != '.' || beginning.starts_with('.')))
            found.push_back((given.has_parent_path() ? (given.parent_path() / name).string() : name) +
                            (entry.is_directory(gone) ? "/" : ""));
    }
    std::sort(found.begin(), found.end());
    return found;
}

/// The words that begin so, of both lists.
std::vector<std::string> beginning_with(const std::string& word, std::vector<std::string> candidates,
                                        const std::vector<std::string>& more) {
    candidates.insert(candidates.end(), more.begin(), more.end());
    return beginning_with(word, candidates);
}

/// The names of the lasers where one has to be told from others.
std::vector<std::string> lasers_to_name(const CompletionNames& names) {
    return names.lasers.size() > 1 ? names.lasers : std::vector<std::string>();
}

bool is_one_of(const std::string& word, const std::vector<std::string>& words) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

std::vector<std::string> path_words(const std::vector<std::string>& words, const CompletionNames& names) {
    const std::string& word = words.back();
    if (is_one_of(words[words.size() - 2], {"load", "append"}))
        return files(word);
    if (words.size() == 2)
        return beginning_with(word, path_verbs(), lasers_to_name(names));
    if (words.size() == 3 && is_one_of(words[1], lasers_to_name(names)))
        return beginning_with(word, path_verbs());
    return beginning_with(word, path_keywords());
}

std::vector<std::string> layer_words(const std::vector<std::string>& words, const CompletionNames& names) {
    const std::string& before = words[words.size() - 2];
    if (before == "material")
        return beginning_with(words.back(), names.materials);
    if (before == "basis")
        return beginning_with(words.back(), {"number", "volume"});
    return beginning_with(words.back(), layer_keywords());
}

/// Words that may stand as the value of a parameter.
std::vector<std::string> values_of(const std::string& name, const CompletionNames& names) {
    if (name == "render.field")
        return names.fields;
    const std::string last = name.substr(name.rfind('.') + 1);
    for (const Parameter& parameter : parameters_of({Laser{}}))
        if (parameter.name == name || (name.starts_with("laser.") && parameter.name == "laser." + last))
            return parameter.words;
    return {};
}

} // namespace

std::vector<std::string> completions(std::string_view line, const CompletionNames& names) {
    std::vector<std::string> words;
    try {
        words = split_words(line);
    } catch (const CommandError&) {
        return {};
    }
    if (words.empty() || line.back() == ' ' || line.back() == '\t')
        words.emplace_back();
    const std::string word = words.back();
    if (words.size() == 1)
        return beginning_with(word, command_names());
    const Command* command = nullptr;
    try {
        command = &find_command(words[0]);
    } catch (const CommandError&) {
        return {};
    }
    switch (command->completes) {
    case Completes::nothing:
        return {};
    case Completes::command:
        if (command->name == "help")
            return words.size() == 2 ? beginning_with(word, command_names(), names.parameters)
                                     : std::vector<std::string>();
        for (std::size_t n = 2; n + 1 < words.size(); ++n) // at TIME [UNIT] COMMAND ...
            if (const auto known = command_names();
                std::find(known.begin(), known.end(), words[n]) != known.end()) {
                std::string rest;
                for (std::size_t m = n; m + 1 < words.size(); ++m)
                    rest += as_word(words[m]) + " ";
                return completions(rest + word, names);
            }
        return words.size() < 3 ? std::vector<std::string>() : beginning_with(word, command_names());
    case Completes::parameter:
        return words.size() == 2        ? beginning_with(word, names.parameters)
               : command->name == "set" ? beginning_with(word, values_of(words[1], names))
                                        : std::vector<std::string>();
    case Completes::file:
        return words.size() == 2 ? files(word) : std::vector<std::string>();
    case Completes::view:
        return beginning_with(word, view_names());
    case Completes::field:
        return beginning_with(word, names.fields);
    case Completes::laser:
        return words.size() == 2 ? beginning_with(word, lasers_to_name(names)) : std::vector<std::string>();
    case Completes::path_verb:
        return path_words(words, names);
    case Completes::layer_word:
        return layer_words(words, names);
    }
    return {};
}

} // namespace meltscope
