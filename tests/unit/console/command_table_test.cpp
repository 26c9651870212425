// What needs no run: the table of commands, words, completions and the text of the journal.
#include "tiny_run.hpp"

#include "meltscope/console/commands.hpp"
#include "meltscope/console/parameters.hpp"

#include "../io/temporary_folder.hpp"

#include <algorithm>
#include <cmath>

namespace meltscope {
namespace {

using testing::has;
using testing::TemporaryFolder;

TEST(ConsoleTable, every_command_has_help_an_example_that_names_it_and_a_handler) {
    for (const Command& command : command_table()) {
        EXPECT_FALSE(command.help.empty()) << command.name;
        EXPECT_TRUE(command.example.starts_with(command.name)) << command.name;
        EXPECT_NE(command.handler, nullptr) << command.name;
        EXPECT_TRUE(has(help_text(command), command.example));
        EXPECT_TRUE(has(help_text(), command.name));
    }
}

TEST(ConsoleTable, help_fits_terminals_of_eighty_columns_and_keeps_its_words) {
    std::string all = help_text();
    for (const Command& command : command_table()) {
        const std::string text = help_text(command);
        all += '\n' + text;
        const auto words_of = [](const std::string& of) {
            std::istringstream stream(of);
            return std::vector<std::string>(std::istream_iterator<std::string>(stream), {});
        };
        const std::vector<std::string> shown = words_of(text), wanted = words_of(command.help);
        EXPECT_NE(std::search(shown.begin(), shown.end(), wanted.begin(), wanted.end()), shown.end()) << text;
    }
    std::istringstream rows(all);
    for (std::string row; std::getline(rows, row);)
        EXPECT_LT(row.size(), 80u) << row;
}

TEST(ConsoleTable, what_users_were_promised_is_there_and_nothing_twice) {
    std::vector<std::string> commands, parameters;
    for (const Command& command : command_table())
        commands.push_back(command.name);
    for (const Parameter& parameter : parameters_of({Laser{}}))
        parameters.push_back(parameter.name);
    for (const char* name :
         {"status", "run",   "pause",   "continue", "step", "until",  "get",     "set",      "list",  "path",
          "power",  "speed", "spot",    "on",       "off",  "view",   "field",   "snapshot", "probe", "pool",
          "energy", "save",  "restore", "layer",    "at",   "record", "history", "source",   "help",  "quit"})
        EXPECT_EQ(std::count(commands.begin(), commands.end(), name), 1) << name;
    for (const char* name : {"laser.power",
                             "laser.speed",
                             "laser.spot_radius",
                             "laser.absorptivity",
                             "laser.on",
                             "output.every",
                             "render.every",
                             "render.views",
                             "render.color_range",
                             "physics.diffusion",
                             "physics.transfer",
                             "physics.deposit",
                             "physics.blend_time",
                             "physics.radiation",
                             "physics.evaporation",
                             "physics.reabsorption",
                             "physics.convection",
                             "physics.ambient",
                             "physics.quiescent_tolerance",
                             "time.cfl",
                             "boundary.x_min",
                             "boundary.x_max",
                             "boundary.y_min",
                             "boundary.y_max",
                             "boundary.z_min",
                             "boundary.z_max"})
        EXPECT_EQ(std::count(parameters.begin(), parameters.end(), name), 1) << name;
    for (std::vector<std::string>* names : {&commands, &parameters}) {
        std::sort(names->begin(), names->end());
        EXPECT_EQ(std::adjacent_find(names->begin(), names->end()), names->end());
    }
}

TEST(ConsoleTable, the_manual_in_the_repository_is_current) {
    EXPECT_EQ(testing::contents_of(std::filesystem::path(MELTSCOPE_SOURCE_DIR) / "docs/console.md"),
              console_manual());
}

TEST(ConsoleTable, unambiguous_beginnings_mean_the_command) {
    EXPECT_EQ(find_command("stat").name, "status");
    EXPECT_EQ(find_command("on").name, "on");
    EXPECT_THROW(find_command("s"), CommandError);
}

TEST(ConsoleWords, quotes_keep_blanks_and_comments_are_dropped) {
    EXPECT_EQ(split_words("save \"my file.h5\" # now"), (std::vector<std::string>{"save", "my file.h5"}));
    EXPECT_EQ(split_words("probe 1,2,\t3"), (std::vector<std::string>{"probe", "1", "2", "3"}));
    EXPECT_THROW(split_words("save \"x"), CommandError);
    EXPECT_EQ(split_words("adopt 'render.views=[\"top\"]'"),
              (std::vector<std::string>{"adopt", "render.views=[\"top\"]"}));
    for (const char* word :
         {"plain", "with blank", "a,b", "#", "", "it's", "say \"so\"", "\"it's\"", "[\"a\", 'b']"})
        EXPECT_EQ(split_words(as_word(word)), std::vector<std::string>{word});
}

TEST(ConsoleWords, numbers_written_exactly_read_back_bit_for_bit) {
    for (const double value : {0.1, 1.0 / 3.0, 85e-6, 1e300, 5e-324, std::nextafter(1.0, 2.0)}) {
        Arguments alone({exact(value)}), with_unit({exact(value), "s"});
        EXPECT_EQ(alone.quantity("t", quantity::time), value);
        EXPECT_EQ(with_unit.quantity("t", quantity::time), value);
    }
}

TEST(ConsoleCompletion, commands_parameters_values_views_and_files_are_completed) {
    const CompletionNames names{
        {"laser.power", "laser.speed", "laser.on", "time.end"}, {"temperature", "phi"}, {"red"}, {"metal"}};
    using Words = std::vector<std::string>;
    EXPECT_EQ(completions("sta", names), Words{"status"});
    EXPECT_EQ(completions("set laser.p", names), Words{"laser.power"});
    EXPECT_EQ(completions("set laser.on o", names), (Words{"on", "off"}));
    EXPECT_EQ(completions("field ", names), (Words{"temperature", "phi"}));
    EXPECT_EQ(completions("view ov", names), Words{"overview"});
    EXPECT_EQ(completions("path d", names), Words{"dwell"});
    EXPECT_EQ(completions("help qu", names), Words{"quit"});
    EXPECT_EQ(completions("help time.", names), Words{"time.end"});
    EXPECT_EQ(completions("layer thickness 40 um ma", names), Words{"material"});
    EXPECT_EQ(completions("layer material ", names), Words{"metal"});
    EXPECT_EQ(completions("power ", names), Words{}); // one laser need not be named
    CompletionNames two = names;
    two.lasers = {"red", "blue"};
    EXPECT_EQ(completions("power ", two), (Words{"red", "blue"}));
    EXPECT_EQ(completions("path b", two), Words{"blue"});
    EXPECT_EQ(completions("path blue ap", two), Words{"append"});
    EXPECT_EQ(completions("at 1 ms pow", names), Words{"power"});
    EXPECT_EQ(completions("at 1 ms set time.", names), Words{"time.end"});
    EXPECT_EQ(completions("nonsense ", names), Words{});
    const TemporaryFolder folder;
    testing::put(folder / "start.h5");
    testing::put(folder / "sub/x");
    const std::string at = folder.path().string() + "/";
    EXPECT_EQ(completions("restore " + at + "st", names), Words{at + "start.h5"});
    EXPECT_EQ(completions("save " + at + "su", names), Words{at + "sub/"});
}

TEST(ConsoleJournal, entries_read_back_as_written) {
    const std::vector<JournalEntry> entries{{0, 0.0, "set laser.power 20 W", false, 1},
                                            {17, 1.0 / 3.0, "off", true, 2},
                                            {17, 1.0 / 3.0, "path dwell 1e-05", false, 3}};
    std::string text = "# a comment\n\n";
    for (const JournalEntry& entry : entries)
        text += journal_line(entry);
    EXPECT_EQ(parse_journal(text, "j"), entries);
    for (const char* wrong :
         {"nonsense\n", "at step 1 t=: x\n", "at step 1 t=nan: x\n", "at step 1 t=0: \n",
          "at step 2 t=1: x\nat step 1 t=1: x\n", "at step 99999999999999999999 t=0: x\n"})
        EXPECT_THROW(parse_journal(wrong, "j"), JournalError) << wrong;
}

} // namespace
} // namespace meltscope
