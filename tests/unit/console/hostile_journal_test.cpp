// Journals and checkpoints from elsewhere: they may steer the run, and nothing else.
#include "tiny_run.hpp"

#include "meltscope/console/commands.hpp"
#include "meltscope/console/console.hpp"
#include "meltscope/io/checkpoint.hpp"

#include "../io/temporary_folder.hpp"

namespace meltscope {
namespace {

using testing::has;
using testing::start_tiny;
using testing::TemporaryFolder;
using testing::tiny_host;

/// Carries out what is to be replayed at the start.
void replay(const std::string& journal) {
    meltscope::Run run = start_tiny();
    Console console(tiny_host(), false);
    console.replay(journal, "j");
    console.source().apply(run);
}

TEST(HostileJournal, names_no_file_to_write_or_read) {
    const TemporaryFolder folder;
    for (const char* command : {"save", "record", "snapshot", "source", "restore", "at 0 s save",
                                "at 0 s sav", "at 10 us snapshot", "at 0 s record"}) {
        const std::string line = std::string(command) + " " + (folder / "a.png").string();
        EXPECT_THROW(replay("at step 0 t=0: " + line + "\n"), JournalError) << line;
        meltscope::Run run = start_tiny();
        ConsoleState console{tiny_host()};
        run.journal = "at step 0 t=0: " + line + "\n";
        try {
            take_up_journal(console, run);
        } catch (const JournalError&) {
        }
        EXPECT_TRUE(console.waiting.empty()) << line;
        EXPECT_EQ(folder.entry_count(), 0u) << line;
    }
}

TEST(HostileJournal, a_command_that_waits_to_save_keeps_its_file_to_itself) {
    const TemporaryFolder folder;
    const std::string file = (folder / "a.h5").string();
    meltscope::Run run = start_tiny();
    ConsoleState console{tiny_host()};
    EXPECT_TRUE(execute(console, run, "at 0 s save " + file).ok);
    EXPECT_EQ(run.journal, "at step 0 t=0: at 0 s save\n");
    for (const Reply& reply : execute_due(console, run))
        EXPECT_TRUE(reply.ok) << reply.text;
    EXPECT_TRUE(std::filesystem::exists(file));
    EXPECT_EQ(run.journal, "at step 0 t=0: at 0 s save\n# at step 0 t=0: save\n");
    ConsoleState again{tiny_host()};
    take_up_journal(again, run);
    EXPECT_TRUE(again.waiting.empty());
}

TEST(HostileJournal, lines_without_a_command_or_a_closed_quote_are_no_fault_of_the_reader) {
    meltscope::Run run = start_tiny();
    ConsoleState console{tiny_host()};
    run.journal = "at step 0 t=0: # nothing\n";
    EXPECT_NO_THROW(take_up_journal(console, run));
    for (const char* journal :
         {"at step 0 t=0:  \n", "at step 0 t=0: at 1e-5 s save \"x\n", "at step 0 t=0: at\n"}) {
        run.journal = journal;
        EXPECT_THROW(take_up_journal(console, run), JournalError) << journal;
    }
}

TEST(HostileJournal, a_restore_that_fails_leaves_the_run_and_the_console_as_they_were) {
    const TemporaryFolder folder;
    meltscope::Run run = start_tiny();
    ConsoleState console{tiny_host()};
    execute(console, run, "at 20 us off");
    advance(run.simulation, 1.0);
    CheckpointData data = testing::kept(run);
    const auto refused_with = [&](const CheckpointData& bad) {
        write_checkpoint(folder / "bad.h5", bad);
        const CheckpointData before = testing::kept(run);
        const Reply reply = execute(console, run, "restore " + (folder / "bad.h5").string());
        EXPECT_FALSE(reply.ok);
        testing::expect_equal(testing::kept(run), before);
        EXPECT_EQ(console.waiting.size(), 1u);
        return reply.text;
    };
    CheckpointData bad = data;
    bad.journal = "at step 0 t=0: at 1e-5 s dance\n";
    EXPECT_TRUE(has(refused_with(bad), "dance"));
    bad = data;
    bad.particles.mass[2] = -1.0;
    EXPECT_TRUE(has(refused_with(bad), "mass"));
    bad = data;
    bad.steering.replace(bad.steering.find("\"cfl\": 0.5"), 10, "\"cfl\":-0.5");
    EXPECT_TRUE(has(refused_with(bad), "cfl"));
}

} // namespace
} // namespace meltscope
