// Journals: read and written again; taken up as that of a checkpoint; replayed by a run.
#include "fuzz.hpp"
#include "small_run.hpp"

#include "meltscope/console/console.hpp"
#include "meltscope/console/journal.hpp"

using namespace meltscope;

namespace {

struct Bench {
    ConsoleState console{fuzz::small_host()};
    ConsoleHost host = fuzz::small_host();
    Run fresh = fuzz::start_small();
};

} // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static Bench bench;
    const std::string text(fuzz::text_of(data, size));
    std::vector<JournalEntry> entries;
    if (!fuzz::is_taken<JournalError>([&] { entries = parse_journal(text, "journal"); }))
        return 0;
    std::string written;
    for (const JournalEntry& entry : entries)
        written += journal_line(entry);
    fuzz::require(parse_journal(written, "journal") == entries, "what was written reads back as another");

    fuzz::is_taken<JournalError>([&] {
        fuzz::renew(bench.console, bench.host);
        Run run = bench.fresh;
        run.journal = text;
        take_up_journal(bench.console, run);
        for (int n = 0; n < 3 && !at_end_of_run(run); ++n)
            fuzz::step(bench.console, run);
    });
    return 0;
}
