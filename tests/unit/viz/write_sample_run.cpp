// Writes the data files of three instants of the synthetic plate: FOLDER COMPRESSION PRECISION [vtu].
#include "synthetic.hpp"
#include "viz/pipeline.hpp"

#include <cstdio>
#include <string>

int main(int argc, char** argv) {
    using namespace meltscope;
    if (argc < 4) {
        return 2;
    }
    const std::string compression = argv[2];
    viz::FileOptions files;
    files.run_dir = argv[1];
    files.grid = true;
    files.compression = compression == "lz4"    ? viz::Compression::lz4
                        : compression == "zlib" ? viz::Compression::zlib
                                                : viz::Compression::none;
    files.precision = std::string(argv[3]) == "float64" ? viz::Precision::float64 : viz::Precision::float32;
    files.particles_as_vtu = argc > 4;
    viz::RenderOptions render;
    render.run_dir = argv[1];
    bool failed = false;
    viz::Pipeline pipeline(files, render, viz::Backend::none, {}, [&](const std::string& words) {
        failed = true;
        std::fprintf(stderr, "%s\n", words.c_str());
    });
    test::SyntheticPlate plate;
    plate.count = {101, 31, 19};
    plate.spacing = 15e-6;
    for (const double time : {0.0, 250e-6, 1.0 / 3.0 * 1e-3}) {
        pipeline.submit(test::make_snapshot(plate, time), false, true);
    }
    pipeline.finish();
    return failed ? 1 : 0;
}
