#include "tiny_run.hpp"

#include "meltscope/console/commands.hpp"
#include "meltscope/console/parameters.hpp"

#include "../io/temporary_folder.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <sstream>

namespace meltscope {
namespace {

using testing::has;
using testing::start_tiny;
using testing::TemporaryFolder;
using testing::tiny_host;

/// A console on a tiny run.
struct Tiny : ::testing::Test {
    meltscope::Run run = start_tiny();
    ConsoleState console{tiny_host()};

    std::string ok(const std::string& line) {
        const Reply reply = execute(console, run, line);
        EXPECT_TRUE(reply.ok) << line << ": " << reply.text;
        return reply.text;
    }
    std::string fails(const std::string& line) {
        const std::string journal = run.journal;
        const std::string steering = steering_text(steering_of(run.simulation.parameters, run.schedule));
        const Reply reply = execute(console, run, line);
        EXPECT_FALSE(reply.ok) << line << ": " << reply.text;
        EXPECT_EQ(run.journal, journal) << line;
        EXPECT_EQ(steering_text(steering_of(run.simulation.parameters, run.schedule)), steering) << line;
        return reply.text;
    }
    Laser& laser() { return run.simulation.parameters.lasers[0]; }
    void steps(int count) {
        for (int n = 0; n < count; ++n)
            advance(run.simulation, 1.0);
    }
};

using ConsoleCommands = Tiny;

TEST_F(ConsoleCommands, unknown_words_get_a_suggestion) {
    EXPECT_TRUE(has(fails("powr 20"), "did you mean power"));
    EXPECT_TRUE(has(fails("set laser.pwer 20"), "did you mean laser.power"));
    EXPECT_TRUE(has(fails("view overvew"), "did you mean overview"));
}

TEST_F(ConsoleCommands, power_takes_units_answers_old_and_new_and_is_noted) {
    const std::string reply = ok("power 0.02 kW");
    EXPECT_TRUE(has(reply, "10 W -> 20 W (step 0, t = 0 s)")) << reply;
    EXPECT_EQ(laser().power, 20.0);
    EXPECT_EQ(run.journal, "at step 0 t=0: set laser.power 20 W\n");
}

TEST_F(ConsoleCommands, power_overrides_powers_of_the_path) {
    ok("path line 100 um 60 um speed 0.5 power 3");
    ok("power red 12");
    double power = 0.0;
    beam_now(laser(), run.simulation.time + 170e-6, power);
    EXPECT_EQ(power, 12.0);
}

TEST_F(ConsoleCommands, values_out_of_range_and_wrong_units_change_nothing) {
    for (const char* line : {"power -1",
                             "power 3 m",
                             "power",
                             "power 3 4",
                             "power nan",
                             "spot 1 um",
                             "spot -3",
                             "spot 85",
                             "speed 0",
                             "speed 800",
                             "path line 60 um 60 um speed 800",
                             "set laser.absorptivity 1.5",
                             "set laser.on perhaps",
                             "set time.cfl 0",
                             "set time.cfl 2",
                             "set time.end 0",
                             "set output.every 0",
                             "set output.every -1 s",
                             "set output.every_steps 0",
                             "set physics.ambient -300 degC",
                             "set physics.quiescent_tolerance -1 K",
                             "set physics.transfer flip",
                             "set boundary.x_min warm",
                             "set boundary.x_min temperature -3",
                             "set boundary.x_min temperature 300 K 4",
                             "set render.color_range 2000 300",
                             "set laser.power 20 W more",
                             "set physics.reabsorption on",
                             "set render.views top nothing",
                             "set output.particles few",
                             "path line 1 1 speed 1",
                             "path line 60 um 60 um",
                             "path dwell -1",
                             "path dwell 0",
                             "path load /nowhere",
                             "path line 60 um 60 um speed 1 power -2",
                             "at 1 ms nothing",
                             "at 1 ms at 2 ms off",
                             "at -1 off",
                             "at 1 ms power -1",
                             "at 1 ms power 3 m",
                             "at 1 ms spot 1 um",
                             "at 1 ms off 3",
                             "at 1 ms set laser.absorptivity 1.5",
                             "at 1 ms set nothing 3",
                             "at 1 ms set physics.transfer flip",
                             "at 0.1 ms set time.end 0.1 ms",
                             "at 0.1 ms until t=0.1 ms",
                             "at 1 ms step 0",
                             "at 1 ms set boundary.x_min warm",
                             "at 1 ms view top nothing",
                             "at 1 ms path line 1 1 speed 1",
                             "at 1 ms path line 60 um 60 um",
                             "at 1 ms path load /nowhere",
                             "at 1 ms layer thickness 40 um",
                             "at 1 ms probe 1 2 3",
                             "at 1 ms save",
                             "at 1 ms snapshot x.png",
                             "at 1 ms get nothing",
                             "at 1 ms help nothing",
                             "restore /nowhere",
                             "layer",
                             "layer thickness 1",
                             "layer thickness 40 um",
                             "layer thickness 400 um homogenised",
                             "step 0",
                             "step x",
                             "run 0.0",
                             "until t=0",
                             "until step=0",
                             "land 0",
                             "probe 1 2 3",
                             "probe 0 0",
                             "source /nowhere",
                             "help nothing",
                             "list nothing",
                             "get",
                             "get nothing",
                             "snapshot x.png",
                             "save",
                             "adopt",
                             "adopt time.end=1",
                             "adopt laser.path_file=x.txt",
                             "detach",
                             "help nothing.here",
                             "\"",
                             "history 3"})
        fails(line);
}

TEST_F(ConsoleCommands, what_waits_is_judged_when_it_is_given_and_done_when_it_is_due) {
    int shown = 0;
    console.host.set_render = [&](const RenderSettings&) { ++shown; };
    steps(2);
    const CheckpointData before = testing::kept(run);
    const RenderSettings render_before = console.render;
    for (const char* line :
         {"at 50 us power 20", "at 50 us set physics.radiation on",
          "at 50 us set boundary.x_min temperature 500", "at 50 us path line 60 um 60 um speed 1",
          "at 50 us view top", "at 50 us step 3", "at 50 us pause",
          "at 50 us layer thickness 55 um d10 30 um d50 40 um d90 50 um packing 0.3 seed 3",
          "at 50 us snapshot", "at 50 us energy", "at 50 us quit"})
        ok(line);
    run.journal = before.journal; // which has them, and nothing else that changed
    testing::expect_equal(testing::kept(run), before);
    EXPECT_EQ(console.render, render_before);
    EXPECT_EQ(shown, 0);
    EXPECT_EQ(console.goal.number, 0);
    EXPECT_TRUE(console.running);
    EXPECT_FALSE(run.stop_reason);
    EXPECT_FALSE(run.wanted.any());
    while (run.simulation.time < 50e-6)
        advance(run.simulation, 50e-6);
    for (const Reply& reply : execute_due(console, run))
        EXPECT_TRUE(reply.ok) << reply.text;
    EXPECT_EQ(laser().power, 20.0);
    EXPECT_EQ(shown, 1);
    EXPECT_TRUE(run.stop_reason);
}

TEST_F(ConsoleCommands, what_only_the_present_state_forbids_may_wait_and_says_so) {
    const std::string text = ok("at 1 ms speed 2"); // the path ends long before
    EXPECT_TRUE(has(text, "as things stand it will fail: the path of red has no line left")) << text;
    EXPECT_TRUE(has(ok("at 1 ms set physics.reabsorption on"), "switch physics.radiation on first"));
    EXPECT_FALSE(has(ok("at 50 us speed 2"), "fail"));
    EXPECT_EQ(console.waiting.size(), 3u);
}

TEST_F(ConsoleCommands, a_loss_that_the_material_has_no_data_for_is_refused_at_once) {
    run.simulation.parameters.materials[0].emissivity.reset();
    EXPECT_TRUE(has(fails("set physics.radiation on"), "emissivity"));
    EXPECT_TRUE(has(fails("at 50 us set physics.radiation on"), "emissivity"));
}

TEST_F(ConsoleCommands, every_parameter_is_shown_and_most_can_be_set_to_what_the_journal_keeps) {
    for (const auto& [name, value] : std::vector<std::pair<std::string, std::string>>{
             {"laser.power", "20 W"},
             {"laser.speed", "0.25 m/s"},
             {"laser.spot_radius", "4e-05 m"},
             {"laser.absorptivity", "0.3"},
             {"laser.on", "off"},
             {"output.every", "2e-05 s"},
             {"output.every_steps", "7"},
             {"output.particles", "melt"},
             {"render.every", "1e-05 s"},
             {"render.views", "top section"},
             {"render.field", "phi"},
             {"render.color_range", "300 K 2000 K"},
             {"render.colormap", "viridis"},
             {"render.background", "light"},
             {"checkpoint.every", "5e-05 s"},
             {"physics.radiation", "on"},
             {"physics.evaporation", "on"},
             {"physics.reabsorption", "on"},
             {"physics.ambient", "310 K"},
             {"physics.quiescent_tolerance", "0.001 K"},
             {"physics.convection", "20 W/m^2/K"},
             {"physics.blend_time", "1e-05 s"},
             {"physics.diffusion", "energy"},
             {"time.cfl", "0.25"},
             {"time.max_step", "1e-06 s"},
             {"time.end", "0.0003 s"},
             {"boundary.x_min", "temperature 400 K"},
             {"boundary.x_max", "convection 100 W/m^2/K ambient 300 K"},
             {"boundary.z_min", "flux 1000 W/m^2"}}) {
        const std::string before = run.journal;
        ok("set " + name + " " + value);
        EXPECT_EQ(run.journal.substr(before.size()), "at step 0 t=0: set " + name + " " + value + "\n");
    }
    const std::string all = ok("list");
    for (const Parameter& parameter : parameters_of(run.simulation.parameters.lasers)) {
        EXPECT_TRUE(has(all, parameter.name));
        EXPECT_TRUE(has(ok("get " + parameter.name), parameter.name));
    }
}

TEST_F(ConsoleCommands, several_lasers_are_told_apart) {
    Laser second = laser();
    second.name = "blue";
    run.simulation.parameters.lasers.push_back(second);
    update_geometry(run.simulation);
    EXPECT_TRUE(has(fails("power 20"), "laser.red.power or laser.blue.power"));
    EXPECT_TRUE(has(fails("path clear"), "red or blue"));
    ok("power blue 20");
    EXPECT_EQ(run.simulation.parameters.lasers[0].power, 10.0);
    EXPECT_EQ(run.simulation.parameters.lasers[1].power, 20.0);
    ok("off red");
    EXPECT_FALSE(run.simulation.parameters.lasers[0].on);
    ok("path blue clear");
    EXPECT_TRUE(has(run.journal, "path blue clear"));
}

TEST_F(ConsoleCommands, the_beam_goes_on_from_where_it_is_when_its_path_is_edited) {
    steps(5);
    double power = 0.0;
    const Vec3 before = beam_now(laser(), run.simulation.time, power).position;
    for (const char* line :
         {"path line 60 um 20 um speed 1 m/s", "speed 2", "path dwell 10 us power 5 W", "path clear",
          "path goto 60 um 60 um 60 um speed 1", "path line 20 um 20 um speed 0.1"}) {
        ok(line);
        EXPECT_EQ(beam_now(laser(), run.simulation.time, power).position, before) << line;
    }
    EXPECT_EQ(laser().path.segments.size(), 2u);
    EXPECT_TRUE(has(ok("path show"), "line to (0.02, 0.02, 0.06) mm at 100 mm/s"));
}

TEST_F(ConsoleCommands, a_path_is_shown_as_it_was_typed) {
    ok("path clear");
    ok("path line 100 um 60 um speed 800 mm/s power 12 W");
    ok("path goto 60 um 60 um");
    ok("path dwell 20 us off");
    const std::string text = ok("path show");
    EXPECT_TRUE(has(text, "2  goto (0.06, 0.06, 0.06) mm\n")) << text;
    EXPECT_TRUE(has(text, "1  line to (0.1, 0.06, 0.06) mm at 800 mm/s, 12 W\n")) << text;
    EXPECT_TRUE(has(text, "3  dwell at (0.06, 0.06, 0.06) mm for 20 us, no light")) << text;
}

TEST_F(ConsoleCommands, a_probe_says_where_the_surface_is) {
    EXPECT_TRUE(has(ok("probe 80 um 60 um 60 um"), "K, at the surface"));
    EXPECT_TRUE(has(ok("probe 80 um 60 um 40 um"), "um below the surface"));
    EXPECT_TRUE(has(ok("probe 80 um 60 um 110 um"), "no material near there"));
}

TEST_F(ConsoleCommands, a_path_file_goes_into_the_journal_with_its_rows) {
    const TemporaryFolder folder;
    testing::put(folder / "path.txt",
                 "Mode X Y Z Power Param\r\n1 4e-5 4e-5 6e-5 0 0\n\n0 1e-4 4e-5 6e-5 7 0.5\n");
    ok("path load " + (folder / "path.txt").string());
    const ScanPath loaded = laser().path;
    const std::string journal = run.journal;
    std::filesystem::remove(folder / "path.txt");
    meltscope::Run again = start_tiny();
    ConsoleState other{tiny_host()};
    const std::string command = parse_journal(journal, "j").at(0).command;
    const Reply reply = execute(other, again, command);
    EXPECT_TRUE(reply.ok) << reply.text;
    EXPECT_EQ(again.simulation.parameters.lasers[0].path, loaded);
    EXPECT_EQ(again.journal, journal);
}

TEST_F(ConsoleCommands, looking_changes_neither_state_nor_journal) {
    steps(3);
    ok("at 1 ms off");
    const CheckpointData before = testing::kept(run);
    for (const char* line :
         {"status", "list", "get laser.power", "path show", "probe 40 um 60 um 30 um", "pool", "energy",
          "history", "help", "help path", "snapshot", "", "# comment", "record"})
        ok(line);
    testing::expect_equal(testing::kept(run), before);
}

TEST_F(ConsoleCommands, goals_are_set_by_run_step_and_until) {
    ok("run 5");
    EXPECT_EQ(console.goal.step, 5);
    ok("run 50 us");
    EXPECT_EQ(console.goal.time, 50e-6);
    ok("step");
    EXPECT_EQ(console.goal.step, 1);
    ok("until t=0.1 ms");
    EXPECT_EQ(console.goal.time, 1e-4);
    ok("until t = 0.1 ms");
    ok("until 0.1 ms");
    ok("until step=12");
    EXPECT_EQ(console.goal.step, 12);
    ok("until step 12");
    ok("pause");
    EXPECT_FALSE(console.running);
    ok("continue");
    EXPECT_TRUE(console.running);
    EXPECT_EQ(console.goal.step, 12);
    EXPECT_EQ(run.journal, "");
}

TEST_F(ConsoleCommands, restore_puts_state_steering_journal_and_waiting_commands_back) {
    const TemporaryFolder folder;
    const std::string file = (folder / "a.h5").string();
    ok("power 15");
    ok("at 1 ms power 30");
    steps(4);
    ok("save " + file);
    const CheckpointData before = testing::kept(run);
    steps(4);
    ok("set boundary.x_min temperature 500 K");
    ok("at 1 ms off");
    ok("restore " + file);
    testing::expect_equal(testing::kept(run), before);
    ASSERT_EQ(console.waiting.size(), 1u);
    EXPECT_EQ(console.waiting[0].command, "power 30");
    EXPECT_FALSE(console.running);
}

TEST_F(ConsoleCommands, a_layer_is_in_the_journal_with_all_that_a_replay_needs) {
    ok("layer thickness 55 um d10 30 um d50 40 um d90 50 um packing 0.3 seed 3 basis volume");
    const CheckpointData laid = testing::kept(run);
    meltscope::Run again = start_tiny();
    ConsoleState other{tiny_host()};
    const Reply reply = execute(other, again, parse_journal(run.journal, "j").at(0).command);
    EXPECT_TRUE(reply.ok) << reply.text;
    testing::expect_equal(testing::kept(again), laid);
}

TEST_F(ConsoleCommands, help_tells_what_a_parameter_is) {
    const std::string text = ok("help laser.power");
    EXPECT_TRUE(has(text, "laser.power = 10 W"));
    EXPECT_TRUE(has(text, "W, 0 or more"));
}

TEST_F(ConsoleCommands, a_layer_adds_powder_and_its_energy) {
    const std::int64_t before = run.simulation.particles.count();
    ok("layer thickness 55 um d10 30 um d50 40 um d90 50 um packing 0.3 seed 3 temperature 400");
    EXPECT_GT(run.simulation.particles.count(), before);
    steps(2);
    balance(run.simulation);
    EXPECT_GT(run.simulation.ledger.added, 0.0);
    EXPECT_LT(std::abs(run.simulation.ledger.relative_residual()), 1e-12);
}

TEST_F(ConsoleCommands, recorded_commands_can_be_sourced) {
    const TemporaryFolder folder;
    const std::string file = (folder / "session.txt").string();
    ok("record " + file);
    ok("power 20");
    fails("nonsense");
    ok("spot 40 um");
    ok("record stop");
    ok("power 30");
    EXPECT_EQ(testing::contents_of(file),
              "# Commands for `source FILE` or --script FILE\npower 20\nspot 40 um\n");
    ok("source " + file);
    EXPECT_EQ(console.sourced.size(), 3u);
}

} // namespace
} // namespace meltscope
