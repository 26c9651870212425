#include "meltscope/io/run_state.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace meltscope {
namespace {

constexpr std::array<std::pair<const char*, double Ledger::*>, 12> ledger_names{
    {{"emitted", &Ledger::emitted},
     {"missed", &Ledger::missed},
     {"reflected", &Ledger::reflected},
     {"absorbed", &Ledger::absorbed},
     {"radiated", &Ledger::radiated},
     {"convected", &Ledger::convected},
     {"evaporated", &Ledger::evaporated},
     {"conducted_out", &Ledger::conducted_out},
     {"face_flux_in", &Ledger::face_flux_in},
     {"added", &Ledger::added},
     {"stored_at_start", &Ledger::stored_at_start},
     {"stored", &Ledger::stored}}};

constexpr const char* mass_energy_name = "mass_energy";
constexpr const char* least_temperature_name = "least_temperature"; // K, one number
constexpr const char* awake_name = "awake";   // 1: the brick of bins takes part in the step; absent: all do
constexpr const char* powder_name = "powder"; // 1: homogenised powder that has not melted yet

/// Calls work(storage index of a row's first node) for all rows of nodes, ghosts included, in the order of
/// storage.
template <class Work>
void for_each_row(const Grid& grid, Work work) {
    for (std::int64_t k = -1; k <= grid.cells[2] + 1; ++k)
        for (std::int64_t j = -1; j <= grid.cells[1] + 1; ++j)
            work(grid.index(-1, j, k));
}

CheckpointGridArray without_padding(const Grid& grid, const char* name, const Field& field) {
    const Index3 count = grid.cells + 3;
    CheckpointGridArray array{name, {}, {}};
    for (const int axis : {2, 1, 0})
        array.dims.push_back(std::uint64_t(count[axis]));
    array.values.reserve(count.prod());
    for_each_row(grid, [&](std::int64_t first) {
        array.values.insert(array.values.end(), &field[first], &field[first] + count[0]);
    });
    return array;
}

const CheckpointGridArray* find_array(const CheckpointData& data, const char* name) {
    for (const CheckpointGridArray& array : data.grid)
        if (array.name == name)
            return &array;
    return nullptr;
}

CheckpointGridArray awake_array(const Bricks& bricks) {
    CheckpointGridArray array{awake_name, {}, {bricks.awake.begin(), bricks.awake.end()}};
    for (const int axis : {2, 1, 0})
        array.dims.push_back(std::uint64_t(bricks.count[axis]));
    return array;
}

std::vector<char> awake_from(const Grid& grid, const CheckpointData& data) {
    const CheckpointGridArray* array = find_array(data, awake_name);
    if (!array)
        return {};
    const Index3 count = brick_counts(grid);
    if (array->values.size() != std::size_t(count.prod()))
        throw CheckpointError(
            fmt::format("the checkpoint's /grid/{} has {} values where {} x {} x {} bricks need {}",
                        awake_name, array->values.size(), count[0], count[1], count[2], count.prod()));
    std::vector<char> awake;
    for (const double value : array->values)
        awake.push_back(value != 0.0);
    return awake;
}

/// The nodal field of that name; `elsewhere` fills the padding.
Field with_padding(const Grid& grid, const CheckpointData& data, const char* name, double elsewhere) {
    const CheckpointGridArray* array = find_array(data, name);
    if (!array)
        throw CheckpointError(fmt::format("the checkpoint has no /grid/{}", name));
    const Index3 count = grid.cells + 3;
    const std::vector<std::uint64_t> dims{std::uint64_t(count[2]), std::uint64_t(count[1]),
                                          std::uint64_t(count[0])};
    if (array->dims != dims)
        throw CheckpointError(fmt::format(
            "the checkpoint's grid is not that of the scenario: it has {} values of "
            "{} where {} x {} x {} cells need {}",
            array->values.size(), name, grid.cells[0], grid.cells[1], grid.cells[2], count.prod()));
    Field field(grid.size, elsewhere);
    auto from = array->values.begin();
    for_each_row(grid, [&](std::int64_t first) {
        std::copy_n(from, count[0], field.begin() + first);
        from += count[0];
    });
    return field;
}

/// A particle that no run has: its own error, so that nobody looks for it in the solver.
void require_possible(const CheckpointParticles& saved, std::size_t n) {
    const auto refuse = [&](const char* what, double value) {
        throw CheckpointError(
            fmt::format("particle {} of the checkpoint has an impossible {}: {}", saved.id[n], what, value));
    };
    for (std::size_t i = 3 * n; i < 3 * n + 3; ++i)
        if (!std::isfinite(saved.position[i]))
            refuse("position", saved.position[i]);
    if (!(saved.mass[n] > 0.0 && std::isfinite(saved.mass[n])))
        refuse("mass", saved.mass[n]);
    if (!(saved.volume[n] > 0.0 && std::isfinite(saved.volume[n])))
        refuse("volume", saved.volume[n]);
    if (!std::isfinite(saved.specific_energy[n]))
        refuse("specific energy", saved.specific_energy[n]);
}

ParticleList particles_from(const CheckpointParticles& saved, std::size_t materials) {
    ParticleList list;
    const std::size_t count = saved.id.size();
    list.position.reserve(count);
    list.material.reserve(count);
    for (std::size_t n = 0; n < count; ++n) {
        require_possible(saved, n);
        list.position.emplace_back(saved.position[3 * n], saved.position[3 * n + 1],
                                   saved.position[3 * n + 2]);
        if (saved.material[n] < 0 || std::size_t(saved.material[n]) >= materials)
            throw CheckpointError(
                fmt::format("particle {} of the checkpoint is of material {}, the scenario has {}",
                            saved.id[n], saved.material[n], materials));
        list.material.push_back(std::int16_t(saved.material[n]));
    }
    list.mass = saved.mass;
    list.volume = saved.volume;
    list.specific_energy = saved.specific_energy;
    list.id = saved.id;
    for (const auto& [name, values] : saved.extra)
        if (name == powder_name) {
            if (values.size() != count)
                throw CheckpointError(fmt::format("the checkpoint's array {} has {} values for {} particles",
                                                  name, values.size(), count));
            for (const double value : values)
                list.powder.push_back(value > 0.0);
        }
    return list;
}

} // namespace

