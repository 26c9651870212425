#include "viz/lattice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace meltscope::viz {

std::int64_t node_count(const NodeLattice& lattice) {
    return lattice.count[0] * lattice.count[1] * lattice.count[2];
}

Vec3 upper_corner(const NodeLattice& lattice) {
    return lattice.origin + lattice.spacing * Vec3(static_cast<double>(lattice.count[0] - 1),
                                                   static_cast<double>(lattice.count[1] - 1),
                                                   static_cast<double>(lattice.count[2] - 1));
}

vtkSmartPointer<vtkDoubleArray> wrap(const std::vector<double>& field, const char* name) {
    auto array = vtkSmartPointer<vtkDoubleArray>::New();
    array->SetName(name);
    // VTK's interface is not const-correct; readers are all that ever see the array.
    array->SetArray(const_cast<double*>(field.data()), static_cast<vtkIdType>(field.size()), 1);
    return array;
}

vtkSmartPointer<vtkImageData> make_image(const NodeLattice& lattice) {
    auto image = vtkSmartPointer<vtkImageData>::New();
    image->SetOrigin(lattice.origin.x(), lattice.origin.y(), lattice.origin.z());
    image->SetSpacing(lattice.spacing, lattice.spacing, lattice.spacing);
    image->SetDimensions(static_cast<int>(lattice.count[0]), static_cast<int>(lattice.count[1]),
                         static_cast<int>(lattice.count[2]));
    return image;
}

FieldSampler::FieldSampler(const NodeLattice& lattice, const std::vector<double>& field)
    : lattice_(lattice), field_(field), inverse_spacing_(1.0 / lattice.spacing) {}

double FieldSampler::operator()(const Vec3& point) const {
    std::array<std::int64_t, 3> low{};
    std::array<double, 3> weight{};
    for (int a = 0; a < 3; ++a) {
        const std::size_t axis = static_cast<std::size_t>(a);
        const double last = static_cast<double>(lattice_.count[axis] - 1);
        const double position = std::clamp((point[a] - lattice_.origin[a]) * inverse_spacing_, 0.0, last);
        low[axis] = std::min(static_cast<std::int64_t>(position),
                             std::max<std::int64_t>(lattice_.count[axis] - 2, 0));
        weight[axis] = position - static_cast<double>(low[axis]);
    }
    const std::int64_t row = lattice_.count[0];
    const std::int64_t plane = row * lattice_.count[1];
    const double* corner = field_.data() + low[0] + row * low[1] + plane * low[2];
    const std::int64_t dx = lattice_.count[0] > 1 ? 1 : 0;
    const std::int64_t dy = lattice_.count[1] > 1 ? row : 0;
    const std::int64_t dz = lattice_.count[2] > 1 ? plane : 0;
    const auto along_x = [&](const double* node) { return node[0] + weight[0] * (node[dx] - node[0]); };
    const auto along_y = [&](const double* node) {
        const double near = along_x(node);
        return near + weight[1] * (along_x(node + dy) - near);
    };
    const double bottom = along_y(corner);
    return bottom + weight[2] * (along_y(corner + dz) - bottom);
}

std::optional<NodeBox> box_above(const NodeLattice& lattice, const std::vector<double>& field,
                                 double threshold, std::int64_t margin) {
    const auto [nx, ny, nz] = lattice.count;
    NodeBox box{{nx, ny, nz}, {-1, -1, -1}};
    const double* row = field.data();
    for (std::int64_t k = 0; k < nz; ++k) {
        for (std::int64_t j = 0; j < ny; ++j, row += nx) {
            const auto hot = [threshold](double value) { return value >= threshold; };
            const double* first = std::find_if(row, row + nx, hot);
            if (first == row + nx) {
                continue;
            }
            const double* last = row + nx - 1;
            while (!hot(*last)) {
                --last;
            }
            box.first = {std::min(box.first[0], first - row), std::min(box.first[1], j),
                         std::min(box.first[2], k)};
            box.last = {std::max(box.last[0], last - row), std::max(box.last[1], j),
                        std::max(box.last[2], k)};
        }
    }
    if (box.last[0] < 0) {
        return std::nullopt;
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
        box.first[axis] = std::max<std::int64_t>(box.first[axis] - margin, 0);
        box.last[axis] = std::min(box.last[axis] + margin, lattice.count[axis] - 1);
    }
    return box;
}

