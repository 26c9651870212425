#include "meltscope/io/atomic_file.hpp"
#include "meltscope/io/checkpoint.hpp"

#include "checkpoint_layout.hpp"
#include "checkpoint_seal.hpp"
#include "checkpoint_sink.hpp"
#include "posix_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace meltscope {

namespace {

constexpr std::string_view cannot_write = "cannot write checkpoint";
using Dims = std::vector<hsize_t>;

void require(bool fits, const std::filesystem::path& path, const std::string& problem) {
    if (!fits)
        throw CheckpointError(fmt::format("{} {}: {}", cannot_write, path.string(), problem));
}

void require_new_name(std::set<std::string, std::less<>>& used, const std::string& name,
                      std::string_view where, const std::filesystem::path& path) {
    require(!name.empty() && name != "." &&
                name.find_first_of(std::string_view("/\0", 2)) == std::string::npos,
            path,
            fmt::format("\"{}\" is no name for something in {}: it must not be empty or hold a slash", name,
                        where));
    require(used.insert(name).second, path, fmt::format("\"{}\" is twice in {}", name, where));
}

void require_consistent_particles(const CheckpointParticles& particles, const std::filesystem::path& path) {
    const std::size_t count = particles.id.size();
    const auto require_size = [&](std::string_view name, std::size_t size, std::size_t expected) {
        require(size == expected, path, fmt::format("{} has {} values for {} particles", name, size, count));
    };
    require_size("position", particles.position.size(), 3 * count);
    require_size("mass", particles.mass.size(), count);
    require_size("volume", particles.volume.size(), count);
    require_size("specific_energy", particles.specific_energy.size(), count);
    require_size("material", particles.material.size(), count);
    std::set<std::string, std::less<>> used(particle_array_names.begin(), particle_array_names.end());
    for (const auto& [name, values] : particles.extra) {
        require_new_name(used, name, "/particles", path);
        const bool is_whole = count == 0 ? values.empty() : !values.empty() && values.size() % count == 0;
        require(is_whole, path, fmt::format("{} has {} values for {} particles", name, values.size(), count));
    }
}

void require_consistent_grid(const std::vector<CheckpointGridArray>& grid,
                             const std::filesystem::path& path) {
    std::set<std::string, std::less<>> used;
    for (const auto& array : grid) {
        require_new_name(used, array.name, "/grid", path);
        std::uint64_t product = 1;
        for (const auto dim : array.dims)
            product *= dim;
        require(
            !array.dims.empty() && array.dims.size() <= H5S_MAX_RANK && product == array.values.size(), path,
            fmt::format("{} has {} values, its dims ask for {}", array.name, array.values.size(), product));
    }
}

void require_consistent(const CheckpointData& data, const std::filesystem::path& path) {
    require(
        data.schema_version == checkpoint_schema_version, path,
        fmt::format("schema {} cannot be written, only {}", data.schema_version, checkpoint_schema_version));
    require_consistent_particles(data.particles, path);
    require_consistent_grid(data.grid, path);
    std::set<std::string, std::less<>> used;
    for (const auto& entry : data.ledger)
        require_new_name(used, entry.first, "/ledger", path);
    for (const auto* text : {&data.scenario, &data.steering, &data.journal})
        require(text->find('\0') == std::string::npos, path, "a text holds a NUL character");
}

/// Chunks of about 64 k elements that run along the fastest axes.
Dims chunk_dims(const Dims& dims) {
    Dims chunk(dims.size(), 1);
    hsize_t room = 1 << 16;
    for (std::size_t axis = dims.size(); axis-- > 0;) {
        chunk[axis] = std::clamp<hsize_t>(dims[axis], 1, room);
        room = std::max<hsize_t>(1, room / chunk[axis]);
    }
    return chunk;
}

void require_all_written(const CheckpointSink& sink, const std::filesystem::path& path) {
    if (sink.error_number != 0)
        throw_file_error(cannot_write, path, sink.error_number);
}

/// Writes the parts of one open file; each member throws CheckpointError.
class Writer {
  public:
    Writer(const Hdf5Handle& file, const CheckpointSink& sink, const std::filesystem::path& path)
        : file_(file), sink_(sink), path_(path) {}

