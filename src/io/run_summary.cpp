#include "meltscope/io/run_summary.hpp"

#include "meltscope/io/atomic_file.hpp"
#include "posix_file.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <limits>

namespace meltscope {

namespace {

using Json = nlohmann::ordered_json;

Json to_object(const RunSummary::Figures& figures) {
    auto object = Json::object();
    for (const auto& [name, value] : figures)
        object[name] = value;
    return object;
}

double to_number(const Json& value) {
    return value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>();
}

RunSummary::Figures to_figures(const Json& object) {
    RunSummary::Figures figures;
    for (const auto& [name, value] : object.items())
        figures.emplace_back(name, to_number(value));
    return figures;
}

} // namespace

std::string to_json(const RunSummary& summary) {
    Json json;
    json["version"] = summary.version;
    json["git_hash"] = summary.git_hash;
    json["title"] = summary.title;
    json["outcome"] = summary.outcome;
    json["message"] = summary.message;
    json["threads"] = summary.threads;
    json["particles"] = summary.particles;
    json["steps"] = summary.steps;
    json["time"] = summary.time;
    json["wall_seconds"] = to_object(summary.wall_seconds);
    json["particle_steps_per_second"] = summary.particle_steps_per_second;
    json["ledger"] = to_object(summary.ledger);
    json["rendering"] = to_object(summary.rendering);
    // A title may hold bytes that are no UTF-8; a summary with a replacement mark beats none.
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

void write_run_summary(const std::filesystem::path& path, const RunSummary& summary) {
    write_file_atomically(path, to_json(summary));
}

RunSummary read_run_summary(const std::filesystem::path& path) {
    const auto text = read_file(path);
    try {
        const auto json = Json::parse(text);
        RunSummary summary;
        json.at("version").get_to(summary.version);
        json.at("git_hash").get_to(summary.git_hash);
        json.at("title").get_to(summary.title);
        json.at("outcome").get_to(summary.outcome);
        json.at("message").get_to(summary.message);
        json.at("threads").get_to(summary.threads);
        json.at("particles").get_to(summary.particles);
        json.at("steps").get_to(summary.steps);
        summary.time = to_number(json.at("time"));
        summary.wall_seconds = to_figures(json.at("wall_seconds"));
        summary.particle_steps_per_second = to_number(json.at("particle_steps_per_second"));
        summary.ledger = to_figures(json.at("ledger"));
        summary.rendering = to_figures(json.at("rendering"));
        return summary;
    } catch (const Json::exception& error) {
        throw RunSummaryError(fmt::format("{} is not a run summary: {}", path.string(), error.what()));
    }
}

} // namespace meltscope
