#include "commands.hpp"
#include "exit_codes.hpp"
#include "machine.hpp"
#include "text.hpp"

#include "meltscope/beam/scan_path.hpp"
#include "meltscope/build/stl.hpp"
#include "meltscope/console/journal.hpp"
#include "meltscope/io/run_folder.hpp"
#include "meltscope/scenario/nearest_word.hpp"
#include "meltscope/scenario/scenario_file.hpp"
#include "meltscope/scenario/units.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <new>
#include <stdexcept>
#include <system_error>

using namespace meltscope;

namespace {

int report(const std::string& message, int code) {
    show(stderr, fmt::format("error: {}\n", message));
    return code;
}

/// Every word that could have stood in the place of an unknown one.
std::vector<std::string> known_words(const CLI::App& app) {
    std::vector<std::string> words;
    for (const CLI::Option* option : app.get_options()) {
        for (const std::string& name : option->get_lnames())
            words.push_back("--" + name);
        for (const std::string& name : option->get_snames())
            words.push_back("-" + name);
    }
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
        words.push_back(command->get_name());
    return words;
}

/// What was wrong on the command line, and what was probably meant.
std::string explain(const CLI::App& program, const CLI::ParseError& error) {
    const auto chosen = program.get_subcommands();
    const CLI::App& app = chosen.empty() ? program : *chosen.front();
    std::string message = error.what();
    if (const auto unknown = program.remaining(true); !unknown.empty()) {
        const std::string word = unknown.front().substr(0, unknown.front().find('='));
        message = fmt::format("unknown {} \"{}\"", word.starts_with('-') ? "option" : "word", word);
        if (const std::string near = nearest_word(word, known_words(app)); !near.empty())
            message += fmt::format("; did you mean {}?", near);
    }
    return fmt::format("{}\nSee meltscope {}--help.", message, chosen.empty() ? "" : app.get_name() + " ");
}

/// Runs the command; turns what it throws into a message and an exit code.
int carry_out(const Action& action) {
    try {
        return action();
    } catch (const UsageError& error) {
        return report(error.what(), exit_code::usage);
    } catch (const ScenarioError& error) {
        return report(error.what(), exit_code::usage);
    } catch (const GeometryError& error) {
        return report(error.what(), exit_code::usage);
    } catch (const PathError& error) {
        return report(error.what(), exit_code::usage);
    } catch (const RunFolderError& error) {
        return report(error.what(), exit_code::usage);
    } catch (const JournalError& error) { // not the journal of this run
        return report(error.what(), exit_code::usage);
    } catch (const UnitError& error) {
        return report(error.what(), exit_code::usage);
    } catch (const std::invalid_argument& error) { // parameters that make no sense together
        return report(error.what(), exit_code::usage);
    } catch (const std::filesystem::filesystem_error& error) {
        return report(fmt::format("{}: {}", error.path1().string(), error.code().message()),
                      exit_code::failed);
    } catch (const std::bad_alloc&) {
        return report("there is not enough memory", exit_code::failed);
    } catch (const std::exception& error) {
        return report(error.what(), exit_code::failed);
    }
}

} // namespace

int main(int argc, char** argv) {
    let_threads_sleep(argv);
    CLI::App program(
        "Laser powder bed fusion by the Material Point Method, seen and steered while it computes.",
        "meltscope");
    program.set_version_flag("--version", version_text(), "Show version, compiler, SIMD width and libraries");
    program.require_subcommand(1);
    program.footer(
        "Examples:\n"
        "  meltscope check scenarios/quick_look.toml\n"
        "  meltscope run scenarios/quick_look.toml --output runs/quick\n"
        "  meltscope COMMAND --help\n"
        "Exit codes: 0 done; 1 failed; 2 bad usage or bad input; 3 stopped on request, with a checkpoint.");
    Action chosen;
    add_run(program, chosen);
    add_check(program, chosen);
    add_bench(program, chosen);
    add_info(program, chosen);
    add_movie(program, chosen);
    add_render(program, chosen);
    add_report(program, chosen);
    add_attach(program, chosen);
    try {
        program.parse(argc, argv);
    } catch (const CLI::Success& success) { // --help, --version
        return program.exit(success);
    } catch (const CLI::ParseError& error) {
        return report(explain(program, error), exit_code::usage);
    }
    return carry_out(chosen);
}
