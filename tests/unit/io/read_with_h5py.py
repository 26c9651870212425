"""Reads the example checkpoint of checkpoint_test.cpp with h5py, as a user's script would."""
import sys

import h5py
import numpy as np

with h5py.File(sys.argv[1], "r") as file:
    assert file.attrs["schema_version"] == 1
    assert file.attrs["time"] == 1.25e-3
    assert file.attrs["step"] == 123456789012
    assert file.attrs["dt"] == 0.1e-6

    particles = file["particles"]
    assert np.array_equal(particles["position"][:], np.arange(12.0).reshape(4, 3))
    assert np.array_equal(particles["specific_energy"][:], [1.0, 2.0, 3.0, 4.0])
    assert particles["id"].dtype == np.int64
    assert np.array_equal(particles["id"][:], 3000000000 * np.arange(4))
    assert particles["material"].dtype == np.int32
    assert particles["energy_gradient"].shape == (4, 3)
    assert particles["peak_temperature"].shape == (4,)
    assert file["grid/phi"].shape == (3, 4, 5)

    arrays = []
    file.visititems(lambda name, item: arrays.append(item) if isinstance(item, h5py.Dataset) else None)
    assert len(arrays) == 13, [item.name for item in arrays]
    assert all(item.fletcher32 for item in arrays), [item.name for item in arrays]

    assert file["scenario"].asstr()[0] == 'title = "Schweißbad"\n'
    assert file["steering/parameters"].asstr()[0] == '{"laser.power": 195}'
    assert file["steering/journal"].asstr()[0] == ""
    assert dict(file["ledger"].attrs) == {"absorbed": 1.0 / 3.0, "residual": -1e-17}
