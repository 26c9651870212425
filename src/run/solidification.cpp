#include "meltscope/run/solidification.hpp"

#include "meltscope/run/simulation.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

namespace meltscope {
namespace {

constexpr double not_molten = -1.0;

/// Nodes up to so far outside, in cells, are in the material: those on a plane surface, whatever the
/// rounding.
constexpr double on_the_surface = 0.01;

double lowest_liquidus(const std::vector<EquationOfState>& materials) {
    double lowest = std::numeric_limits<double>::infinity();
    for (const EquationOfState& eos : materials)
        lowest = std::min(lowest, eos.liquidus);
    return lowest;
}

double liquidus_at(const Simulation& s, std::int64_t node) {
    std::size_t most = 0;
    for (std::size_t a = 1; a < s.nodes.material_mass.size(); ++a)
        if (s.nodes.material_mass[a][node] > s.nodes.material_mass[most][node])
            most = a;
    return s.eos[most].liquidus;
}

bool in_material(const Simulation& s, std::int64_t node) {
    return s.nodes.mass[node] > 0.0 && s.surface.phi[node] <= on_the_surface * s.grid.dx;
}

/// Central differences, one-sided where a neighbour has no temperature.
Vec3 gradient_at(const Simulation& s, const Field& temperature, const Index3& node) {
    const Grid& grid = s.grid;
    const std::int64_t at = grid.index(node[0], node[1], node[2]);
    const std::array<std::int64_t, 3> stride{1, grid.stride_y, grid.stride_z};
    Vec3 gradient = Vec3::Zero();
    for (int axis = 0; axis < 3; ++axis) {
        std::int64_t below = at, above = at;
        if (node[axis] > 0 && s.nodes.mass[at - stride[axis]] > 0.0)
            below = at - stride[axis];
        if (node[axis] < grid.cells[axis] && s.nodes.mass[at + stride[axis]] > 0.0)
            above = at + stride[axis];
        const std::int64_t cells = (above - below) / stride[axis];
        if (cells > 0)
            gradient[axis] = (temperature[above] - temperature[below]) / (double(cells) * grid.dx);
    }
    return gradient;
}

SolidifiedPoint solidified(const Simulation& s, const Solidification& record, const Index3& node,
                           double liquidus) {
    const std::int64_t at = s.grid.index(node[0], node[1], node[2]);
    const double before = record.previous[at], after = s.nodes.temperature[at];
    const double dt = s.time - record.previous_time;
    // What was molten by a change of the particles alone may have been below the liquidus already.
    const double share = before > liquidus ? (before - liquidus) / (before - after) : 0.0;
    SolidifiedPoint point;
    point.position = s.grid.position(node[0], node[1], node[2]);
    point.melted = record.melted_at[at];
    point.solidified = record.previous_time + share * dt;
    point.cooling_rate = (before - after) / dt;
    point.gradient = ((1.0 - share) * gradient_at(s, record.previous, node) +
                      share * gradient_at(s, s.nodes.temperature, node))
                         .norm();
    point.speed = point.cooling_rate / point.gradient;
    return point;
}

/// Looks at some nodes of a row; what solidified goes to `points`. Returns by how much more nodes are molten.
std::int64_t look_at_span(const Simulation& s, Solidification& record, const NodeSpan& span,
                          std::vector<SolidifiedPoint>& points) {
    const Grid& grid = s.grid;
    const std::int64_t j = span.begin % grid.stride_z / grid.stride_y - 1, k = span.begin / grid.stride_z - 1;
    if (j < 0 || j > grid.cells[1] || k < 0 || k > grid.cells[2])
        return 0; // ghosts
    const std::int64_t row = grid.index(0, j, k);
    const std::int64_t last = std::min(span.end - 1 - row, grid.cells[0]);
    const bool one_material = !s.nodes.several_materials();
    std::int64_t more = 0;
    for (std::int64_t i = std::max<std::int64_t>(span.begin - row, 0); i <= last; ++i) {
        const std::int64_t at = row + i;
        const double liquidus = one_material ? s.eos[0].liquidus : liquidus_at(s, at);
        const bool was_molten = record.melted_at[at] >= 0.0;
        const bool is_hot = s.nodes.temperature[at] >= liquidus;
        if (is_hot == was_molten)
            continue;
        if (was_molten) {
            points.push_back(solidified(s, record, {i, j, k}, liquidus));
            record.melted_at[at] = not_molten;
            --more;
        } else if (in_material(s, at)) {
            const double before = record.previous[at];
            const double share =
                before < liquidus ? (liquidus - before) / (s.nodes.temperature[at] - before) : 0.0;
            record.melted_at[at] = record.previous_time + share * (s.time - record.previous_time);
            ++more;
        }
    }
    return more;
}

} // namespace

Solidification begin_solidification(const Simulation& s) {
    Solidification record;
    record.melted_at.assign(s.grid.size, not_molten);
    record.previous = s.nodes.temperature;
    record.previous_time = s.time;
    std::vector<SolidifiedPoint> none;
    for (const NodeSpan& span : s.nodes.spans)
        record.molten += look_at_span(s, record, span, none);
    return record;
}

Solidification resume_solidification(const Simulation& s, Field melted_at,
                                     std::vector<SolidifiedPoint> points) {
    if (std::int64_t(melted_at.size()) != s.grid.size)
        throw std::invalid_argument("the saved times of melting do not fit the grid");
    Solidification record;
    record.points = std::move(points);
    record.melted_at = std::move(melted_at);
    record.molten = std::count_if(record.melted_at.begin(), record.melted_at.end(),
                                  [](double melted) { return melted >= 0.0; });
    record.previous = s.nodes.temperature;
    record.previous_time = s.time;
    return record;
}

void record_solidification(const Simulation& s, Solidification& record) {
    if (record.molten > 0 || s.peak_temperature >= lowest_liquidus(s.eos)) {
        // A list a span, then these in order: the same for any number of threads.
        std::vector<std::vector<SolidifiedPoint>> points(s.nodes.spans.size());
        std::int64_t more = 0;
#pragma omp parallel for schedule(static) reduction(+ : more)
        for (std::size_t n = 0; n < points.size(); ++n)
            more += look_at_span(s, record, s.nodes.spans[n], points[n]);
        record.molten += more;
        for (const auto& of_span : points)
            record.points.insert(record.points.end(), of_span.begin(), of_span.end());
    }
    // Elsewhere nothing has changed.
    for_each_node_lanes(s.nodes.spans,
                        [&](std::int64_t i) { store(load(&s.nodes.temperature[i]), &record.previous[i]); });
    record.previous_time = s.time;
}

} // namespace meltscope