NodeLattice sub_lattice(const NodeLattice& lattice, const NodeBox& box) {
    NodeLattice part;
    part.spacing = lattice.spacing;
    for (int a = 0; a < 3; ++a) {
        const std::size_t axis = static_cast<std::size_t>(a);
        part.origin[a] = lattice.origin[a] + lattice.spacing * static_cast<double>(box.first[axis]);
        part.count[axis] = box.last[axis] - box.first[axis] + 1;
    }
    return part;
}

std::vector<double> sub_field(const NodeLattice& lattice, const std::vector<double>& field,
                              const NodeBox& box) {
    std::vector<double> part;
    part.reserve(static_cast<std::size_t>(node_count(sub_lattice(lattice, box))));
    for (std::int64_t k = box.first[2]; k <= box.last[2]; ++k) {
        for (std::int64_t j = box.first[1]; j <= box.last[1]; ++j) {
            const auto row = field.begin() + (k * lattice.count[1] + j) * lattice.count[0];
            part.insert(part.end(), row + box.first[0], row + box.last[0] + 1);
        }
    }
    return part;
}

HeightMap::HeightMap(const NodeLattice& lattice, const std::vector<double>& phi)
    : lattice_(lattice), height_(static_cast<std::size_t>(lattice.count[0] * lattice.count[1]),
                                 std::numeric_limits<double>::quiet_NaN()) {
    const std::size_t plane = height_.size();
    const std::int64_t top = lattice.count[2] - 1;
    for (std::int64_t k = top; k >= 0; --k) {
        const double* here = phi.data() + static_cast<std::size_t>(k) * plane;
        const double z = lattice.origin.z() + lattice.spacing * static_cast<double>(k);
        for (std::size_t column = 0; column < plane; ++column) {
            if (!std::isnan(height_[column]) || here[column] > 0.0) {
                continue;
            }
            const double above = k < top ? here[column + plane] : 0.0;
            const double fraction = above > here[column] ? here[column] / (here[column] - above) : 0.0;
            height_[column] = z + lattice.spacing * fraction;
        }
    }
}

HeightMap::HeightMap(const NodeLattice& lattice, vtkPolyData* surface)
    : lattice_(lattice), height_(static_cast<std::size_t>(lattice.count[0] * lattice.count[1]),
                                 std::numeric_limits<double>::quiet_NaN()) {
    constexpr double near = 1e-3; // of a cell: files may be of single precision
    for (vtkIdType n = 0; n < surface->GetNumberOfPoints(); ++n) {
        const double* point = surface->GetPoint(n);
        const double i = (point[0] - lattice.origin.x()) / lattice.spacing;
        const double j = (point[1] - lattice.origin.y()) / lattice.spacing;
        const auto column = static_cast<std::int64_t>(std::lround(i));
        const auto row = static_cast<std::int64_t>(std::lround(j));
        if (std::abs(i - std::round(i)) > near || std::abs(j - std::round(j)) > near || column < 0 ||
            column >= lattice.count[0] || row < 0 || row >= lattice.count[1]) {
            continue;
        }
        double& height = height_[static_cast<std::size_t>(row * lattice.count[0] + column)];
        height = std::isnan(height) ? point[2] : std::max(height, point[2]);
    }
}

std::optional<double> HeightMap::at(double x, double y) const {
    if (height_.empty()) {
        return std::nullopt;
    }
    const double last_x = static_cast<double>(lattice_.count[0] - 1);
    const double last_y = static_cast<double>(lattice_.count[1] - 1);
    const double i = std::clamp((x - lattice_.origin.x()) / lattice_.spacing, 0.0, last_x);
    const double j = std::clamp((y - lattice_.origin.y()) / lattice_.spacing, 0.0, last_y);
    double sum = 0.0;
    double weights = 0.0;
    for (const double column : {std::floor(i), std::floor(i) + 1.0}) {
        for (const double row : {std::floor(j), std::floor(j) + 1.0}) {
            if (column > last_x || row > last_y) {
                continue;
            }
            const double height = height_[static_cast<std::size_t>(
                static_cast<std::int64_t>(row) * lattice_.count[0] + static_cast<std::int64_t>(column))];
            const double weight = (1.0 - std::abs(i - column)) * (1.0 - std::abs(j - row));
            if (!std::isnan(height) && weight > 0.0) {
                sum += weight * height;
                weights += weight;
            }
        }
    }
    if (weights == 0.0) {
        return std::nullopt;
    }
    return sum / weights;
}

} // namespace meltscope::viz