    void group(const char* name) const {
        take(H5Gcreate2(file_, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
    }

    void attribute(const char* object, const char* name, hid_t file_type, hid_t memory_type,
                   const void* value) const {
        const auto owner = take(H5Oopen(file_, object, H5P_DEFAULT), H5Oclose);
        const auto space = take(H5Screate(H5S_SCALAR), H5Sclose);
        const auto attribute =
            take(H5Acreate2(owner, name, file_type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
        if (H5Awrite(attribute, memory_type, value) < 0)
            throw_hdf5_error(cannot_write, path_);
    }

    void array(const std::string& name, const Dims& dims, hid_t file_type, hid_t memory_type,
               const void* values) const {
        const auto properties = take(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
        bool ok = H5Pset_obj_track_times(properties, false) >= 0; // equal data make equal bytes
        const bool is_empty = std::find(dims.begin(), dims.end(), 0) != dims.end();
        if (!is_empty) { // HDF5 has no chunks of an empty array
            ok = ok && H5Pset_chunk(properties, static_cast<int>(dims.size()), chunk_dims(dims).data()) >= 0;
            ok = ok && H5Pset_fletcher32(properties) >= 0;
        }
        if (!ok)
            throw_hdf5_error(cannot_write, path_);
        const auto space =
            take(H5Screate_simple(static_cast<int>(dims.size()), dims.data(), nullptr), H5Sclose);
        const auto set =
            take(H5Dcreate2(file_, name.c_str(), file_type, space, H5P_DEFAULT, properties, H5P_DEFAULT),
                 H5Dclose);
        if (!is_empty && H5Dwrite(set, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0)
            throw_hdf5_error(cannot_write, path_);
        require_all_written(sink_, path_); // a full disk need not be found out array by array
    }

    void doubles(const std::string& name, const Dims& dims, const std::vector<double>& values) const {
        array(name, dims, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, values.data());
    }

    /// A text is an array of one string of fixed length, since only arrays have checksums.
    void text(const std::string& name, const std::string& value) const {
        const auto type = take(H5Tcopy(H5T_C_S1), H5Tclose);
        if (H5Tset_size(type, std::max<std::size_t>(1, value.size())) < 0 ||
            H5Tset_strpad(type, H5T_STR_NULLPAD) < 0 || H5Tset_cset(type, H5T_CSET_UTF8) < 0)
            throw_hdf5_error(cannot_write, path_);
        array(name, {1}, type, type, value.c_str());
    }

  private:
    Hdf5Handle take(hid_t id, Hdf5Handle::Close close) const { return own(id, close, cannot_write, path_); }

    const Hdf5Handle& file_;
    const CheckpointSink& sink_;
    const std::filesystem::path& path_;
};

void write_particles(const Writer& writer, const CheckpointParticles& particles) {
    const hsize_t count = particles.id.size();
    writer.group("/particles");
    writer.doubles("/particles/position", {count, 3}, particles.position);
    writer.doubles("/particles/mass", {count}, particles.mass);
    writer.doubles("/particles/volume", {count}, particles.volume);
    writer.doubles("/particles/specific_energy", {count}, particles.specific_energy);
    writer.array("/particles/id", {count}, H5T_STD_I64LE, H5T_NATIVE_INT64, particles.id.data());
    writer.array("/particles/material", {count}, H5T_STD_I32LE, H5T_NATIVE_INT32, particles.material.data());
    for (const auto& [name, values] : particles.extra) {
        const hsize_t columns = count == 0 ? 1 : values.size() / count;
        writer.doubles("/particles/" + name, columns == 1 ? Dims{count} : Dims{count, columns}, values);
    }
}

void write_contents(const Writer& writer, const CheckpointData& data) {
    const std::int64_t schema = data.schema_version;
    writer.attribute("/", "schema_version", H5T_STD_I64LE, H5T_NATIVE_INT64, &schema);
    writer.attribute("/", "time", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, &data.time);
    writer.attribute("/", "step", H5T_STD_I64LE, H5T_NATIVE_INT64, &data.step);
    writer.attribute("/", "dt", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, &data.dt);
    write_particles(writer, data.particles);
    writer.group("/grid");
    for (const auto& array : data.grid)
        writer.doubles("/grid/" + array.name, Dims(array.dims.begin(), array.dims.end()), array.values);
    writer.text("/scenario", data.scenario);
    writer.group("/steering");
    writer.text("/steering/parameters", data.steering);
    writer.text("/steering/journal", data.journal);
    writer.group("/ledger");
    for (const auto& [name, value] : data.ledger)
        writer.attribute("/ledger", name.c_str(), H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, &value);
}

Hdf5Handle create_file(CheckpointSink& sink, const std::filesystem::path& path) {
    const auto creation = own(H5Pcreate(H5P_FILE_CREATE), H5Pclose, cannot_write, path);
    if (H5Pset_userblock(creation, seal_size) < 0 || H5Pset_obj_track_times(creation, false) < 0)
        throw_hdf5_error(cannot_write, path);
    const auto access = own(make_sink_access(sink), cannot_write, path);
    return own(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation, access), H5Fclose, cannot_write, path);
}

} // namespace

void write_checkpoint(const std::filesystem::path& path, const CheckpointData& data) {
    require_consistent(data, path);
    const Hdf5Silence silence;
    AtomicFile target(path);
    CheckpointSink sink{target.descriptor()};
    auto file = create_file(sink, path);
    write_contents(Writer(file, sink, path), data);
    if (!file.close())
        throw_hdf5_error(cannot_write, path);
    require_all_written(sink, path);
    seal_checkpoint(target.temporary_path());
    target.commit();
}

} // namespace meltscope
