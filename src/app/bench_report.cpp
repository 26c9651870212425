#include "bench_report.hpp"

#include "meltscope/lanes.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace meltscope {
namespace {

using Json = nlohmann::ordered_json;

Json seconds_json(const SpeedFigures& speed) {
    Json json = {{"step", speed.step_seconds}};
    for (std::size_t n = 0; n < all_phases.size(); ++n)
        json[phase_name(all_phases[n])] = speed.phases[n];
    json["rest"] = speed.rest_seconds;
    return json;
}

Json insitu_json(const InSituCost& cost) {
    return {{"steps_between_outputs", cost.steps},
            {"seconds_without", cost.without_seconds},
            {"seconds_with", cost.with_seconds},
            {"ratio", cost.ratio()},
            {"frames", cost.frames},
            {"files", cost.files},
            {"seconds_of_a_frame", cost.render_seconds},
            {"seconds_of_files", cost.file_seconds},
            {"seconds_of_a_snapshot", cost.snapshot_seconds},
            {"seconds_of_a_frame_alone", cost.overview_seconds},
            {"seconds_of_a_dashboard_alone", cost.dashboard_seconds}};
}

Json scene_json(const SceneFigures& figures) {
    Json forms = Json::array();
    for (const SpeedFigures& speed : figures.speed)
        forms.push_back({{"transfer", speed.transfer},
                         {"threads", speed.threads},
                         {"particle_steps_per_s", speed.particle_steps_per_s},
                         {"share_of_limit", speed.particle_steps_per_s / figures.limit()},
                         {"seconds", seconds_json(speed)}});
    const SetupFigures& setup = figures.setup;
    return {{"scene", figures.scene},
            {"particles", figures.particles},
            {"nodes", figures.nodes},
            {"layout_entries", figures.entries},
            {"fma_gflops", figures.fma_gflops},
            {"triad_gb_per_s", figures.triad_gb_per_s},
            {"forms", forms},
            {"setup",
             {{"packing_seconds", setup.packing_seconds},
              {"filling_seconds", setup.filling_seconds},
              {"preparing_seconds", setup.preparing_seconds},
              {"surface_seconds", setup.surface_seconds},
              {"elements_seconds", setup.elements_seconds},
              {"nodes_in_band", setup.nodes_in_band},
              {"node_updates_per_s", setup.node_updates_per_s()}}},
            {"memory",
             {{"peak_bytes", setup.peak_bytes},
              {"held_bytes_a_particle", setup.bytes_a_particle},
              {"held_bytes_a_node", setup.bytes_a_node}}}};
}

void add_line(std::string& text, const char* name, const std::string& value) {
    text += fmt::format("  {:<26} {}\n", name, value);
}

void add_scene(std::string& text, const SceneFigures& f) {
    text +=
        fmt::format("{}: {} particles, {} nodes, SIMD width {}\n", f.scene, f.particles, f.nodes, lane_count);
    add_line(text, "FMA probe", fmt::format("{:.1f} GFLOP/s", f.fma_gflops));
    add_line(text, "STREAM triad", fmt::format("{:.1f} GB/s", f.triad_gb_per_s));
    add_line(text, "what these allow",
             fmt::format("{:.0f} M particle-steps/s (800 operations, 128 bytes each)", 1e-6 * f.limit()));
    add_line(text, "padding",
             fmt::format("{:.2f} entries a particle", double(f.entries) / double(f.particles)));

    text += fmt::format("  {:<10}{:>8}{:>10}{:>8}   milliseconds of a step\n", "transfer", "threads",
                        "M p-s/s", "share");
    text += fmt::format("  {:<36}", "");
    for (const StepPhase phase : all_phases)
        text += fmt::format("{:>9}", phase_name(phase));
    text += fmt::format("{:>9}{:>9}\n", "rest", "all");
    for (const SpeedFigures& s : f.speed) {
        text += fmt::format("  {:<10}{:>8}{:>10.1f}{:>7.0f}%", s.transfer, s.threads,
                            1e-6 * s.particle_steps_per_s, 100.0 * s.particle_steps_per_s / f.limit());
        for (const double seconds : s.phases)
            text += fmt::format("{:>9.2f}", 1e3 * seconds);
        text += fmt::format("{:>9.2f}{:>9.2f}\n", 1e3 * s.rest_seconds, 1e3 * s.step_seconds);
    }

    const SetupFigures& setup = f.setup;
    text += "  set-up\n";
    add_line(text, "packing, reading files", fmt::format("{:.3f} s", setup.packing_seconds));
    add_line(text, "filling with particles", fmt::format("{:.3f} s", setup.filling_seconds));
    add_line(text, "layout, nodes, surface", fmt::format("{:.3f} s", setup.preparing_seconds));
    add_line(text, "of it level set, weights",
             fmt::format("{:.3f} s for {} nodes in the band: {:.1f} M nodes/s", setup.surface_seconds,
                         setup.nodes_in_band, 1e-6 * setup.node_updates_per_s()));
    add_line(text, "of it surface elements", fmt::format("{:.3f} s", setup.elements_seconds));
    text += "  memory\n";
    add_line(text, "held",
             fmt::format("{:.0f} bytes a particle and {:.0f} bytes a node", setup.bytes_a_particle,
                         setup.bytes_a_node));
    const double of_nodes = setup.bytes_a_node * double(f.nodes);
    add_line(text, "peak",
             fmt::format("{:.2f} GB: {:.0f} bytes a particle beside what the nodes hold",
                         1e-9 * setup.peak_bytes, (setup.peak_bytes - of_nodes) / double(f.particles)));
}

void add_insitu(std::string& text, const InSituCost& cost) {
    text += fmt::format("Seconds of {} steps, medians of turns\n", cost.steps);
    add_line(text, "without output", fmt::format("{:.3f}", cost.without_seconds));
    add_line(text, "with pictures and files", fmt::format("{:.3f}", cost.with_seconds));
    add_line(text, "ratio", fmt::format("{:.3f}", cost.ratio()));
    add_line(text, "one snapshot", fmt::format("{:.3f}", cost.snapshot_seconds));
    add_line(text, "one overview picture",
             fmt::format("{:.3f} beside the solver, {:.3f} while it rests", cost.render_seconds,
                         cost.overview_seconds));
    add_line(text, "one dashboard", fmt::format("{:.3f} while the solver rests", cost.dashboard_seconds));
    add_line(text, "one output's data files", fmt::format("{:.3f} beside the solver", cost.file_seconds));
}

} // namespace

std::string bench_json(const std::vector<SceneFigures>& scenes) {
    const SceneFigures& first = scenes.front();
    const SpeedFigures& speed = first.speed.front();
    Json json = {{"particle_steps_per_s", speed.particle_steps_per_s},
                 {"fma_gflops", first.fma_gflops},
                 {"triad_gb_per_s", first.triad_gb_per_s},
                 {"share_of_limit", speed.particle_steps_per_s / first.limit()},
                 {"particles", first.particles},
                 {"threads", speed.threads},
                 {"simd_width", lane_count},
                 {"seconds", seconds_json(speed)},
                 {"scenes", Json::array()}};
    for (const SceneFigures& figures : scenes) {
        json["scenes"].push_back(scene_json(figures));
        if (figures.in_situ)
            json["insitu"] = insitu_json(*figures.in_situ);
    }
    return json.dump(2) + "\n";
}

std::string bench_text(const std::vector<SceneFigures>& scenes) {
    std::string text;
    for (const SceneFigures& figures : scenes) {
        add_scene(text, figures);
        if (figures.in_situ)
            add_insitu(text, *figures.in_situ);
    }
    return text;
}

} // namespace meltscope
