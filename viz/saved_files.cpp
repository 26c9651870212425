#include "viz/saved_files.hpp"

#include "viz/lattice.hpp"
#include "viz/pvd.hpp"
#include "viz/saved_instant.hpp"
#include "viz/vtk_errors.hpp"

#include <algorithm>
#include <map>

#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkXMLImageDataReader.h>
#include <vtkXMLPolyDataReader.h>

#include <fmt/format.h>

namespace meltscope::viz {

namespace {

template <class Reader>
auto read(const std::filesystem::path& path) {
    capture_vtk_errors();
    take_vtk_error();
    vtkNew<Reader> reader;
    reader->SetFileName(path.c_str());
    reader->Update();
    if (const std::string error = take_vtk_error(); !error.empty()) {
        throw VizError(fmt::format("cannot read {}: {}", path.string(), error));
    }
    return vtkSmartPointer(reader->GetOutput());
}

vtkDataArray* array_of(vtkDataSet* data, const char* name, const std::filesystem::path& path) {
    vtkDataArray* array = data->GetPointData()->GetArray(name);
    if (array == nullptr || data->GetNumberOfPoints() == 0) {
        throw VizError(fmt::format("{} has no points with the array {}", path.string(), name));
    }
    return array;
}

} // namespace

std::vector<SavedOutput> list_saved_outputs(const std::filesystem::path& run_dir) {
    std::map<double, SavedOutput> outputs;
    for (const auto& [kind, member] :
         {std::pair{"surface", &SavedOutput::surface}, std::pair{"grid", &SavedOutput::grid}}) {
        PvdCollection collection(run_dir / fmt::format("{}.pvd", kind));
        collection.load();
        for (const PvdCollection::Entry& entry : collection.entries()) {
            const auto path = run_dir / entry.file;
            if (std::filesystem::exists(path)) {
                outputs[entry.time].time = entry.time;
                outputs[entry.time].*member = path;
            }
        }
    }
    std::vector<SavedOutput> list;
    for (const auto& [time, output] : outputs) {
        list.push_back(output);
    }
    return list;
}

const std::vector<std::string>& views_of_surfaces() {
    static const std::vector<std::string> names{"overview", "top"};
    return names;
}

void read_grid_file(const std::filesystem::path& vti, Snapshot& snapshot) {
    const auto image = read<vtkXMLImageDataReader>(vti);
    const int* dimensions = image->GetDimensions();
    const double* origin = image->GetOrigin();
    snapshot.nodes.origin = {origin[0], origin[1], origin[2]};
    snapshot.nodes.spacing = image->GetSpacing()[0];
    snapshot.nodes.count = {dimensions[0], dimensions[1], dimensions[2]};
    const auto field = [&](const char* name) {
        vtkDataArray* array = array_of(image, name, vti);
        std::vector<double> values(static_cast<std::size_t>(array->GetNumberOfTuples()));
        for (std::size_t i = 0; i < values.size(); ++i) {
            values[i] = array->GetComponent(static_cast<vtkIdType>(i), 0);
        }
        return std::make_shared<const std::vector<double>>(std::move(values));
    };
    snapshot.phi = field("phi");
    snapshot.phi_hat = field("phi_hat");
    snapshot.mass = field("mass");
    snapshot.temperature = field("temperature");
    require_complete(snapshot);
}

Instant read_surface_file(const std::filesystem::path& vtp, const Snapshot& head) {
    const auto surface = read<vtkXMLPolyDataReader>(vtp);
    vtkDataArray* temperature = array_of(surface, "temperature", vtp);
    surface->GetPointData()->SetActiveScalars("temperature");
    if (vtkDataArray* normals = surface->GetPointData()->GetArray("normals")) {
        surface->GetPointData()->SetNormals(normals);
    }
    auto snapshot = std::make_shared<Snapshot>(head);
    // What is known of the inside is nothing; the range of colours begins at the coldest of the surface.
    snapshot->temperature = std::make_shared<const std::vector<double>>(1, temperature->GetRange(0)[0]);

    auto geometry = std::make_shared<Geometry>();
    geometry->nodes = head.nodes;
    geometry->free_surface = surface;
    geometry->walls = vtkSmartPointer<vtkPolyData>::New();
    geometry->walls->SetPoints(vtkNew<vtkPoints>());
    geometry->heights = HeightMap(head.nodes, surface);
    geometry->lower = head.nodes.origin;
    geometry->upper = upper_corner(head.nodes);
    geometry->upper.z() = surface->GetBounds()[5];

    Instant instant;
    instant.free_surface = surface;
    instant.pool.line = line_at(surface, head.liquidus);
    instant.geometry = std::move(geometry);
    instant.snapshot = std::move(snapshot);
    return instant;
}

} // namespace meltscope::viz