std::vector<std::pair<std::string, double>> ledger_entries(const Ledger& ledger) {
    std::vector<std::pair<std::string, double>> entries;
    for (const auto& [name, member] : ledger_names)
        entries.emplace_back(name, ledger.*member);
    return entries;
}

Ledger ledger_from_entries(const std::vector<std::pair<std::string, double>>& entries) {
    Ledger ledger;
    for (const auto& [name, member] : ledger_names) {
        const auto entry = std::find_if(entries.begin(), entries.end(),
                                        [name = name](const auto& e) { return e.first == name; });
        if (entry == entries.end())
            throw CheckpointError(fmt::format("the checkpoint's ledger has no entry \"{}\"", name));
        ledger.*member = entry->second;
    }
    return ledger;
}

namespace {

constexpr const char* layers_laid_name = "layers_laid";
constexpr const char* melted_at_name = "melted_at";
constexpr const char* solidified_name = "solidified";
constexpr std::uint64_t solidified_columns = 8; // position, then the members of SolidifiedPoint in order

void append_solidification(const Grid& grid, const Solidification& record, CheckpointData& data) {
    data.grid.push_back(without_padding(grid, melted_at_name, record.melted_at));
    if (record.points.empty())
        return;
    CheckpointGridArray array{solidified_name, {record.points.size(), solidified_columns}, {}};
    for (const SolidifiedPoint& p : record.points)
        array.values.insert(array.values.end(), {p.position[0], p.position[1], p.position[2], p.melted,
                                                 p.solidified, p.cooling_rate, p.gradient, p.speed});
    data.grid.push_back(std::move(array));
}

} // namespace

