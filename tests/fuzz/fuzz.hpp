#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <typeinfo>
#include <unistd.h>

/// What a fuzzer defines: reads `size` bytes as the program would. Whatever is neither taken nor refused with
/// a reason ends the process.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace meltscope::fuzz {

inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
    return {reinterpret_cast<const char*>(data), size};
}

[[noreturn]] inline void finding(const std::string& what) {
    std::fprintf(stderr, "FINDING: %s\n", what.c_str());
    std::abort();
}

inline void require(bool holds, const char* what) {
    if (!holds)
        finding(what);
}

/// Runs `read`; true if it ended well, false if it threw one of the documented errors with a reason. Any
/// other exception is a finding, an anonymous one too.
template <class... Errors, class Read>
bool is_taken(Read read) {
    try {
        read();
        return true;
    } catch (const std::exception& error) {
        const bool documented = (... || (dynamic_cast<const Errors*>(&error) != nullptr));
        if (!documented)
            finding(std::string(typeid(error).name()) + ": " + error.what());
        if (std::string_view(error.what()).empty())
            finding("refused without a reason");
        return false;
    }
}

/// A folder in memory for readers that want files and commands that write some; goes with the process.
class Scratch {
  public:
    Scratch() {
        const char* root = std::filesystem::is_directory("/dev/shm") ? "/dev/shm" : "/tmp";
        path_ = std::filesystem::path(root) / ("meltscope_fuzz_" + std::to_string(::getpid()));
        empty();
    }
    ~Scratch() { std::filesystem::remove_all(path_); }
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;

    const std::filesystem::path& path() const { return path_; }

    void empty() const {
        std::filesystem::remove_all(path_);
        std::filesystem::create_directory(path_);
    }

    /// The path of a file with these contents.
    std::filesystem::path file(const std::string& name, std::string_view contents) const {
        const std::filesystem::path path = path_ / name;
        std::ofstream(path, std::ios::binary).write(contents.data(), std::streamsize(contents.size()));
        return path;
    }

  private:
    std::filesystem::path path_;
};

} // namespace meltscope::fuzz
