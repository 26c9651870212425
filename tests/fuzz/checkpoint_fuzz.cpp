// Checkpoints. First byte 0: the rest is the file. Otherwise: a good checkpoint is changed as the bytes say,
// well sealed, and taken up by a run.
#include "bytes.hpp"
#include "fuzz.hpp"
#include "small_run.hpp"

#include "checkpoint_seal.hpp"

#include <hdf5.h>

#include <array>
#include <cmath>
#include <limits>

using namespace meltscope;
namespace fs = std::filesystem;

namespace {

constexpr std::array<const char*, 22> names{"/particles/position",
                                            "/particles/mass",
                                            "/particles/volume",
                                            "/particles/specific_energy",
                                            "/particles/id",
                                            "/particles/material",
                                            "/particles/powder",
                                            "/grid/mass_energy",
                                            "/grid/melted_at",
                                            "/grid/solidified",
                                            "/grid/layers_laid",
                                            "/scenario",
                                            "/steering/parameters",
                                            "/steering/journal",
                                            "/ledger",
                                            "/particles",
                                            "/grid",
                                            "/steering",
                                            "/particles/extra",
                                            "/grid/extra",
                                            "/grid/awake",
                                            "/grid/least_temperature"};
constexpr std::array<const char*, 6> attributes{"schema_version", "time", "step", "dt", "absorbed", "extra"};

double awkward(fuzz::Bytes& bytes) {
    constexpr double inf = std::numeric_limits<double>::infinity();
    constexpr std::array<double, 12> values{
        0.0,    -0.0, 1.0,   -1.0, std::numeric_limits<double>::quiet_NaN(), inf, -inf, 1e308,
        1e-308, 1e19, -1e-5, 5e-5};
    const std::uint8_t which = bytes.byte();
    return which < values.size() ? values[which] : bytes.number<double>();
}

hsize_t awkward_size(fuzz::Bytes& bytes) {
    const std::uint8_t which = bytes.byte();
    return which < 200 ? which : which < 240 ? hsize_t(1) << (which - 200) : bytes.number<std::uint32_t>();
}

hid_t some_type(fuzz::Bytes& bytes) {
    const std::array<hid_t, 10> types{H5T_IEEE_F64LE, H5T_IEEE_F64LE, H5T_STD_I64LE, H5T_STD_I32LE,
                                      H5T_IEEE_F32LE, H5T_IEEE_F64BE, H5T_STD_U64LE, H5T_STD_I8LE,
                                      H5T_C_S1,       H5T_STD_REF_OBJ};
    return types[bytes.byte() % types.size()];
}

hid_t some_space(fuzz::Bytes& bytes, hsize_t& count) {
    const int rank = bytes.byte() % 5;
    count = 1;
    if (rank == 0)
        return bytes.byte() % 2 == 0 ? H5Screate(H5S_NULL) : H5Screate(H5S_SCALAR);
    std::array<hsize_t, 4> dims{};
    for (int n = 0; n < rank; ++n) {
        dims[n] = awkward_size(bytes);
        count = dims[n] != 0 && count > (hsize_t(1) << 40) / dims[n] ? hsize_t(1) << 40 : count * dims[n];
    }
    return H5Screate_simple(rank, dims.data(), nullptr);
}

/// Another array under the name: any type, any shape, well stored or not, filled if it is small.
void replace(hid_t file, const char* name, fuzz::Bytes& bytes) {
    H5Ldelete(file, name, H5P_DEFAULT);
    hsize_t count = 0;
    const hid_t type = some_type(bytes);
    const hid_t space = some_space(bytes, count);
    const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
    const std::uint8_t how = bytes.byte();
    const int rank = H5Sget_simple_extent_ndims(space);
    if (how % 8 != 0 && rank > 0) {
        std::array<hsize_t, 4> chunk{1, 1, 1, 1};
        chunk[rank - 1] = 64;
        H5Pset_chunk(properties, rank, chunk.data());
        if (how % 8 != 1)
            H5Pset_fletcher32(properties);
        if (how % 8 == 2)
            H5Pset_deflate(properties, 6);
    }
    const hid_t set = H5Dcreate2(file, name, type, space, H5P_DEFAULT, properties, H5P_DEFAULT);
    if (set >= 0 && count <= 4096 && how < 240) {
        std::vector<double> values(8 * count + 8, 0.0);
        for (hsize_t n = 0; n < std::min<hsize_t>(count, 8); ++n)
            values[n] = awkward(bytes);
        H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    }
    H5Dclose(set);
    H5Pclose(properties);
    H5Sclose(space);
}

/// A few values of an array changed, its form kept.
void alter(hid_t file, const char* name, fuzz::Bytes& bytes) {
    const hid_t set = H5Dopen2(file, name, H5P_DEFAULT);
    if (set < 0)
        return;
    const hid_t space = H5Dget_space(set);
    const hssize_t count = H5Sget_simple_extent_npoints(space);
    const hid_t type = H5Dget_type(set);
    if (count > 0 && count <= 100000 && H5Tget_class(type) != H5T_STRING && H5Tget_size(type) <= 8) {
        std::vector<double> values(static_cast<std::size_t>(count) + 1);
        H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
        const std::size_t changes = 1 + bytes.byte() % 4;
        for (std::size_t n = 0; n < changes; ++n) {
            const std::size_t place = bytes.number<std::uint16_t>() % static_cast<std::size_t>(count);
            values[place] = awkward(bytes);
        }
        H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    }
    H5Tclose(type);
    H5Sclose(space);
    H5Dclose(set);
}

/// A text put in the place of another, or changed within.
void rewrite(hid_t file, const char* name, fuzz::Bytes& bytes) {
    std::string text;
    if (const hid_t old = H5Dopen2(file, name, H5P_DEFAULT); old >= 0) {
        const hid_t type = H5Dget_type(old), space = H5Dget_space(old);
        const bool one = H5Sget_simple_extent_npoints(space) == 1; // not so after replace()
        if (one && H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0) {
            text.resize(H5Tget_size(type));
            H5Dread(old, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data());
            text.resize(std::min(text.size(), text.find('\0')));
        }
        H5Sclose(space);
        H5Tclose(type);
        H5Dclose(old);
    }
    const std::size_t at = text.empty() ? 0 : bytes.number<std::uint16_t>() % text.size();
    const std::size_t drop = bytes.byte();
    text.replace(at, std::min(drop, text.size() - at), bytes.text());
    H5Ldelete(file, name, H5P_DEFAULT);
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, text.size() + 1);
    const hsize_t one = 1;
    const hid_t space = H5Screate_simple(1, &one, nullptr);
    const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_chunk(properties, 1, &one);
    H5Pset_fletcher32(properties);
    const hid_t set = H5Dcreate2(file, name, type, space, H5P_DEFAULT, properties, H5P_DEFAULT);
    H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.c_str());
    H5Dclose(set);
    H5Pclose(properties);
    H5Sclose(space);
    H5Tclose(type);
}

