// Console lines: a session on a small run; an empty line is a step of it. What changed the run stands in the
// journal, by which another run must come to the same state.
#include "fuzz.hpp"
#include "small_run.hpp"

#include "meltscope/console/commands.hpp"
#include "meltscope/console/journal.hpp"

#include <cctype>
#include <deque>
#include <optional>
#include <utility>

using namespace meltscope;

namespace {

constexpr std::size_t most_lines = 60;
constexpr int most_steps = 6;

/// The input with file names kept below the working folder: this process may be allowed to write elsewhere. A
/// slash remains within a unit or after a name.
std::string tamed(std::string_view text) {
    std::string result(text);
    for (std::size_t n = 0; n < result.size(); ++n) {
        const bool within = n > 0 && std::isalnum(static_cast<unsigned char>(result[n - 1])) != 0;
        if ((result[n] == '/' && !within) || (result[n] == '.' && n > 0 && result[n - 1] == '.'))
            result[n] = '_';
    }
    return result;
}

/// Packing a million grains takes minutes, which is no fault: of grains only these, a dozen, and `once`.
bool takes_long(std::string line, bool& once) {
    constexpr std::string_view grains = " d10 28 um d50 32 um d90 38 um";
    if (const std::size_t at = line.find(grains); at != std::string::npos && !std::exchange(once, true))
        line.erase(at, grains.size());
    std::erase(line, '"');
    for (const char* size : {"d1", "d5", "d9"})
        if (line.find(size) != std::string::npos)
            return true;
    return false;
}

/// What a library's own exceptions say is no answer for people; what was typed may be repeated.
void require_readable(const std::string& reply, std::string_view typed) {
    for (const char* bare : {"stoll", "stod", "stoul", "basic_string", "vector", "std::", "bad_"})
        if (reply.find(bare) != std::string::npos && typed.find(bare) == std::string::npos)
            fuzz::finding("the answer is \"" + reply + "\"");
}

struct Session {
    ConsoleState console;
    ConsoleHost host;
    Run fresh;
    fuzz::Scratch scratch;

    Session() : console(fuzz::small_host()), host(fuzz::small_host()), fresh(fuzz::start_small()) {
        std::filesystem::current_path(scratch.path());
    }

    Run carry_out(std::string_view text) {
        const std::string_view typed = text;
        int steps = 0;
        bool packed = false;
        std::filesystem::current_path("/");
        scratch.empty();
        std::filesystem::current_path(scratch.path());
        fuzz::renew(console, host);
        Run run = fresh;
        take_up_journal(console, run);
        std::deque<std::string> lines;
        for (; !text.empty() && lines.size() < most_lines;
             text.remove_prefix(std::min(text.find('\n') + 1, text.size()))) {
            lines.emplace_back(text.substr(0, text.find('\n')));
            if (text.find('\n') == std::string_view::npos)
                break;
        }
        CompletionNames names;
        names.parameters = {"laser.red.power"};
        names.fields = host.fields;
        for (std::size_t count = 0; !lines.empty() && count < 2 * most_lines && !run.stop_reason; ++count) {
            const std::string line = std::move(lines.front());
            lines.pop_front();
            if (takes_long(line, packed))
                continue;
            if (line.empty() && steps < most_steps && !at_end_of_run(run)) {
                note_landing(console, run);
                fuzz::step(console, run);
                ++steps;
                for (const Reply& reply : execute_due(console, run))
                    require_readable(reply.text, typed);
                continue;
            }
            completions(line, names);
            require_readable(execute(console, run, line).text, typed);
            for (std::size_t n = console.sourced.size(); n-- > 0 && lines.size() < most_lines;)
                lines.push_front(tamed(console.sourced[n]));
            console.sourced.clear();
            if (!run.stop_reason)
                execute_due(console, run);
        }
        return run;
    }

    /// Does again what the journal says; the lines of it must be taken.
    void replay(const std::string& journal, const Run& original) {
        const auto entries = parse_journal(journal, "journal");
        fuzz::renew(console, host);
        Run run = fresh;
        take_up_journal(console, run);
        std::size_t next = 0;
        for (;;) {
            execute_due(console, run);
            for (; next < entries.size() && entries[next].step == run.simulation.step && !run.stop_reason;
                 ++next)
                if (!entries[next].waited) {
                    console.from_journal = true;
                    const Reply reply = execute(console, run, entries[next].command);
                    console.from_journal = false;
                    if (!reply.ok)
                        fuzz::finding("replay of \"" + entries[next].command + "\": " + reply.text);
                    execute_due(console, run);
                }
            if (run.simulation.step >= original.simulation.step || run.stop_reason)
                break;
            fuzz::step(console, run);
        }
        fuzz::require(run.simulation.time == original.simulation.time, "the replay ends at another time");
        fuzz::require(run.journal == original.journal, "the replay has another journal");
    }
};

} // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static Session session;
    const std::string text = tamed(fuzz::text_of(data, size));
    std::optional<Run> run;
    // A step may find that what was asked for has no solution, and says so.
    if (fuzz::is_taken<std::runtime_error>([&] { run = session.carry_out(text); }))
        session.replay(run->journal, *run);
    return 0;
}
