#include "meltscope/io/run_folder.hpp"

#include "meltscope/io/atomic_file.hpp"
#include "posix_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <fcntl.h>
#include <regex>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace meltscope {

namespace fs = std::filesystem;

namespace {

/// Folders that a run makes in its own, in which only names of is_run_output are ever removed.
constexpr std::array<std::string_view, 7> output_folders{"particles", "surface", "pool",       "grid",
                                                         "frames",    "plots",   "checkpoints"};

std::string read_text(int descriptor) {
    char text[64];
    const ssize_t count = ::pread(descriptor, text, sizeof text, 0);
    return {text, static_cast<std::size_t>(std::max<ssize_t>(0, count))};
}

std::optional<long> process_named_in(const std::string& text) {
    long process = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), process);
    return error == std::errc{} && process > 0 ? std::optional(process) : std::nullopt;
}

/// True if `path` still names the file that is open: a lock on a removed file holds nobody off.
bool is_still_there(int descriptor, const fs::path& path) {
    struct stat open_file_status {};
    struct stat named_file_status {};
    return ::fstat(descriptor, &open_file_status) == 0 && ::lstat(path.c_str(), &named_file_status) == 0 &&
           open_file_status.st_ino == named_file_status.st_ino &&
           open_file_status.st_dev == named_file_status.st_dev;
}

/// Every entry but the lock, which is there by now in any case.
bool holds_something(const RunPaths& paths) {
    return std::any_of(fs::directory_iterator(paths.root), fs::directory_iterator(),
                       [&](const auto& entry) { return entry.path().filename() != paths.lock().filename(); });
}

bool is_removable(const fs::directory_entry& entry, const fs::path& root, bool temporaries_only) {
    if (entry.symlink_status().type() == fs::file_type::directory)
        return false;
    fs::path relative = entry.path().lexically_relative(root);
    const auto name = entry.path().filename().string();
    const auto final_name = final_name_of_temporary(name);
    if (!final_name.empty())
        relative.replace_filename(final_name);
    else if (relative.extension() == ".part") // how the picture and ParaView writers name theirs
        relative.replace_extension();
    else if (temporaries_only)
        return false;
    return is_run_output(relative);
}

void remove_outputs_in(const fs::path& folder, const fs::path& root, bool temporaries_only) {
    // A link to a folder is followed by nobody here: what it leads to may belong to someone else.
    if (fs::symlink_status(folder).type() != fs::file_type::directory)
        return;
    std::vector<fs::path> found;
    for (const auto& entry : fs::directory_iterator(folder))
        if (is_removable(entry, root, temporaries_only))
            found.push_back(entry.path());
    for (const auto& path : found)
        fs::remove(path);
}

void remove_outputs(const fs::path& root, bool temporaries_only) {
    remove_outputs_in(root, root, temporaries_only);
    for (const auto folder : output_folders) {
        const auto path = root / folder;
        remove_outputs_in(path, root, temporaries_only);
        if (!temporaries_only && fs::symlink_status(path).type() == fs::file_type::directory &&
            fs::is_empty(path))
            fs::remove(path);
    }
}

} // namespace

fs::path RunPaths::collection(std::string_view series) const {
    return root / fmt::format("{}.pvd", series);
}

fs::path RunPaths::frame(std::string_view view, std::int64_t index) const {
    return frames() / fmt::format("{}_{:06d}.png", view, index);
}

fs::path RunPaths::movie(std::string_view view) const {
    return root / fmt::format("{}.mp4", view);
}

fs::path RunPaths::checkpoint(std::int64_t step) const {
    return checkpoints() / fmt::format("step_{:09d}.h5", step);
}

fs::path RunPaths::inspection(std::int64_t step) const {
    return root / fmt::format("inspect_step_{:09d}.h5", step);
}