CheckpointData checkpoint_of(const Run& run, const std::string& scenario) {
    const Simulation& simulation = run.simulation;
    CheckpointData data;
    data.time = simulation.time;
    data.step = simulation.step;
    data.dt = simulation.dt;
    ParticleList list = list_particles(simulation.particles);
    CheckpointParticles& particles = data.particles;
    particles.position.reserve(3 * list.position.size());
    for (const Vec3& x : list.position)
        particles.position.insert(particles.position.end(), {x[0], x[1], x[2]});
    particles.mass = std::move(list.mass);
    particles.volume = std::move(list.volume);
    particles.specific_energy = std::move(list.specific_energy);
    particles.id = std::move(list.id);
    particles.material.assign(list.material.begin(), list.material.end());
    if (!list.powder.empty())
        particles.extra.emplace_back(powder_name,
                                     std::vector<double>(list.powder.begin(), list.powder.end()));
    data.grid.push_back(without_padding(simulation.grid, mass_energy_name, simulation.nodes.mass_energy));
    data.grid.push_back({least_temperature_name, {1}, {simulation.least_temperature}});
    if (const Bricks& bricks = simulation.quiescence.bricks; !bricks.awake.empty())
        data.grid.push_back(awake_array(bricks));
    if (run.layers_laid > 0)
        data.grid.push_back({layers_laid_name, {1}, {double(run.layers_laid)}});
    if (run.solidification)
        append_solidification(simulation.grid, *run.solidification, data);
    data.scenario = scenario;
    data.steering = steering_text(steering_of(simulation.parameters, run.schedule));
    data.journal = run.journal;
    data.ledger = ledger_entries(simulation.ledger);
    return data;
}

namespace {

/// Checkpoints from before it was kept go on without.
double least_temperature_of(const CheckpointData& data) {
    const CheckpointGridArray* array = find_array(data, least_temperature_name);
    if (!array)
        return 0.0;
    if (array->values.size() != 1 || !(array->values.front() >= 0.0 && std::isfinite(array->values.front())))
        throw CheckpointError(
            fmt::format("the checkpoint's /grid/{} is not one temperature", least_temperature_name));
    return array->values.front();
}

} // namespace

Simulation simulation_from(const CheckpointData& data, RunParameters parameters, const Grid& grid,
                           int lattice) {
    if (!(data.time >= 0.0 && std::isfinite(data.time)) || data.step < 0 || data.step > 1'000'000'000'000'000)
        throw CheckpointError(fmt::format("the checkpoint is of an impossible instant: step {}, t = {} s",
                                          data.step, data.time));
    const Field mass_energy = with_padding(grid, data, mass_energy_name, 0.0);
    ParticleList particles = particles_from(data.particles, parameters.materials.size());
    return resume_simulation(std::move(parameters), grid, std::move(particles), lattice, data.time, data.step,
                             data.dt, ledger_from_entries(data.ledger), mass_energy,
                             least_temperature_of(data), awake_from(grid, data));
}

std::int64_t layers_laid_by(const CheckpointData& data) {
    const CheckpointGridArray* array = find_array(data, layers_laid_name);
    if (!array || array->values.empty())
        return 0;
    const double laid = array->values.front();
    if (!(laid >= 0.0 && laid <= 1e9))
        throw CheckpointError(fmt::format("the checkpoint says that {} powder layers were laid", laid));
    return std::int64_t(laid);
}

Solidification solidification_from(const CheckpointData& data, const Simulation& simulation) {
    if (!find_array(data, melted_at_name))
        return begin_solidification(simulation);
    std::vector<SolidifiedPoint> points;
    if (const CheckpointGridArray* array = find_array(data, solidified_name)) {
        if (array->dims.size() != 2 || array->dims[1] != solidified_columns)
            throw CheckpointError(fmt::format("the checkpoint's /grid/{} does not have {} columns",
                                              solidified_name, solidified_columns));
        for (const double* v = array->values.data(); v != array->values.data() + array->values.size();
             v += solidified_columns)
            points.push_back({{v[0], v[1], v[2]}, v[3], v[4], v[5], v[6], v[7]});
    }
    return resume_solidification(simulation, with_padding(simulation.grid, data, melted_at_name, -1.0),
                                 std::move(points));
}

} // namespace meltscope
