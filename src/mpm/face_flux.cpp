#include "meltscope/mpm/face_flux.hpp"

namespace meltscope {
namespace {

constexpr double weight_of_face = 0.75, weight_of_mirror = 0.25;

/// Convection sees a node this many steps ahead. One is Euler's implicit step; but step 6 may double an
/// increment.
constexpr double look_ahead = 2.0;

/// What the materials at a node take up together.
struct NodeMatter {
    double volume = 0.0;   ///< m^3
    double capacity = 0.0; ///< J/K
};

NodeMatter matter(const std::vector<EquationOfState>& materials, const Nodes& nodes, std::int64_t node) {
    const double t = nodes.temperature[node];
    NodeMatter sum;
    for (std::size_t a = 0; a < materials.size(); ++a) {
        const double mass = nodes.several_materials() ? nodes.material_mass[a][node] : nodes.mass[node];
        if (mass > 0.0) {
            sum.volume += mass / materials[a].density;
            sum.capacity += mass * materials[a].heat_capacity(t);
        }
    }
    if (!nodes.inertia.empty() &&
        nodes.mass[node] > 0.0) { // mirror images beyond faces of fixed temperature count
        sum.volume *= nodes.inertia[node] / nodes.mass[node];
        sum.capacity *= nodes.inertia[node] / nodes.mass[node];
    }
    return sum;
}

/// A node of the face and the one inside that takes the rest of its heat.
struct FaceColumn {
    std::int64_t face, mirror;
    double area; ///< m^2, of the face as far as it belongs to the box
};

/// J that a node takes in through its share of the face (area x time in m^2 s).
double joule_into(const FaceCondition& condition, double share, const NodeMatter& at_node, double temperature,
                  double increment) {
    if (condition.kind == FaceCondition::Kind::fixed_flux)
        return condition.flux * share;
    const double conductance = condition.coefficient * share; // J/K
    const double ahead = look_ahead / at_node.capacity;       // K/J
    return conductance * (condition.temperature - temperature - ahead * increment) /
           (1.0 + ahead * conductance);
}

/// J into the material through a column, and where it goes.
double deposit_in_column(const Grid& grid, const FaceCondition& condition,
                         const std::vector<EquationOfState>& materials, double dt, const FaceColumn& column,
                         Nodes& nodes) {
    const NodeMatter at_face = matter(materials, nodes, column.face);
    if (at_face.volume <= 0.0)
        return 0.0;
    const double full = column.area * 0.5 * grid.dx;
    const double area_dt = column.area * (at_face.volume / full) * dt;
    const auto deposit = [&](std::int64_t node, double weight, const NodeMatter& at_node) {
        const double joule =
            joule_into(condition, weight * area_dt, at_node, nodes.temperature[node], nodes.increment[node]);
        nodes.increment[node] += joule;
        return joule;
    };
    // What is at the face reaches the mirror node too, so that has mass.
    return deposit(column.face, weight_of_face, at_face) +
           deposit(column.mirror, weight_of_mirror, matter(materials, nodes, column.mirror));
}

double deposit_at_face(const Grid& grid, int f, const FaceCondition& condition,
                       const std::vector<EquationOfState>& materials, double dt, Nodes& nodes) {
    const FacePlanes planes = face_planes(grid, f);
    const std::array<std::int64_t, 3> stride{1, grid.stride_y, grid.stride_z};
    const int u = planes.axis == 0 ? 1 : 0, v = planes.axis == 2 ? 1 : 2;
    const auto share = [&](std::int64_t n, int axis) { return n == 0 || n == grid.cells[axis] ? 0.5 : 1.0; };
    std::vector<double> of_row(grid.cells[v] + 1, 0.0);
#pragma omp parallel for schedule(static)
    for (std::int64_t q = 0; q <= grid.cells[v]; ++q)
        for (std::int64_t p = 0; p <= grid.cells[u]; ++p) {
            const std::int64_t base =
                (p + 1) * stride[u] + (q + 1) * stride[v]; // storage starts at the ghosts
            const FaceColumn column{base + planes.face * stride[planes.axis],
                                    base + planes.mirror * stride[planes.axis],
                                    grid.dx * grid.dx * share(p, u) * share(q, v)};
            of_row[q] += deposit_in_column(grid, condition, materials, dt, column, nodes);
        }
    double sum = 0.0;
    for (const double joule : of_row)
        sum += joule;
    return sum;
}

} // namespace

std::array<double, 6> deposit_face_fluxes(const Grid& grid, const Boundary& boundary,
                                          const std::vector<EquationOfState>& materials, double dt,
                                          Nodes& nodes) {
    std::array<double, 6> joule{};
    bool folded = false;
    for (int f = 0; f < 6; ++f) {
        const FaceCondition& condition = boundary[f];
        if (condition.kind != FaceCondition::Kind::convection &&
            condition.kind != FaceCondition::Kind::fixed_flux)
            continue;
        if (!folded)
            fold_ghosts(grid, boundary, AtFixedFaces::leave, nodes.increment);
        folded = true;
        joule[f] = deposit_at_face(grid, f, condition, materials, dt, nodes);
    }
    return joule;
}

} // namespace meltscope
