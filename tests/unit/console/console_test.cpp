#include "tiny_run.hpp"

#include "meltscope/console/console.hpp"

#include "../io/temporary_folder.hpp"

#include <fmt/format.h>
#include <omp.h>

#include <map>
#include <random>
#include <thread>

namespace meltscope {
namespace {

using testing::expect_equal;
using testing::kept;
using testing::start_tiny;
using testing::tiny_host;

/// Lines that are said when the run reaches a step.
using Plan = std::map<std::int64_t, std::vector<std::string>>;

/// Runs under a console; what the plan says is said at its steps. Returns why the run ended.
RunOutcome drive(meltscope::Run& run, Console& console, const Plan& plan,
                 std::optional<std::int64_t> stop_at = {}) {
    const Console::Id id = console.open({});
    RunConnections connections;
    std::int64_t said_at = -1;
    connections.commands.push_back({[&](meltscope::Run& r) {
        if (stop_at && r.simulation.step == *stop_at)
            r.stop_reason = "interrupted";
        if (const auto lines = plan.find(r.simulation.step);
            lines != plan.end() && said_at != r.simulation.step)
            for (const std::string& line : lines->second)
                console.say(id, line);
        said_at = r.simulation.step;
    }});
    connections.commands.push_back(console.source());
    const RunOutcome outcome = run_to_end(run, connections);
    console.close(id);
    return outcome;
}

CheckpointData end_of_replay(const std::string& journal, int threads = 1) {
    omp_set_num_threads(threads);
    meltscope::Run run = start_tiny();
    Console console(tiny_host(), false);
    console.replay(journal, "journal.txt");
    RunConnections connections;
    connections.commands.push_back(console.source());
    run_to_end(run, connections);
    EXPECT_EQ(console.left_of_replay(), "");
    omp_set_num_threads(1);
    return kept(run);
}

/// One line that a user might type, right or wrong.
std::string random_line(std::mt19937& random) {
    const auto pick = [&](double low, double high) {
        return std::uniform_real_distribution(low, high)(random);
    };
    const auto um = [&](double low, double high) { return fmt::format("{} um", pick(low, high)); };
    switch (random() % 24) {
    case 0:
        return fmt::format("power {} W", pick(0, 30));
    case 1:
        return fmt::format("speed {}", pick(0.1, 2));
    case 2:
        return "spot " + um(21, 60);
    case 3:
        return fmt::format("set laser.absorptivity {}", pick(0, 1));
    case 4:
        return random() % 2 ? "on" : "off";
    case 5:
        return fmt::format("path line {} {} speed {}", um(0, 160), um(0, 120), pick(0.1, 2));
    case 6:
        return fmt::format("path dwell {} us power {}", pick(1, 20), pick(0, 20));
    case 7:
        return fmt::format("path goto {} {}", um(0, 160), um(0, 120));
    case 8:
        return "path clear";
    case 9:
        return fmt::format("set output.every {} us", pick(5, 60));
    case 10:
        return fmt::format("set render.every {} us", pick(5, 60));
    case 11:
        return fmt::format("set checkpoint.every {} us", pick(20, 90));
    case 12:
        return fmt::format("set time.cfl {}", pick(0.2, 0.9));
    case 13:
        return fmt::format("set boundary.x_min temperature {}", pick(250, 900));
    case 14:
        return fmt::format("set boundary.z_min convection {} ambient {}", pick(1, 1e4), pick(250, 400));
    case 15:
        return random() % 2 ? "set physics.radiation on" : "set physics.evaporation on";
    case 16:
        return fmt::format("at {} us power {}", pick(0, 220), pick(0, 30));
    case 17:
        return fmt::format("at {} us set output.every {} us", pick(0, 220), pick(5, 60));
    case 18:
        return fmt::format("land {} us", pick(0, 220));
    case 19:
        return fmt::format("set time.max_step {} us", pick(0.5, 5));
    case 20:
        return "pool";
    case 21:
        return fmt::format("layer thickness {} packing {} homogenised", um(15, 25), pick(0.3, 0.7));
    case 22:
        return fmt::format("layer thickness {} d10 14 um d50 18 um d90 22 um seed {} packing 0.3", um(24, 40),
                           random() % 100);
    default:
        return "nonsense 3";
    }
}

Plan random_plan(std::mt19937& random, std::int64_t steps, int lines) {
    Plan plan;
    for (int n = 0; n < lines; ++n)
        plan[std::int64_t(random() % std::uint64_t(steps))].push_back(random_line(random));
    return plan;
}

TEST(ConsoleReplay, random_sessions_replay_bit_for_bit_with_other_threads_and_when_interrupted_and_taken_up) {
    std::mt19937 random(20240607);
    for (int session = 0; session < 300; ++session) {
        SCOPED_TRACE(fmt::format("session {}", session));
        const Plan plan = random_plan(random, 45, 12);
        const std::int64_t interrupted_at = 1 + std::int64_t(random() % 44);

        meltscope::Run whole = start_tiny();
        {
            Console console(tiny_host(), false);
            drive(whole, console, plan);
        }
        const CheckpointData end = kept(whole);
        EXPECT_FALSE(end.journal.empty());
        // With two or three threads every tenth: so few particles take long on many.
        expect_equal(end_of_replay(end.journal, session % 10 == 0 ? 2 + session / 10 % 2 : 1), end);

        // A plan is followed on up to the interruption, and from there: what was said at that step is not
        // said again.
        meltscope::Run first = start_tiny();
        Plan before = plan, after = plan;
        before.erase(before.lower_bound(interrupted_at), before.end());
        after.erase(after.begin(), after.lower_bound(interrupted_at));
        {
            Console console(tiny_host(), false);
            if (drive(first, console, before, interrupted_at) != RunOutcome::stopped)
                continue;
        }
        meltscope::Run second = testing::take_up(kept(first));
        {
            Console console(tiny_host(), false);
            drive(second, console, after);
        }
        expect_equal(kept(second), end);
    }
}

TEST(ConsoleReplay, a_run_that_was_quit_replays_to_where_it_was_quit_and_goes_on_as_if_it_had_not_been) {
    const Plan quit{{3, {"power 20"}}, {9, {"quit"}}};
    meltscope::Run run = start_tiny();
    {
        Console console(tiny_host(), false);
        EXPECT_EQ(drive(run, console, quit), RunOutcome::stopped);
    }
    const CheckpointData stopped = kept(run);
    EXPECT_EQ(stopped.step, 9);
    EXPECT_TRUE(stopped.journal.ends_with(": quit\n"));
    expect_equal(end_of_replay(stopped.journal), stopped);

    meltscope::Run whole = start_tiny(), rest = testing::take_up(stopped);
    Console of_whole(tiny_host(), false), of_rest(tiny_host(), false);
    drive(whole, of_whole, {{3, {"power 20"}}});
    drive(rest, of_rest, {});
    expect_equal(kept(rest), kept(whole));
}

TEST(ConsoleReplay, a_stop_that_waited_for_its_time_leaves_its_landing_when_the_run_goes_on) {
    meltscope::Run run = start_tiny();
    {
        Console console(tiny_host(), false);
        EXPECT_EQ(drive(run, console, {{2, {"at 33 us quit"}}}), RunOutcome::stopped);
    }
    EXPECT_EQ(run.simulation.time, 33e-6);
    meltscope::Run rest = testing::take_up(kept(run));
    Console console(tiny_host(), false);
    drive(rest, console, {});
    expect_equal(end_of_replay(rest.journal), kept(rest));
}

TEST(ConsoleReplay, a_run_interrupted_between_outputs_by_its_command_line_replays_bit_for_bit) {
    meltscope::Run run = start_tiny();
    run.until = 51e-6;
    {
        Console console(tiny_host(), false);
        EXPECT_EQ(drive(run, console, {}), RunOutcome::interval);
    }
    meltscope::Run rest = testing::take_up(kept(run));
    Console console(tiny_host(), false);
    drive(rest, console, {});
    expect_equal(end_of_replay(rest.journal), kept(rest));
}

TEST(ConsoleReplay, looking_and_pausing_leave_the_run_as_it_would_have_been) {
    meltscope::Run plain = start_tiny(), looked_at = start_tiny();
    {
        Console console(tiny_host(), false);
        drive(plain, console, {});
    }
    Console console(tiny_host(), true);
    Speaker script;
    script.waits = true;
    const Console::Id id = console.open(std::move(script));
    for (const char* line :
         {"until t=33 us", "pool", "energy", "step 3", "snapshot", "run 20 us", "list", "status", "run"})
        console.say(id, line);
    console.finish(id);
    drive(looked_at, console, {});
    expect_equal(kept(looked_at), kept(plain));
}

TEST(ConsoleReplay, a_replay_that_departs_from_its_journal_is_refused) {
    EXPECT_THROW(end_of_replay("at step 3 t=1e-6: set laser.power 20 W\n"), JournalError);
    EXPECT_THROW(end_of_replay("at step 0 t=0: nonsense\n"), JournalError);
}

TEST(ConsoleReplay, what_lies_beyond_the_end_is_told) {
    meltscope::Run run = start_tiny();
    Console console(tiny_host(), false);
    console.replay("at step 100000 t=1: set laser.power 20 W\n", "journal.txt");
    drive(run, console, {});
    EXPECT_NE(console.left_of_replay(), "");
}

/// Collects what a speaker is told.
struct Heard {
    std::vector<std::string> answers;
    std::function<void(const std::string&, const Reply&)> listener() {
        return [this](const std::string& line, const Reply& reply) {
            answers.push_back(line + "|" + reply.text);
        };
    }
};

Speaker script_speaker(std::function<void(const std::string&, const Reply&)> answer = {}) {
    Speaker speaker;
    speaker.name = "s.txt";
    speaker.waits = speaker.must_succeed = true;
    speaker.most_lines = 100;
    speaker.answer = std::move(answer);
    return speaker;
}

Speaker pipe_speaker() {
    Speaker speaker = script_speaker();
    speaker.stops_at_end = true;
    return speaker;
}

TEST(ConsoleScript, lines_after_run_wait_until_the_goal_and_the_run_then_goes_on_to_its_end) {
    meltscope::Run run = start_tiny();
    Console console(tiny_host(), true);
    Heard heard;
    const Console::Id script = console.open(script_speaker(heard.listener()));
    for (const char* line : {"run 5", "power 20", "step 2", "power 30"})
        console.say(script, line);
    console.finish(script);
    RunConnections connections;
    connections.commands.push_back(console.source());
    EXPECT_EQ(run_to_end(run, connections), RunOutcome::done);
    const auto entries = parse_journal(run.journal, "j");
    ASSERT_EQ(entries.size(), 2u);
    EXPECT_EQ(entries[0].step, 5);
    EXPECT_EQ(entries[1].step, 7);
    EXPECT_FALSE(console.script_error());
}

TEST(ConsoleScript, the_first_error_names_its_place_and_stops_the_run) {
    meltscope::Run run = start_tiny();
    Console console(tiny_host(), true);
    const Console::Id script = console.open(script_speaker());
    for (const char* line : {"# steps", "run 5", "powr 20", "power 30"})
        console.say(script, line);
    console.finish(script);
    RunConnections connections;
    connections.commands.push_back(console.source());
    EXPECT_EQ(run_to_end(run, connections), RunOutcome::stopped);
    EXPECT_EQ(run.simulation.step, 5);
    ASSERT_TRUE(console.script_error());
    EXPECT_TRUE(console.script_error()->starts_with("s.txt:3: powr 20: ")) << *console.script_error();
    EXPECT_EQ(run.simulation.parameters.lasers[0].power, 10.0);
}

TEST(ConsoleScript, a_pipe_that_ends_stops_the_run) {
    meltscope::Run run = start_tiny();
    Console console(tiny_host(), true);
    const Console::Id pipe = console.open(pipe_speaker());
    console.say(pipe, "run 4");
    console.finish(pipe);
    RunConnections connections;
    connections.commands.push_back(console.source());
    EXPECT_EQ(run_to_end(run, connections), RunOutcome::stopped);
    EXPECT_EQ(run.simulation.step, 4);
}

TEST(ConsoleScript, a_file_that_reads_itself_is_an_error) {
    const testing::TemporaryFolder folder;
    const std::string file = (folder / "loop.txt").string();
    testing::put(file, "source " + file + "\nsource " + file + "\n");
    meltscope::Run run = start_tiny();
    Console console(tiny_host(), true);
    const Console::Id script = console.open(script_speaker());
    console.say(script, "source " + file);
    console.finish(script);
    RunConnections connections;
    connections.commands.push_back(console.source());
    EXPECT_EQ(run_to_end(run, connections), RunOutcome::stopped);
    EXPECT_TRUE(console.script_error());
}

/// A console on a run that goes, and what is heard of it.
struct ConsolePrompt : ::testing::Test {
    meltscope::Run run = start_tiny();
    Console console{tiny_host(), false};
    Heard heard;
    RunConnections connections;

