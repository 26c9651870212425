#include "commands.hpp"
#include "exit_codes.hpp"
#include "run_outputs.hpp"
#include "run_setup.hpp"
#include "saved_run.hpp"
#include "text.hpp"

#include "viz/movie.hpp"
#include "viz/pipeline.hpp"
#include "viz/saved_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>

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
    std::string source = "auto";
    bool overwrite = false;
};

viz::RenderOptions options_of(const RenderRequest& request, const RenderSpec& spec, const fs::path& folder) {
    viz::RenderOptions options = render_options(folder, spec);
    if (!request.size.empty())
        options.size = {request.size[0], request.size[1]};
    if (!request.views.empty())
        options.views = request.views;
    if (!request.field.empty()) {
        options.field = request.field;
        if (request.field != "temperature")
            options.color_range = std::nullopt; // the scenario's range is one of temperatures
    }
    if (!request.color_range.empty())
        options.color_range = {request.color_range[0], request.color_range[1]};
    if (!request.colormap.empty())
        options.colormap = request.colormap;
    if (!request.background.empty())
        options.background = request.background == "light" ? viz::Background::light : viz::Background::dark;
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

viz::Backend backend_of(const RenderRequest& request) {
    const viz::Backend backend = viz::backend_from_name(request.backend);
    if (backend == viz::Backend::none)
        throw UsageError("--render-backend none makes no pictures; take auto, x11, xvfb, egl or osmesa");
    return backend;
}

/// What pictures are made from.
enum class Source { checkpoints, grid_files, surface_files };

/// The outputs of the folder that have a file of that kind.
std::vector<viz::SavedOutput> outputs_with(const fs::path& folder, fs::path viz::SavedOutput::*file) {
    std::vector<viz::SavedOutput> outputs = viz::list_saved_outputs(folder);
    std::erase_if(outputs, [&](const viz::SavedOutput& output) { return (output.*file).empty(); });
    return outputs;
}

Source choose_source(const RenderRequest& request, std::size_t checkpoints, std::size_t grids,
                     std::size_t surfaces) {
    if (request.source != "files" && checkpoints > 0)
        return Source::checkpoints;
    if (request.source == "checkpoints")
        throw UsageError(
            fmt::format("{} holds no checkpoints (checkpoints/step_000000500.h5): give the folder "
                        "of a run that made some, see [checkpoint] every and keep",
                        request.folder.string()));
    if (grids > 0)
        return Source::grid_files;
    if (surfaces > 0)
        return Source::surface_files;
    throw UsageError(
        fmt::format("{} holds neither checkpoints ([checkpoint] every) nor saved files (grid.pvd or "
                    "surface.pvd, [output] grid and surface): give the folder of a run that made some",
                    request.folder.string()));
}

/// Refuses what the saved surfaces do not hold.
void require_seen_on_surfaces(const viz::RenderOptions& options, const fs::path& folder) {
    const auto& views = viz::views_of_surfaces();
    for (const std::string& view : options.views)
        if (std::find(views.begin(), views.end(), view) == views.end())
            throw UsageError(
                fmt::format("\"{}\" shows the inside, and {} holds free surfaces only: take --views {}, or "
                            "run with output.grid = true or checkpoint.every",
                            view, folder.string(), fmt::join(views, ",")));
    if (options.field != "temperature")
        throw UsageError(fmt::format("{} holds free surfaces with their temperature only, not {}; run with "
                                     "output.grid = true or checkpoint.every for it",
                                     folder.string(), options.field));
}

void submit_checkpoints(const std::vector<CheckpointFile>& checkpoints, viz::Pipeline& pipeline) {
    for (const CheckpointFile& checkpoint : checkpoints) {
        const PreparedRun prepared = prepare_run(read_input(std::nullopt, checkpoint.path, {}));
        pipeline.submit(
            std::make_shared<const Snapshot>(take_snapshot(prepared.run.simulation, ParticleSelection::none)),
            true, false);
    }
}

void submit_grids(const std::vector<viz::SavedOutput>& outputs, const SavedRun& saved,
                  viz::Pipeline& pipeline) {
    for (const viz::SavedOutput& output : outputs) {
        auto snapshot = std::make_shared<Snapshot>(saved.head_at(output.time));
        snapshot->pools.clear();
        for (BeamSnapshot& beam : snapshot->beams)
            beam.pools.clear();
        viz::read_grid_file(output.grid, *snapshot);
        measure_pools(saved.scenario().output.isotherms, *snapshot);
        pipeline.submit(std::move(snapshot), true, false);
    }
}

int execute(const RenderRequest& request) {
    const RunPaths paths{request.folder};
    const std::vector<CheckpointFile> checkpoints = list_checkpoints(paths);
    const auto grids = outputs_with(request.folder, &viz::SavedOutput::grid);
    const auto surfaces = outputs_with(request.folder, &viz::SavedOutput::surface);
    const Source source = choose_source(request, checkpoints.size(), grids.size(), surfaces.size());
    std::optional<SavedRun> saved;
    if (source != Source::checkpoints)
        saved.emplace(paths);
    const RenderSpec spec = saved ? saved->scenario().render
                                  : read_input(std::nullopt, checkpoints.front().path, {}).scenario.render;

    const RunPaths output{request.output.empty() ? request.folder : request.output};
    const viz::RenderOptions options = options_of(request, spec, output.root);
    viz::Backend backend = viz::Backend::automatic;
    try {
        backend = backend_of(request);
        viz::validate(options);
    } catch (const viz::VizError& error) {
        throw UsageError(error.what());
    }
    if (options.views.empty())
        throw UsageError("the scenario has no views: name some with --views");
    if (source == Source::surface_files)
        require_seen_on_surfaces(options, request.folder);
    make_room(output, options.views, request.overwrite);

    viz::FileOptions files;
    files.run_dir = output.root;
    viz::Pipeline pipeline(files, options, backend, {}, [](const std::string&) {}); // told below, as an error
    if (source == Source::checkpoints)
        submit_checkpoints(checkpoints, pipeline);
    else if (source == Source::grid_files)
        submit_grids(grids, *saved, pipeline);
    else
        for (const viz::SavedOutput& saved_output : surfaces)
            pipeline.submit_saved(std::make_shared<const Snapshot>(saved->head_at(saved_output.time)),
                                  saved_output.surface);
    pipeline.finish();
    if (const viz::PipelineStats stats = pipeline.stats(); !stats.failure.empty())
        throw std::runtime_error(stats.failure);
    print_result(fmt::format("{}\n", output.frames().string()));
    for (const std::string& view : options.views) {
        try {
            viz::encode_movie(output.frames(), view, output.movie(view),
                              movie_rate(count_pictures(output, view)));
            print_result(fmt::format("{}\n", output.movie(view).string()));
        } catch (const viz::VizError& error) {
            show(stderr, fmt::format("warning: no movie of {}: {}\n", view, error.what()));
        }
    }
    return exit_code::done;
}

} // namespace

void add_render(CLI::App& program, Action& chosen) {
    auto request = std::make_shared<RenderRequest>();
    CLI::App* render = program.add_subcommand(
        "render",
        "Make pictures and movies again from a run's checkpoints or saved files, with other views or "
        "colours");
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
    render
        ->add_option(
            "--from", request->source,
            "checkpoints; files: grid/*.vti, or surface/*.vtp for views from outside; auto: checkpoints if "
            "there are any")
        ->type_name("WHAT")
        ->check(CLI::IsMember({"auto", "checkpoints", "files"}));
    render->add_option("--render-backend", request->backend, "auto, x11, xvfb, egl or osmesa")
        ->type_name("NAME");
    render->add_flag("--overwrite", request->overwrite, "Replace pictures of these views");
    render->footer(
        "What is not given is as the run's scenario has it.\n"
        "Examples:\n  meltscope render runs/hot --views section,top --color-range 300 2000 -o "
        "runs/hot_again\n"
        "  meltscope render runs/hot --from files --views overview --size 3840 2160 -o runs/hot_large");
    render->callback([request, &chosen] { chosen = [request] { return execute(*request); }; });
}

} // namespace meltscope
