#include "step_watch.hpp"

#include "text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace meltscope {
namespace {

constexpr double stretch = 0.5;        ///< s, over which speeds are measured
constexpr double notable_change = 0.1; ///< of dt
constexpr double least_scale = 0.9, most_scale = 1.1;

const char* limit_name(StepLimit limit) {
    switch (limit) {
    case StepLimit::diffusion:
        return "diffusion";
    case StepLimit::beam:
        return "the beam's speed";
    case StepLimit::max_step:
        return "time.max_step";
    case StepLimit::landing:
        break;
    }
    return "landing on an instant";
}

} // namespace

void StepWatch::log_step_size(const Simulation& simulation) {
    if (simulation.limit == StepLimit::landing)
        return; // every output has one
    const bool changed = std::abs(simulation.dt - logged_dt_) > notable_change * logged_dt_;
    if (simulation.limit == logged_limit_ && !changed)
        return;
    logged_limit_ = simulation.limit;
    logged_dt_ = simulation.dt;
    terminal_.note(fmt::format("step {}, t {}: dt {} ruled by {}", simulation.step,
                               in_si(simulation.time, "s"), in_si(simulation.dt, "s"),
                               limit_name(simulation.limit)));
}

void StepWatch::check_lasers(const Simulation& simulation) {
    warned_.resize(simulation.absorption.size());
    for (std::size_t n = 0; n < simulation.absorption.size(); ++n) {
        const Absorption& absorption = simulation.absorption[n];
        if (warned_[n] || absorption.absorbed <= 0.0 ||
            (absorption.scale >= least_scale && absorption.scale <= most_scale))
            continue;
        warned_[n] = true;
        terminal_.warn(fmt::format(
            "laser \"{}\" at t = {}: the surface's pieces took up {:.3g} of the power that meets "
            "material before it was scaled to be exact; a smaller domain.cell_size would resolve "
            "the spot better",
            simulation.parameters.lasers[n].name, in_si(simulation.time, "s"), 1.0 / absorption.scale));
    }
}

void StepWatch::measure_speed(const Run& run) {
    const auto now = std::chrono::steady_clock::now();
    const Simulation& simulation = run.simulation;
    const double seconds = std::chrono::duration<double>(now - stretch_start_).count();
    if (stretch_step_ > 0 && seconds < stretch)
        return;
    if (stretch_step_ > 0) {
        const double steps = double(simulation.step - stretch_step_);
        particle_steps_per_second_ =
            steps * double(simulation.particles.count()) / (run.wall.solver - stretch_solver_seconds_);
        const double rate = (simulation.time - stretch_time_) / seconds;
        time_rate_ = time_rate_ > 0.0 ? 0.7 * time_rate_ + 0.3 * rate : rate; // steadies the time of arrival
    }
    stretch_start_ = now;
    stretch_solver_seconds_ = run.wall.solver;
    stretch_step_ = simulation.step;
    stretch_time_ = simulation.time;
}

Progress StepWatch::progress_of(const Run& run) const {
    const Simulation& simulation = run.simulation;
    Progress progress;
    progress.time = simulation.time;
    progress.end = std::min(simulation.parameters.time.end, run.until.value_or(never));
    progress.step = simulation.step;
    progress.dt = simulation.dt;
    progress.particle_steps_per_second = particle_steps_per_second_;
    progress.pool = outputs_.pool();
    if (time_rate_ > 0.0)
        progress.seconds_left = (progress.end - simulation.time) / time_rate_;
    return progress;
}

void StepWatch::after_step(const Run& run) {
    log_step_size(run.simulation);
    check_lasers(run.simulation);
    measure_speed(run);
    if (terminal_.wants_progress())
        terminal_.progress(progress_of(run));
}

Sink StepWatch::sink() {
    const auto take = [this](const Run& run, const Due& due,
                             const std::shared_ptr<const Snapshot>& snapshot) {
        if (!due.output)
            return;
        terminal_.output_reached(progress_of(run), snapshot->peak_temperature);
        terminal_.note(
            fmt::format("particles are within {:.3g} K of the nodes", energy_spread(run.simulation)));
    };
    return {Sink::Wants::snapshot, &WallSeconds::output, take};
}

} // namespace meltscope
