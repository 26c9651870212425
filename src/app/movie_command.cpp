#include "commands.hpp"
#include "exit_codes.hpp"
#include "run_outputs.hpp"
#include "text.hpp"

#include "viz/movie.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>

namespace meltscope {
namespace {

struct MovieRequest {
    std::filesystem::path folder;
    std::vector<std::string> views;
    double rate = 0.0; ///< pictures a second; 0: chosen
};

int execute(const MovieRequest& request) {
    const RunPaths paths{request.folder};
    const std::vector<std::string> there = std::filesystem::is_directory(paths.frames())
                                               ? viz::views_with_frames(paths.frames())
                                               : std::vector<std::string>{};
    if (there.empty())
        throw UsageError(
            fmt::format("{} holds no pictures (frames/VIEW_000012.png): give the folder of a run",
                        request.folder.string()));
    for (const std::string& view : request.views)
        if (std::find(there.begin(), there.end(), view) == there.end())
            throw UsageError(fmt::format("there are no pictures of \"{}\" in {}, only of {}", view,
                                         paths.frames().string(), fmt::join(there, ", ")));
    for (const std::string& view : request.views.empty() ? there : request.views) {
        const double rate = request.rate > 0.0 ? request.rate : movie_rate(count_pictures(paths, view));
        viz::encode_movie(paths.frames(), view, paths.movie(view), rate);
        print_result(fmt::format("{}\n", paths.movie(view).string()));
    }
    return exit_code::done;
}

} // namespace

void add_movie(CLI::App& program, Action& chosen) {
    auto request = std::make_shared<MovieRequest>();
    CLI::App* movie = program.add_subcommand("movie", "Make movies (MP4, H.264) of a run's pictures");
    movie->add_option("DIR", request->folder, "Run folder")->required();
    movie->add_option("--view", request->views, "Views to make a movie of; default all that have pictures")
        ->type_name("NAME")
        ->expected(1)
        ->take_all();
    movie->add_option("--fps", request->rate, "Pictures a second; default 5 to 25, for about six seconds")
        ->type_name("N")
        ->check(CLI::Range(0.1, 240.0));
    movie->footer("Example:\n  meltscope movie runs/in625_single_track --fps 10");
    movie->callback([request, &chosen] { chosen = [request] { return execute(*request); }; });
}

} // namespace meltscope
