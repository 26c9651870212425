#include "viz/file_output.hpp"

#include "viz/pipeline.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <system_error>

#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkErrorCode.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkInformation.h>
#include <vtkInformationDoubleVectorKey.h>
#include <vtkInformationInformationVectorKey.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLImageDataWriter.h>
#include <vtkXMLPolyDataWriter.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <fmt/format.h>

namespace meltscope::viz {

namespace {

constexpr std::array<const char*, 4> kinds{"surface", "pool", "particles", "grid"};

vtkSmartPointer<vtkXMLWriter> make_writer(vtkDataSet* data) {
    if (vtkImageData::SafeDownCast(data) != nullptr) {
        return vtkSmartPointer<vtkXMLImageDataWriter>::New();
    }
    if (vtkUnstructuredGrid::SafeDownCast(data) != nullptr) {
        return vtkSmartPointer<vtkXMLUnstructuredGridWriter>::New();
    }
    return vtkSmartPointer<vtkXMLPolyDataWriter>::New();
}

template <class Wanted>
vtkSmartPointer<vtkDataArray> converted(vtkDataArray* array) {
    if (Wanted::SafeDownCast(array) != nullptr ||
        (vtkFloatArray::SafeDownCast(array) == nullptr && vtkDoubleArray::SafeDownCast(array) == nullptr)) {
        return array;
    }
    auto copy = vtkSmartPointer<Wanted>::New();
    copy->DeepCopy(array);
    copy->SetName(array->GetName());
    return copy;
}

/// Brings every floating-point array, and points, to one precision; arrays that have it are not copied.
template <class Wanted>
void convert(vtkDataSet* data) {
    vtkDataSetAttributes* attributes = data->GetPointData();
    const std::string scalars =
        attributes->GetScalars() != nullptr ? attributes->GetScalars()->GetName() : std::string();
    for (int i = 0; i < attributes->GetNumberOfArrays(); ++i) {
        vtkDataArray* array = attributes->GetArray(i);
        const bool is_normals = array == attributes->GetNormals();
        const auto result = converted<Wanted>(array);
        if (is_normals) {
            attributes->SetNormals(result);
        } else {
            attributes->AddArray(result); // in the place of the array of the same name
        }
    }
    if (!scalars.empty()) {
        attributes->SetActiveScalars(scalars.c_str());
    }
    if (auto* points = vtkPointSet::SafeDownCast(data); points != nullptr && points->GetPoints() != nullptr) {
        vtkNew<vtkPoints> result;
        result->SetData(converted<Wanted>(points->GetPoints()->GetData()));
        points->SetPoints(result);
    }
}

/// Takes off the arrays what VTK notes there when it first looks for their ranges: it would be written with
/// an array that lasts over several outputs, from the second on.
void forget_ranges(vtkDataSet* data) {
    const auto forget = [](vtkDataArray* array) {
        if (array != nullptr && array->HasInformation()) {
            array->GetInformation()->Remove(vtkDataArray::L2_NORM_RANGE());
            array->GetInformation()->Remove(vtkDataArray::COMPONENT_RANGE());
        }
    };
    for (int i = 0; i < data->GetPointData()->GetNumberOfArrays(); ++i) {
        forget(data->GetPointData()->GetArray(i));
    }
    if (auto* points = vtkPointSet::SafeDownCast(data); points != nullptr && points->GetPoints() != nullptr) {
        forget(points->GetPoints()->GetData());
    }
}

/// Cells with 32-bit numbers where those suffice: half the bytes.
void shrink_cells(vtkPolyData* data) {
    const auto shrunk = [](vtkCellArray* cells) {
        vtkNew<vtkCellArray> copy;
        // Deep: converting a shallow copy empties the cells it was made from (VTK 9.1).
        copy->DeepCopy(cells);
        copy->ConvertToSmallestStorage();
        return vtkSmartPointer<vtkCellArray>(copy);
    };
    if (data->GetNumberOfVerts() > 0) {
        data->SetVerts(shrunk(data->GetVerts()));
    }
    if (data->GetNumberOfPolys() > 0) {
        data->SetPolys(shrunk(data->GetPolys()));
    }
}

vtkSmartPointer<vtkUnstructuredGrid> as_unstructured(vtkPolyData* particles) {
    auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
    grid->SetPoints(particles->GetPoints());
    grid->SetCells(VTK_VERTEX, particles->GetVerts());
    grid->GetPointData()->ShallowCopy(particles->GetPointData());
    return grid;
}

} // namespace

void FileOutput::resume_at(double time) {
    next_index_ = 0;
    for (const char* kind : kinds) {
        const auto path = options_.run_dir / fmt::format("{}.pvd", kind);
        if (!std::filesystem::exists(path)) {
            continue;
        }
        PvdCollection collection(path);
        collection.load();
        collection.drop_from(time);
        for (const PvdCollection::Entry& entry : collection.entries()) {
            const std::string stem = std::filesystem::path(entry.file).stem().string();
            int index = 0;
            if (std::sscanf(stem.c_str() + std::min(stem.size(), std::strlen(kind) + 1), "%d", &index) == 1) {
                next_index_ = std::max(next_index_, index + 1);
            }
        }
        collections_.insert_or_assign(kind, std::move(collection));
    }
}

int FileOutput::write(const Instant& instant) {
    const Snapshot& snapshot = *instant.snapshot;
    int files = 0;
    if (options_.surface) {
        write_one("surface", "vtp", instant.free_surface, snapshot.time);
        ++files;
    }
    if (options_.pool) {
        write_one("pool", "vtp", join_pool(instant.pool), snapshot.time);
        ++files;
    }
    if (options_.particles && !snapshot.particles.id.empty()) {
        const auto particles = make_particles(snapshot.particles);
        if (options_.particles_as_vtu) {
            write_one("particles", "vtu", as_unstructured(particles), snapshot.time);
        } else {
            write_one("particles", "vtp", particles, snapshot.time);
        }
        ++files;
    }
    if (options_.grid) {
        write_one("grid", "vti", make_grid(snapshot), snapshot.time);
        ++files;
    }
    ++next_index_;
    return files;
}

void FileOutput::write_one(const std::string& kind, const char* extension, vtkDataSet* data, double time) {
    const std::filesystem::path folder = options_.run_dir / kind;
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) {
        throw VizError(fmt::format("cannot make the folder {}: {}", folder.string(), error.message()));
    }
    const auto output = vtkSmartPointer<vtkDataSet>::Take(data->NewInstance());
    output->ShallowCopy(data);
    if (options_.precision == Precision::float32) {
        convert<vtkFloatArray>(output);
    } else {
        convert<vtkDoubleArray>(output);
    }
    forget_ranges(output);
    if (auto* surface = vtkPolyData::SafeDownCast(output)) {
        shrink_cells(surface);
    }
    vtkNew<vtkDoubleArray> time_value;
    time_value->SetName("TimeValue");
    time_value->InsertNextValue(time);
    output->GetFieldData()->AddArray(time_value);

