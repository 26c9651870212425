// Ball lists: read, then filled with particles as a scenario's body.
#include "fuzz.hpp"

#include "meltscope/build/ball_file.hpp"
#include "meltscope/build/fill.hpp"

using namespace meltscope;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const Box domain{Vec3::Zero(), Vec3::Constant(1e-3)};
    fuzz::is_taken<GeometryError>([&] {
        const Shape body = parse_ball_text(fuzz::text_of(data, size), "balls", domain);
        fill(std::span(&body, 1), {Vec3::Constant(31.25e-6), 62.5e-6, Index3::Constant(16)});
    });
    fuzz::is_taken<GeometryError>([&] { parse_ball_text(fuzz::text_of(data, size), "balls"); });
    return 0;
}
