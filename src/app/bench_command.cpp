#include "bench_report.hpp"
#include "bench_scenes.hpp"
#include "commands.hpp"
#include "exit_codes.hpp"
#include "text.hpp"

#include "meltscope/scenario/scenario_file.hpp"

#include <omp.h>

#include <memory>

namespace meltscope {
namespace {

struct BenchRequest {
    std::int64_t particles = 2'000'000;
    std::string scene = "all";
    std::string transfer = "both";
    int threads = 0;
    std::vector<std::string> overrides;
    bool json = false;
    bool in_situ = false;
};

int execute(BenchRequest request) {
    if (request.threads > 0)
        omp_set_num_threads(request.threads);
    // Last, so that it counts more than what else is set.
    if (request.transfer != "both")
        request.overrides.push_back("physics.transfer=" + request.transfer);
    const bool both = request.transfer == "both" && !request.in_situ;
    std::vector<SceneFigures> scenes;
    const auto measure = [&](const std::string& name, const Scenario& scenario) {
        scenes.push_back(measure_scene(name, scenario, both, request.in_situ && scenes.empty()));
    };
    if (request.scene == "block" || request.scene == "all")
        measure("block", bench_block(request.particles, request.overrides));
    if (request.scene == "powder" || (request.scene == "all" && !request.in_situ))
        measure("powder", bench_powder(request.particles, request.overrides));
    if (scenes.empty())
        measure(request.scene, read_scenario(request.scene, request.overrides));
    print_result(request.json ? bench_json(scenes) : bench_text(scenes));
    return exit_code::done;
}

} // namespace

void add_bench(CLI::App& program, Action& chosen) {
    auto request = std::make_shared<BenchRequest>();
    CLI::App* bench = program.add_subcommand(
        "bench", "Measure the speed of the solver on this machine, and what the machine allows");
    bench
        ->add_option("--particles", request->particles,
                     "Particles of block and powder, about; default 2000000")
        ->type_name("N")
        ->check(CLI::Range(std::int64_t(1000), std::int64_t(4'000'000'000)));
    bench
        ->add_option("--scene", request->scene,
                     "block, powder, all (both of them, default), or a scenario file")
        ->type_name("SCENE");
    bench->add_option("--transfer", request->transfer, "affine, flip or both; default both")
        ->type_name("FORM")
        ->check(CLI::IsMember({"affine", "flip", "both"}));
    bench->add_option("--threads", request->threads, "Threads; default all cores, against one")
        ->type_name("N")
        ->check(CLI::Range(1, 4096));
    bench
        ->add_option("--set", request->overrides,
                     "Change a setting, e.g. physics.evaporation=true; repeatable")
        ->type_name("KEY=VALUE")
        ->expected(1)
        ->take_all();
    bench->add_flag("--json", request->json, "Print JSON");
    bench->add_flag("--insitu", request->in_situ,
                    "Measure also what an overview picture and data files every 50 steps cost");
    bench->footer("Figures are medians of several repetitions; the forms of the step take turns.\n"
                  "Example:\n  meltscope bench --particles 500000 --scene all --json");
    bench->callback([request, &chosen] { chosen = [request] { return execute(*request); }; });
}

} // namespace meltscope