    const std::string name = fmt::format("{}_{:06}.{}", kind, next_index_, extension);
    const std::string temporary = (folder / (name + ".part")).string();
    const auto writer = make_writer(output);
    writer->SetFileName(temporary.c_str());
    writer->SetInputDataObject(output);
    writer->SetDataModeToAppended();
    writer->EncodeAppendedDataOff();
    switch (options_.compression) {
    case Compression::none:
        writer->SetCompressorTypeToNone();
        break;
    case Compression::lz4:
        writer->SetCompressorTypeToLZ4();
        break;
    case Compression::zlib:
        writer->SetCompressorTypeToZLib();
        break;
    }
    errno = 0;
    const bool good = writer->Write() == 1 && writer->GetErrorCode() == vtkErrorCode::NoError;
    int reason = errno;
    if (good && std::rename(temporary.c_str(), (folder / name).c_str()) == 0) {
        const auto path = options_.run_dir / (kind + ".pvd");
        PvdCollection& collection = collections_.try_emplace(kind, path).first->second;
        collection.forget_missing();
        collection.append(time, kind + "/" + name);
        return;
    }
    reason = good ? errno : reason;
    std::filesystem::remove(temporary, error);
    if (writer->GetErrorCode() == vtkErrorCode::OutOfDiskSpaceError) {
        reason = ENOSPC;
    }
    throw VizError(fmt::format("cannot write {}: {}", (folder / name).string(),
                               reason != 0 ? std::strerror(reason) : "VTK's writer failed"));
}

std::uint64_t estimate_file_bytes(const Snapshot& snapshot, const FileOptions& options) {
    require_complete(snapshot);
    const std::uint64_t number = options.precision == Precision::float32 ? 4 : 8;
    const auto nodes = static_cast<std::uint64_t>(node_count(snapshot.nodes));
    std::uint64_t bytes = 0;
    if (options.grid) {
        bytes += 4 * nodes * number;
    }
    if (options.particles) {
        const std::uint64_t cell = options.particles_as_vtu ? 17 : 8;
        bytes += snapshot.particles.id.size() * (7 * number + 8 + 4 + cell);
    }
    if (options.surface || options.pool) {
        // A point of the surface for each change of sign along an edge, and two triangles for each point.
        const std::vector<double>& phi = *snapshot.phi;
        const std::array<std::uint64_t, 3> stride{1, static_cast<std::uint64_t>(snapshot.nodes.count[0]),
                                                  static_cast<std::uint64_t>(snapshot.nodes.count[0]) *
                                                      static_cast<std::uint64_t>(snapshot.nodes.count[1])};
        std::uint64_t points = 0;
        for (const std::uint64_t step : stride) {
            for (std::uint64_t node = 0; node + step < nodes; ++node) {
                points += (phi[node] < 0.0) != (phi[node + step] < 0.0) ? 1 : 0;
            }
        }
        const std::uint64_t surface = points * (7 * number + 2 * 16);
        bytes += options.surface ? surface : 0;
        bytes += options.pool ? surface / 10 : 0;
    }
    return bytes;
}

} // namespace meltscope::viz
