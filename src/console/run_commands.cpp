#include "meltscope/console/commands.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

/// Commands that say how far the run goes.
namespace meltscope {
namespace {

std::string now(const Run& run) {
    return fmt::format("step {}, t = {}", run.simulation.step, shown(run.simulation.time, "s"));
}

const char* name_of(StepLimit limit) {
    switch (limit) {
    case StepLimit::diffusion:
        return "diffusion";
    case StepLimit::beam:
        return "beam";
    case StepLimit::max_step:
        return "time.max_step";
    case StepLimit::landing:
        break;
    }
    return "landing";
}

/// Sets the run going towards a new goal.
void go(Call& call, std::optional<std::int64_t> step, std::optional<double> time) {
    if (call.rehearsal)
        return;
    Run& run = call.run;
    if (run.simulation.time >= run.simulation.parameters.time.end)
        throw CommandError(
            fmt::format("the run has reached its end, {}; `set time.end TIME` lets it go on", now(run)));
    if (at_end_of_run(run)) { // where the command line had it pause
        run.until.reset();
        run.last_step.reset();
    }
    call.console.goal = {call.console.goal.number + 1, step, time};
    call.console.running = true;
    call.starts = true;
}

std::string go_steps(Call& call, std::int64_t steps) {
    call.arguments.done();
    if (steps < 1)
        throw CommandError("at least one step is to be done");
    go(call, call.run.simulation.step + steps, std::nullopt);
    return fmt::format("running {} step{} from {}", steps, steps == 1 ? "" : "s", now(call.run));
}

std::string go_until(Call& call, double time) {
    call.arguments.done();
    if (!(time > call.run.simulation.time && std::isfinite(time)))
        throw CommandError(fmt::format("{} is not after now, {}", shown(time, "s"), now(call.run)));
    go(call, std::nullopt, time);
    return fmt::format("running from {} until {}", now(call.run), shown(time, "s"));
}

} // namespace

std::filesystem::path file_to_write(Call& call) {
    if (call.arguments.empty())
        return {};
    if (call.console.from_journal)
        throw CommandError("a journal names no file to write");
    return call.arguments.word("the file");
}

std::string do_status(Call& call) {
    call.arguments.done();
    const Simulation& s = call.run.simulation;
    std::string text = fmt::format(
        "{} at {}", call.console.running && !at_end_of_run(call.run) ? "running" : "paused", now(call.run));
    if (s.step > 0)
        text += fmt::format(", dt = {} ({})", shown(s.dt, "s"), name_of(s.limit));
    text += fmt::format("; ends at {}\n{} particles, {} nodes", shown(s.parameters.time.end, "s"),
                        s.particles.count(), s.grid.node_count());
    for (const Laser& laser : s.parameters.lasers) {
        double power = 0.0;
        const BeamPosition beam = beam_now(laser, s.time, power);
        const Vec3 at = 1e3 * beam.position;
        text += fmt::format("\n{}: {}, {}, at ({:.6g}, {:.6g}, {:.6g}) mm{}", laser.name, shown(power, "W"),
                            shown(beam.speed, "m/s"), at[0], at[1], at[2],
                            !laser.on       ? ", off"
                            : beam.finished ? ", path finished"
                                            : "");
    }
    if (call.console.goal.step && call.console.running)
        text += fmt::format("\npauses at step {}", *call.console.goal.step);
    if (call.console.goal.time && call.console.running)
        text += fmt::format("\npauses at t = {}", shown(*call.console.goal.time, "s"));
    for (const WaitingCommand& waiting : call.console.waiting)
        text += fmt::format("\nwaits for {}: {}", shown(waiting.time, "s"), waiting.command);
    return text;
}

std::string do_run(Call& call) {
    Arguments& arguments = call.arguments;
    if (arguments.empty()) {
        go(call, std::nullopt, std::nullopt);
        return fmt::format("running from {}", now(call.run));
    }
    const std::string first = arguments.word("how far");
    if (arguments.empty() && is_count(first))
        return go_steps(call, std::stoll(first));
    Arguments again(split_words(arguments.empty() ? first : first + " " + arguments.rest()));
    const double span = again.quantity("how long", quantity::time);
    again.done();
    require_positive(span, "how long to run", "s");
    return go_until(call, call.run.simulation.time + span);
}

std::string do_step(Call& call) {
    return go_steps(call, call.arguments.empty() ? 1 : call.arguments.count("the number of steps"));
}

std::string do_until(Call& call) {
    std::string target = call.arguments.rest();
    const auto drop = [&](std::string_view front) {
        const bool there = target.starts_with(front);
        if (there)
            target = target.substr(front.size());
        return there;
    };
    const bool step = drop("step");
    const bool time = !step && (target.starts_with("t=") || target.starts_with("t ")) && drop("t");
    target.erase(0, target.find_first_not_of(' '));
    drop("=");
    Arguments arguments(split_words(target));
    if (!step) {
        const double t = arguments.quantity(time ? "t" : "the time", quantity::time);
        arguments.done();
        return go_until(call, t);
    }
    const std::int64_t last = arguments.count("step");
    arguments.done();
    if (last <= call.run.simulation.step)
        throw CommandError(fmt::format("step {} is not after now, {}", last, now(call.run)));
    go(call, last, std::nullopt);
    return fmt::format("running from {} until step {}", now(call.run), last);
}

std::string do_pause(Call& call) {
    call.arguments.done();
    if (call.rehearsal)
        return {};
    const bool was_running = call.console.running;
    call.console.running = false;
    return fmt::format("{} at {}", was_running ? "paused" : "is paused", now(call.run));
}

std::string do_continue(Call& call) {
    call.arguments.done();
    if (call.console.running)
        return fmt::format("is running, {}", now(call.run));
    go(call, call.console.goal.step, call.console.goal.time);
    return fmt::format("going on from {}", now(call.run));
}

std::string do_land(Call& call) {
    const double time = call.arguments.quantity("the time", quantity::time);
    call.arguments.done();
    if (!(time > call.run.simulation.time))
        throw CommandError(fmt::format("{} is not after now, {}", shown(time, "s"), now(call.run)));
    std::vector<double>& landings = call.console.landings;
    if (std::find(landings.begin(), landings.end(), time) != landings.end())
        return fmt::format("a step ends at {} already", shown(time, "s"));
    landings.insert(std::upper_bound(landings.begin(), landings.end(), time), time);
    call.journal = fmt::format("land {} s", exact(time));
    return fmt::format("a step will end at {}", shown(time, "s"));
}

std::string do_quit(Call& call) {
    call.arguments.done();
    if (call.rehearsal)
        return {};
    if (at_end_of_run(call.run)) {
        call.console.leaves = true;
        return {};
    }
    call.run.stop_reason = "quit";
    call.journal = "quit";
    return fmt::format("stopping at {}", now(call.run));
}

} // namespace meltscope
