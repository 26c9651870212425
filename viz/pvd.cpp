#include "viz/pvd.hpp"

#include "viz/options.hpp"

#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <iterator>
#include <optional>
#include <unistd.h>

#include <fmt/format.h>

namespace meltscope::viz {

namespace {

std::optional<std::string> attribute(const std::string& line, const std::string& name) {
    const std::string start = " " + name + "=\"";
    const auto begin = line.find(start);
    if (begin == std::string::npos) {
        return std::nullopt;
    }
    const auto end = line.find('"', begin + start.size());
    if (end == std::string::npos) {
        return std::nullopt;
    }
    return line.substr(begin + start.size(), end - begin - start.size());
}

} // namespace

void write_text_safely(const std::filesystem::path& path, const std::string& text) {
    const std::string temporary = path.string() + ".part";
    const int file = open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    bool good = file >= 0;
    for (std::size_t written = 0; good && written < text.size();) {
        const ssize_t count = ::write(file, text.data() + written, text.size() - written);
        good = count > 0 || (count < 0 && errno == EINTR);
        written += count > 0 ? static_cast<std::size_t>(count) : 0;
    }
    good = good && fsync(file) == 0;
    int error = errno;
    if (file >= 0) {
        close(file);
    }
    if (good) {
        good = std::rename(temporary.c_str(), path.c_str()) == 0;
        error = errno;
    }
    if (!good) {
        unlink(temporary.c_str());
        throw VizError(fmt::format("cannot write {}: {}", path.string(), std::strerror(error)));
    }
}

void PvdCollection::load() {
    entries_.clear();
    if (!std::filesystem::exists(path_)) {
        return;
    }
    std::ifstream stream(path_);
    if (!stream) {
        throw VizError(fmt::format("cannot read {}", path_.string()));
    }
    bool is_collection = false;
    for (std::string line; std::getline(stream, line);) {
        is_collection = is_collection || line.find("<Collection") != std::string::npos;
        if (line.find("<DataSet") == std::string::npos) {
            continue;
        }
        const auto time = attribute(line, "timestep");
        const auto file = attribute(line, "file");
        double seconds = 0.0;
        if (!time || !file ||
            std::from_chars(time->data(), time->data() + time->size(), seconds).ec != std::errc()) {
            throw VizError(fmt::format("{} has a DataSet without timestep or file", path_.string()));
        }
        entries_.push_back({seconds, *file});
    }
    if (!is_collection) {
        throw VizError(fmt::format("{} is not a ParaView collection", path_.string()));
    }
}

void PvdCollection::drop_from(double time) {
    std::erase_if(entries_, [time](const Entry& entry) { return entry.time >= time; });
    write();
}

void PvdCollection::forget_missing() {
    std::erase_if(entries_, [this](const Entry& entry) {
        return !std::filesystem::exists(path_.parent_path() / entry.file);
    });
}

void PvdCollection::append(double time, const std::string& file) {
    entries_.push_back({time, file});
    write();
}

void PvdCollection::write() const {
    std::string text =
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n  <Collection>\n";
    for (const Entry& entry : entries_) {
        // Shortest text that reads back to the same double.
        fmt::format_to(std::back_inserter(text), "    <DataSet timestep=\"{}\" part=\"0\" file=\"{}\"/>\n",
                       entry.time, entry.file);
    }
    text += "  </Collection>\n</VTKFile>\n";
    write_text_safely(path_, text);
}

} // namespace meltscope::viz
