// Stands in for libFuzzer: reads the files and folders given as arguments, once each.
#include "fuzz.hpp"

#include <algorithm>
#include <iterator>
#include <vector>

namespace fs = std::filesystem;

int main(int argc, char** argv) {
    std::vector<fs::path> files;
    for (int n = 1; n < argc; ++n) {
        const fs::path given = fs::absolute(argv[n]);
        if (fs::is_directory(given))
            std::copy(fs::directory_iterator(given), {}, std::back_inserter(files));
        else
            files.push_back(given);
    }
    std::sort(files.begin(), files.end());
    for (const fs::path& file : files) {
        std::printf("%s\n", file.c_str());
        std::fflush(stdout);
        std::ifstream stream(file, std::ios::binary);
        const std::vector<char> bytes{std::istreambuf_iterator<char>(stream), {}};
        if (!stream) {
            std::fprintf(stderr, "%s cannot be read\n", file.c_str());
            return 1;
        }
        LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
    }
    std::printf("%zu inputs\n", files.size());
    return files.empty() ? 1 : 0;
}