bool is_run_output(const fs::path& relative) {
    // run.lock is not among them: it belongs to whoever holds it.
    static const std::regex pattern(
        R"(run\.(toml|json)|journal\.txt|log\.txt|melt_pools?\.csv|solidification\.(csv|vtp)|report\.html|console\.sock)"
        R"(|(particles|surface|pool|grid)\.pvd)"
        R"(|(particles|surface|pool|grid)/[a-z]+_[0-9]+\.vt[piu])"
        R"(|frames/[a-z][a-z0-9_]*_[0-9]{6,}\.png)"
        R"(|(overview|section|top|pool|dashboard)\.mp4)"
        R"(|plots/[a-z][a-z0-9_]*\.png)"
        R"(|inspect_step_[0-9]{9,}\.h5|checkpoints/step_[0-9]{9,}\.h5)");
    return std::regex_match(relative.generic_string(), pattern);
}

std::vector<CheckpointFile> list_checkpoints(const RunPaths& paths) {
    static const std::regex pattern(R"(step_([0-9]{9,18})\.h5)");
    std::vector<CheckpointFile> found;
    if (!fs::is_directory(paths.checkpoints()))
        return found;
    for (const auto& entry : fs::directory_iterator(paths.checkpoints())) {
        std::smatch match;
        const auto name = entry.path().filename().string();
        if (std::regex_match(name, match, pattern))
            found.push_back({std::stoll(match[1]), entry.path()});
    }
    std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.step < b.step; });
    return found;
}

void prune_checkpoints(const RunPaths& paths, int keep) {
    if (keep < 1)
        throw std::invalid_argument(fmt::format("{} checkpoints cannot be kept: keep at least 1", keep));
    const auto found = list_checkpoints(paths);
    for (std::size_t n = 0; n + static_cast<std::size_t>(keep) < found.size(); ++n)
        fs::remove(found[n].path);
}

void drop_checkpoints_after(const RunPaths& paths, std::int64_t step) {
    for (const auto& checkpoint : list_checkpoints(paths))
        if (checkpoint.step > step)
            fs::remove(checkpoint.path);
}

RunFolder::RunFolder(const fs::path& root, ExistingRun existing) : paths_{root} {
    fs::create_directories(root);
    take_lock();
    try {
        if (existing == ExistingRun::refuse && holds_something(paths_))
            throw RunFolderError(fmt::format("{} holds something already: choose another --output, or "
                                             "--overwrite to replace the run there",
                                             root.string()));
        remove_outputs(root, existing != ExistingRun::overwrite);
    } catch (...) {
        ::unlink(paths_.lock().c_str());
        ::close(lock_);
        throw;
    }
}

RunFolder::~RunFolder() {
    // Removed while still locked, so that nobody else's lock is removed.
    if (is_still_there(lock_, paths_.lock()))
        ::unlink(paths_.lock().c_str());
    ::close(lock_);
}

void RunFolder::take_lock() {
    const auto path = paths_.lock();
    for (;;) {
        FileDescriptor lock(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0644));
        if (!lock.is_open())
            throw_file_error("cannot lock run folder by", path, errno);
        if (::flock(lock.get(), LOCK_EX | LOCK_NB) != 0) {
            if (errno != EWOULDBLOCK)
                throw_file_error("cannot lock run folder by", path, errno);
            const auto owner = process_named_in(read_text(lock.get()));
            throw RunFolderError(
                fmt::format("{} is in use by another run{}: wait for it or choose another --output",
                            paths_.root.string(), owner ? fmt::format(" (process {})", *owner) : ""));
        }
        if (!is_still_there(lock.get(), path))
            continue; // its owner removed it between our open and our lock
        // The system drops the lock of a process that ends; only a run that was cut off leaves its number
        // behind.
        stale_owner_ = process_named_in(read_text(lock.get()));
        if (::ftruncate(lock.get(), 0) != 0)
            throw_file_error("cannot lock run folder by", path, errno);
        write_all(lock.get(), fmt::format("{}\n", ::getpid()), path);
        lock_ = lock.release();
        return;
    }
}

} // namespace meltscope
