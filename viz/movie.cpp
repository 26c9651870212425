#include "viz/movie.hpp"

#include "viz/process.hpp"

#include <algorithm>
#include <set>
#include <system_error>

#include <fmt/format.h>

namespace meltscope::viz {

namespace {

/// The view a picture VIEW_NNNNNN.png shows; empty for other files.
std::string view_of(const std::filesystem::path& picture) {
    const std::string stem = picture.stem().string();
    const auto underscore = stem.rfind('_');
    if (picture.extension() != ".png" || underscore == std::string::npos ||
        stem.size() - underscore - 1 < 6 ||
        stem.find_first_not_of("0123456789", underscore + 1) != std::string::npos) {
        return {};
    }
    return stem.substr(0, underscore);
}

} // namespace

std::vector<std::string> views_with_frames(const std::filesystem::path& frames_dir) {
    std::set<std::string> views;
    std::error_code error;
    for (const auto& file : std::filesystem::directory_iterator(frames_dir, error)) {
        if (std::string view = view_of(file.path()); !view.empty()) {
            views.insert(std::move(view));
        }
    }
    return {views.begin(), views.end()};
}

bool encode_movie(const std::filesystem::path& frames_dir, const std::string& view,
                  const std::filesystem::path& mp4, double fps) {
    if (!(fps > 0.0)) {
        throw VizError(
            fmt::format("a movie of {} pictures a second is not possible; choose a positive number", fps));
    }
    const std::vector<std::string> views = views_with_frames(frames_dir);
    if (std::find(views.begin(), views.end(), view) == views.end()) {
        return false;
    }
    const auto ffmpeg = find_program("ffmpeg");
    if (!ffmpeg) {
        throw VizError("no movie without ffmpeg; install the package ffmpeg");
    }
    const std::filesystem::path target = std::filesystem::absolute(mp4);
    const std::filesystem::path temporary = target.string() + ".part";
    // yuv420p halves the colour planes, so sides must be even.
    Child encoder({ffmpeg->string(),
                   "-hide_banner",
                   "-nostdin",
                   "-loglevel",
                   "error",
                   "-y",
                   "-framerate",
                   fmt::format("{}", fps),
                   "-pattern_type",
                   "glob",
                   "-i",
                   view + "_[0-9]*.png",
                   "-vf",
                   "pad=ceil(iw/2)*2:ceil(ih/2)*2",
                   "-c:v",
                   "libx264",
                   "-preset",
                   "fast",
                   "-crf",
                   "18",
                   "-pix_fmt",
                   "yuv420p",
                   "-movflags",
                   "+faststart",
                   "-f",
                   "mp4",
                   temporary.string()},
                  frames_dir);
    std::string words = encoder.read_all();
    const int code = encoder.wait();
    std::error_code error;
    if (code == 0) {
        std::filesystem::rename(temporary, target, error);
        if (!error) {
            return true;
        }
        words = error.message();
    }
    std::filesystem::remove(temporary, error);
    while (!words.empty() && words.back() == '\n') {
        words.pop_back();
    }
    throw VizError(fmt::format("ffmpeg could not make {} (exit code {}): {}", target.string(), code,
                               words.substr(words.rfind('\n') + 1)));
}

} // namespace meltscope::viz
