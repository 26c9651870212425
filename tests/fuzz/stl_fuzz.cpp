// STL files, binary and ASCII: read, then filled with particles as a scenario's body.
#include "fuzz.hpp"

#include "meltscope/build/fill.hpp"
#include "meltscope/build/stl.hpp"

using namespace meltscope;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    for (const double scale : {1.0, 1e-3})
        fuzz::is_taken<GeometryError>([&] {
            const Shape body = parse_stl(fuzz::text_of(data, size), "mesh", scale);
            const Box box = bounding_box(body);
            fill(std::span(&body, 1),
                 {box.min, std::max((box.max - box.min).maxCoeff() / 12.0, 1e-30), Index3::Constant(16)});
        });
    return 0;
}
