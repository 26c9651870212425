// Path files. The first byte chooses the format and whether the laser's power is known.
#include "fuzz.hpp"

#include "meltscope/beam/path_file.hpp"

using namespace meltscope;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0)
        return 0;
    const auto format = (data[0] & 1) != 0 ? PathFileFormat::threedthesis : PathFileFormat::additivefoam;
    const auto power = (data[0] & 2) != 0 ? std::optional(195.0) : std::nullopt;
    ScanPath path;
    if (!fuzz::is_taken<PathError>(
            [&] { path = parse_path_text(fuzz::text_of(data + 1, size - 1), "path", format, power); }))
        return 0;
    // What was taken can be run and edited under way.
    const double end = path_end_time(path);
    for (const double time : {0.0, 0.3 * end, end, 2.0 * end}) {
        fuzz::require(beam_at(path, time).position.allFinite(), "the beam is nowhere");
        next_corner_time(path, time);
        corners_at(path, time);
        fuzz::is_taken<PathError>([&] { check_path(path_from(path, time)); });
        fuzz::is_taken<PathError>([&] { check_path(with_speed_from(path, time, 0.7)); });
    }
    return 0;
}