    Console::Id open(Speaker speaker) {
        speaker.answer = heard.listener();
        return console.open(std::move(speaker));
    }
    RunOutcome go() {
        connections.commands.push_back(console.source());
        return run_to_end(run, connections);
    }
};

TEST_F(ConsolePrompt, the_first_interrupt_pauses_the_second_stops) {
    Speaker speaker;
    speaker.keeps_run = true;
    open(std::move(speaker));
    connections.commands.push_back({[&](meltscope::Run& r) {
        if (r.simulation.step == 3)
            console.interrupt();
    }});
    std::thread user([&] {
        while (console.status_line().find("paused") == std::string::npos)
            std::this_thread::yield();
        console.interrupt();
    });
    EXPECT_EQ(go(), RunOutcome::stopped);
    user.join();
    EXPECT_EQ(run.simulation.step, 3);
    EXPECT_TRUE(run.journal.ends_with("quit\n"));
}

TEST_F(ConsolePrompt, those_who_look_on_cannot_change_the_run) {
    Speaker speaker;
    speaker.may_change = false;
    const Console::Id watcher = open(std::move(speaker));
    for (const char* line : {"power 20", "pause", "get laser.power"})
        console.say(watcher, line);
    EXPECT_EQ(go(), RunOutcome::done);
    EXPECT_EQ(run.journal, "");
    ASSERT_GE(heard.answers.size(), 3u);
    EXPECT_EQ(heard.answers[2], "get laser.power|laser.power = 10 W");
}

} // namespace
} // namespace meltscope