void put_attribute(hid_t file, fuzz::Bytes& bytes) {
    const char* owner = bytes.byte() % 2 == 0 ? "/" : "/ledger";
    const char* name = attributes[bytes.byte() % attributes.size()];
    const hid_t object = H5Oopen(file, owner, H5P_DEFAULT);
    if (object < 0)
        return;
    H5Adelete(object, name);
    const std::uint8_t how = bytes.byte();
    if (how % 8 != 0) {
        const bool whole = how % 8 >= 6;
        const hid_t type = how % 8 == 1 ? some_type(bytes) : whole ? H5T_STD_I64LE : H5T_IEEE_F64LE;
        hsize_t count = 1;
        const hid_t space = how % 8 == 2 ? some_space(bytes, count) : H5Screate(H5S_SCALAR);
        const hid_t attribute =
            count <= 1000 ? H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT) : hid_t(-1);
        if (attribute >= 0) {
            std::vector<double> values(1024, awkward(bytes));
            if (whole) {
                const auto value = bytes.number<std::int64_t>();
                std::memcpy(values.data(), &value, sizeof value);
            }
            H5Awrite(attribute, type, values.data());
            H5Aclose(attribute);
        }
        H5Sclose(space);
    }
    H5Oclose(object);
}

void link(hid_t file, const char* name, fuzz::Bytes& bytes) {
    H5Ldelete(file, name, H5P_DEFAULT);
    const char* target = names[bytes.byte() % names.size()];
    switch (bytes.byte() % 4) {
    case 0:
        H5Lcreate_soft(target, file, name, H5P_DEFAULT, H5P_DEFAULT);
        break;
    case 1:
        H5Lcreate_external("other.h5", target, file, name, H5P_DEFAULT, H5P_DEFAULT);
        break;
    case 2:
        H5Lcreate_hard(file, target, file, name, H5P_DEFAULT, H5P_DEFAULT);
        break;
    default:
        H5Gclose(H5Gcreate2(file, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    }
}

void change(const fs::path& path, fuzz::Bytes& bytes) {
    const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    fuzz::require(file >= 0, "the good checkpoint cannot be opened");
    for (int round = 0; round < 6 && !bytes.empty(); ++round) {
        const std::uint8_t what = bytes.byte() % 16;
        const char* name = names[bytes.byte() % names.size()];
        if (what < 1)
            H5Ldelete(file, name, H5P_DEFAULT);
        else if (what < 4)
            replace(file, name, bytes);
        else if (what < 9)
            alter(file, name, bytes);
        else if (what < 12)
            rewrite(file, names[11 + bytes.byte() % 3], bytes);
        else if (what < 15)
            put_attribute(file, bytes);
        else
            link(file, name, bytes);
    }
    H5Fclose(file);
}

/// As a restart does.
void take_up(const CheckpointData& data, ConsoleState& console) {
    static const Scenario small = fuzz::read_small();
    const Scenario scenario =
        data.scenario == console.host.scenario ? small : read_scenario_text(data.scenario);
    const Estimate need = estimate(scenario);
    if (need.nodes > 50'000 || need.particles_at_most > 50'000)
        return;
    RunParameters parameters = run_parameters(scenario);
    Run run;
    apply_steering(read_steering(data.steering), parameters, run.schedule);
    run.simulation =
        simulation_from(data, std::move(parameters), scenario_grid(scenario), lattice_of(scenario));
    run.layers_laid = layers_laid_by(data);
    run.solidification = solidification_from(data, run.simulation);
    run.journal = data.journal;
    take_up_journal(console, run);
    if (!at_end_of_run(run))
        fuzz::step(console, run);
}

struct Bench {
    fuzz::Scratch scratch;
    ConsoleHost host = fuzz::small_host();
    ConsoleState console{host};
    std::string good;

    Bench() {
        H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
        Run run = fuzz::start_small();
        for (int n = 0; n < 3; ++n)
            fuzz::step(console, run);
        run.journal = "at step 0 t=0: set laser.red.power 20\nat step 0 t=0: at 4e-05 s off red\n";
        balance(run.simulation);
        const fs::path path = scratch.path() / "good.h5";
        write_checkpoint(path, checkpoint_of(run, host.scenario));
        std::ifstream stream(path, std::ios::binary);
        good.assign(std::istreambuf_iterator<char>(stream), {});
        take_up(read_checkpoint(path), console); // or nothing would be tried beyond reading
    }
};

} // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static Bench bench;
    if (size == 0)
        return 0;
    fs::path path;
    if (data[0] == 0) {
        path = bench.scratch.file("a.h5", fuzz::text_of(data + 1, size - 1));
    } else {
        path = bench.scratch.file("a.h5", bench.good);
        fuzz::Bytes bytes(data + 1, size - 1);
        change(path, bytes);
        seal_checkpoint(path);
    }
    CheckpointData checkpoint;
    if (!fuzz::is_taken<CheckpointError, std::system_error>([&] { checkpoint = read_checkpoint(path); }))
        return 0;
    fuzz::renew(bench.console, bench.host);
    fuzz::is_taken<std::runtime_error, std::invalid_argument, std::out_of_range>(
        [&] { take_up(checkpoint, bench.console); });
    return 0;
}
