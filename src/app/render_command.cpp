#include "commands.hpp"
#include "exit_codes.hpp"
#include "run_outputs.hpp"
#include "run_setup.hpp"

#include "viz/movie.hpp"
#include "viz/pipeline.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>

namespace meltscope {
namespace {

namespace fs = std::filesystem;

/// What is not set stays as the scenario has it.
struct RenderRequest {
    fs::path folder;
    fs::path output; ///< empty: the run folder
    std::vector<std::string> views;
    std::string field, colormap, background;
    std::vector<double> color_range;
    std::vector<int> size;
    std::string backend = "auto";
    bool overwrite = false;
};

viz::RenderOptions options_of(const RenderRequest& request, const RenderSpec& spec, const fs::path& folder) {
    viz::RenderOptions options;
    options.run_dir = folder;
    options.size = request.size.empty() ? spec.size : std::array{request.size[0], request.size[1]};
    options.views = request.views.empty() ? spec.views : request.views;
    if (!request.field.empty())
        options.field = request.field;
    options.color_range = request.field.empty() || request.field == "temperature"
                              ? spec.color_range
                              : std::nullopt; // the scenario's range is one of temperatures
    if (!request.color_range.empty())
        options.color_range = {request.color_range[0], request.color_range[1]};
    options.colormap = request.colormap.empty() ? spec.colormap : request.colormap;
    const bool light = request.background.empty() ? spec.background == RenderSpec::Background::light
                                                  : request.background == "light";
    options.background = light ? viz::Background::light : viz::Background::dark;
    return options;
}

/// Pictures that are there already are refused or removed: two rows under one name make no movie.
void make_room(const RunPaths& paths, const std::vector<std::string>& views, bool overwrite) {
    for (const std::string& there : viz::views_with_frames(paths.frames())) {
        if (std::find(views.begin(), views.end(), there) == views.end())
            continue;
        if (!overwrite)
            throw UsageError(fmt::format("{} holds pictures of \"{}\" already: name another folder with "
                                         "--output, or replace them with --overwrite",
                                         paths.frames().string(), there));
        std::vector<fs::path> old;
        for (const auto& entry : fs::directory_iterator(paths.frames()))
            if (entry.path().filename().string().starts_with(there + "_"))
                old.push_back(entry.path());
        for (const fs::path& picture : old)
            fs::remove(picture);
    }
}

std::shared_ptr<const Snapshot> snapshot_of(InputOfRun input) {
    const PreparedRun prepared = prepare_run(std::move(input));
    return std::make_shared<const Snapshot>(take_snapshot(prepared.run.simulation, ParticleSelection::none));
}

int execute(const RenderRequest& request) {
    const std::vector<CheckpointFile> checkpoints = list_checkpoints(RunPaths{request.folder});
    if (checkpoints.empty())
        throw UsageError(
            fmt::format("{} holds no checkpoints (checkpoints/step_000000500.h5): give the folder "
                        "of a run that made some, see [checkpoint] every and keep",
                        request.folder.string()));
    const RunPaths output{request.output.empty() ? request.folder : request.output};
    const viz::Backend backend = [&] {
        try {
            return viz::backend_from_name(request.backend);
        } catch (const viz::VizError& error) {
            throw UsageError(error.what());
        }
    }();
    InputOfRun input = read_input(std::nullopt, checkpoints.front().path, {});
    const viz::RenderOptions options = options_of(request, input.scenario.render, output.root);
    try {
        viz::validate(options);
    } catch (const viz::VizError& error) {
        throw UsageError(error.what());
    }
    if (options.views.empty())
        throw UsageError("the scenario has no views: name some with --views");
    make_room(output, options.views, request.overwrite);

    viz::FileOptions files;
    files.run_dir = output.root;
    viz::Pipeline pipeline(files, options, backend, {}, [](const std::string&) {}); // told below, as an error
    for (const CheckpointFile& checkpoint : checkpoints) {
        if (checkpoint.path != checkpoints.front().path)
            input = read_input(std::nullopt, checkpoint.path, {});
        pipeline.submit(snapshot_of(std::move(input)), true, false);
    }
    pipeline.finish();
    if (const viz::PipelineStats stats = pipeline.stats(); !stats.failure.empty())
        throw std::runtime_error(stats.failure);
    for (const std::string& view : options.views) {
        viz::encode_movie(output.frames(), view, output.movie(view),
                          movie_rate(count_pictures(output, view)));
        std::fputs(fmt::format("{}\n", output.movie(view).string()).c_str(), stdout);
    }
    return exit_code::done;
}

} // namespace

void add_render(CLI::App& program, Action& chosen) {
    auto request = std::make_shared<RenderRequest>();
    CLI::App* render = program.add_subcommand(
        "render", "Make pictures and movies again from a run's checkpoints, with other views or colours");
    render->add_option("DIR", request->folder, "Run folder")->required();
    render->add_option("-o,--output", request->output, "Folder for frames/ and the movies; default DIR")
        ->type_name("DIR2");
    render->add_option("--views", request->views, "Views, e.g. section,top")
        ->type_name("NAME,...")
        ->delimiter(',');
    render->add_option("--field", request->field, "Field that is coloured: temperature, phi, phi_hat, mass")
        ->type_name("NAME");
    render
        ->add_option("--color-range", request->color_range, "Ends of the colour bar, in the field's SI unit")
        ->type_name("LOW HIGH")
        ->expected(2);
    render->add_option("--size", request->size, "Pixels")->type_name("WIDTH HEIGHT")->expected(2);
    render->add_option("--colormap", request->colormap, "inferno, magma, plasma, viridis or cividis")
        ->type_name("NAME");
    render->add_option("--background", request->background, "dark or light")
        ->type_name("NAME")
        ->check(CLI::IsMember({"dark", "light"}));
    render->add_option("--render-backend", request->backend, "auto, x11, xvfb, egl, osmesa or none")
        ->type_name("NAME");
    render->add_flag("--overwrite", request->overwrite, "Replace pictures of these views");
    render->footer(
        "What is not given is as the run's scenario has it.\n"
        "Example:\n  meltscope render runs/hot --views section,top --color-range 300 2000 -o runs/hot_again");
    render->callback([request, &chosen] { chosen = [request] { return execute(*request); }; });
}

} // namespace meltscope
