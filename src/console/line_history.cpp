#include "line_history.hpp"

#include "meltscope/console/line_editor.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <system_error>
#include <utility>

namespace meltscope {
namespace {

constexpr int history_length = 2000;

} // namespace

std::filesystem::path history_file() {
    if (const char* state = std::getenv("XDG_STATE_HOME"); state && *state == '/')
        return std::filesystem::path(state) / "meltscope/history";
    if (const char* home = std::getenv("HOME"); home && *home == '/')
        return std::filesystem::path(home) / ".local/state/meltscope/history";
    return {};
}

LineHistory::LineHistory(std::filesystem::path file) : file_(std::move(file)), history_(history_init()) {
    HistEvent event;
    history(history_, &event, H_SETSIZE, history_length);
    history(history_, &event, H_SETUNIQUE, 1);
    if (file_.empty())
        return;
    std::error_code unwritable; // then the history ends with the session
    std::filesystem::create_directories(file_.parent_path(), unwritable);
    std::ifstream lines(file_);
    for (std::string line; std::getline(lines, line);)
        if (!line.empty())
            history(history_, &event, H_ENTER, line.c_str());
}

LineHistory::~LineHistory() {
    history_end(history_);
}

void LineHistory::add(const std::string& line) {
    HistEvent event;
    history(history_, &event, H_ENTER, line.c_str());
    if (file_.empty())
        return;
    // Appended, so that sessions at the same time do not take each other's lines away.
    const int file = open(file_.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
    if (file < 0)
        return;
    const std::string row = line + "\n";
    if (write(file, row.data(), row.size()) < 0) {
        // a full disk costs the history, not the run
    }
    close(file);
}

} // namespace meltscope
