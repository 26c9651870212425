"""Reads a run's data files with VTK's own Python readers and meshio, and checks arrays, times and values."""

import os
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree

try:
    import numpy as np
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLImageDataReader, vtkXMLPolyDataReader
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

TIMES = [0.0, 250e-6, 1.0 / 3.0 * 1e-3]
LIQUIDUS = 1623.0


def read(path):
    reader = vtkXMLImageDataReader() if path.endswith(".vti") else vtkXMLPolyDataReader()
    reader.SetFileName(path)
    reader.Update()
    data = reader.GetOutput()
    arrays = {}
    for i in range(data.GetPointData().GetNumberOfArrays()):
        array = data.GetPointData().GetArray(i)
        arrays[array.GetName()] = vtk_to_numpy(array)
    time = data.GetFieldData().GetArray("TimeValue")
    assert time is not None, f"{path} has no TimeValue"
    points = None if path.endswith(".vti") else vtk_to_numpy(data.GetPoints().GetData())
    return data, points, arrays, time.GetValue(0)


def collection(run, kind):
    root = ElementTree.parse(os.path.join(run, kind + ".pvd")).getroot()
    assert root.tag == "VTKFile" and root.attrib["type"] == "Collection"
    return [(float(entry.attrib["timestep"]), entry.attrib["file"]) for entry in root.iter("DataSet")]


def check_floats(arrays, dtype):
    for name, values in arrays.items():
        if name not in ("id", "material"):
            assert values.dtype == dtype, f"{name} is {values.dtype}, not {dtype}"
        assert np.isfinite(values).all(), f"{name} has values that are no numbers"


def check_run(run, dtype):
    for kind in ("surface", "pool", "particles", "grid"):
        entries = collection(run, kind)
        assert [time for time, _ in entries] == TIMES, (kind, entries)
        for index, (time, file) in enumerate(entries):
            assert not os.path.isabs(file) and file.startswith(f"{kind}/{kind}_{index:06d}."), file
            data, points, arrays, value = read(os.path.join(run, file))
            assert value == time, (file, value, time)
            check_floats(arrays, dtype)
            temperature = arrays["temperature"]
            if kind == "surface":
                assert set(arrays) == {"temperature", "normals"}, set(arrays)
                assert points.dtype == dtype
                assert data.GetNumberOfPolys() == 2 * 100 * 30, "two triangles for each square of the plate"
                assert np.abs(points[:, 2]).max() < 1e-9, "the plate's surface lies at z = 0"
                assert np.allclose(arrays["normals"], [0, 0, 1], atol=1e-5)
                assert 299.0 < temperature.min() and LIQUIDUS < temperature.max() < 4000.0
                laser_x = 0.3e-3 + 0.8 * time
                assert abs(points[temperature.argmax(), 0] - laser_x) < 150e-6, "hottest near the laser"
            elif kind == "pool":
                marks = vtk_to_numpy(data.GetCellData().GetArray("free_surface"))
                assert set(marks) == {0, 1} and len(marks) == data.GetNumberOfPolys()
                assert temperature.min() > LIQUIDUS - 1.0
                depth = -points[:, 2].min()
                assert 20e-6 < depth < 120e-6, depth
                assert points[:, 2].max() < 1e-9, "the pool ends at the free surface"
            elif kind == "particles":
                assert set(arrays) == {"temperature", "specific_energy", "liquid_fraction", "phi_hat", "id", "material"}
                assert (arrays["id"] == np.arange(len(points))).all() and arrays["id"].dtype == np.int64
                assert arrays["material"].dtype == np.int32
                assert data.GetNumberOfVerts() == len(points) > 0
                assert np.allclose(arrays["specific_energy"], 600.0 * temperature, rtol=1e-6)
                assert arrays["liquid_fraction"].min() == 0.0 and arrays["liquid_fraction"].max() == 1.0
            else:
                assert set(arrays) == {"phi", "phi_hat", "temperature", "mass"}
                assert data.GetDimensions() == (101, 31, 19)
                assert np.allclose(data.GetSpacing(), 15e-6)
                z = data.GetOrigin()[2] + 15e-6 * (np.arange(101 * 31 * 19) // (101 * 31))
                assert np.allclose(arrays["phi"], z, atol=1e-10)
        assert not [name for name in os.listdir(os.path.join(run, kind)) if name.endswith(".part")]


def check_with_meshio(run):
    try:
        import meshio
    except ImportError:
        return
    for time, file in collection(run, "particles"):
        mesh = meshio.read(os.path.join(run, file))
        assert len(mesh.points) == len(mesh.point_data["temperature"]) > 0
        assert (mesh.point_data["id"].ravel() == np.arange(len(mesh.points))).all()


def main():
    sample, compression, precision = sys.argv[1:]
    with tempfile.TemporaryDirectory() as run:
        subprocess.run([sample, run, compression, precision], check=True)
        check_run(run, np.dtype(precision))
    if compression != "lz4":  # meshio knows zlib and raw
        with tempfile.TemporaryDirectory() as run:
            subprocess.run([sample, run, compression, precision, "vtu"], check=True)
            check_with_meshio(run)


if __name__ == "__main__":
    main()
