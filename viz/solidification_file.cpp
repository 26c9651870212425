#include "viz/solidification_file.hpp"

#include "viz/options.hpp"

#include <array>
#include <utility>

#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataWriter.h>

#include <fmt/format.h>

namespace meltscope::viz {

void write_solidification_points(const std::filesystem::path& path, std::span<const SolidifiedPoint> points) {
    const auto count = static_cast<vtkIdType>(points.size());
    vtkNew<vtkPoints> places;
    places->SetDataTypeToDouble();
    places->SetNumberOfPoints(count);
    vtkNew<vtkCellArray> vertices;
    for (vtkIdType i = 0; i < count; ++i) {
        places->SetPoint(i, points[i].position.data());
        vertices->InsertNextCell(1, &i);
    }
    vtkNew<vtkPolyData> data;
    data->SetPoints(places);
    data->SetVerts(vertices);
    constexpr std::array<std::pair<const char*, double SolidifiedPoint::*>, 5> columns{
        {{"G", &SolidifiedPoint::gradient},
         {"R", &SolidifiedPoint::speed},
         {"cr", &SolidifiedPoint::cooling_rate},
         {"tm", &SolidifiedPoint::melted},
         {"tl", &SolidifiedPoint::solidified}}};
    for (const auto& [name, member] : columns) {
        vtkNew<vtkDoubleArray> array;
        array->SetName(name);
        array->SetNumberOfValues(count);
        for (vtkIdType i = 0; i < count; ++i) {
            array->SetValue(i, points[i].*member);
        }
        data->GetPointData()->AddArray(array);
    }
    vtkNew<vtkXMLPolyDataWriter> writer;
    writer->SetFileName(path.c_str());
    writer->SetInputData(data);
    writer->SetDataModeToAppended();
    writer->EncodeAppendedDataOff();
    if (writer->Write() != 1) {
        throw VizError(fmt::format("{} cannot be written", path.string()));
    }
}

} // namespace meltscope::viz
