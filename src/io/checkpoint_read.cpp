#include "meltscope/io/checkpoint.hpp"

#include "checkpoint_layout.hpp"
#include "checkpoint_seal.hpp"
#include "hdf5_support.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace meltscope {

namespace {

constexpr std::string_view cannot_read = "cannot read checkpoint";
using Dims = std::vector<hsize_t>;

/// Reads the parts of one open file and trusts none of it: what an array claims to hold must lie in the file,
/// which leaves no room for external, virtual, compressed or unwritten storage. Each member throws
/// CheckpointError.
class Reader {
  public:
    Reader(const Hdf5Handle& file, std::size_t file_size, const std::filesystem::path& path)
        : file_(file), budget_(file_size), path_(path) {}

    [[noreturn]] void refuse(const std::string& problem) const {
        throw CheckpointError(fmt::format("{} {}: {}", cannot_read, path_.string(), problem));
    }

    template <class Value>
    Value attribute(const char* object, const char* name, hid_t file_type, hid_t memory_type) const {
        require_own(object);
        const auto owner = take(H5Oopen(file_, object, H5P_DEFAULT), H5Oclose);
        const auto attribute = take(H5Aopen(owner, name, H5P_DEFAULT), H5Aclose);
        const auto type = take(H5Aget_type(attribute), H5Tclose);
        const auto space = take(H5Aget_space(attribute), H5Sclose);
        if (H5Tequal(type, file_type) <= 0 || H5Sget_simple_extent_type(space) != H5S_SCALAR)
            refuse(fmt::format("attribute {} of {} is not a number of the kind expected", name, object));
        Value value{};
        if (H5Aread(attribute, memory_type, &value) < 0)
            throw_hdf5_error(cannot_read, path_);
        return value;
    }

    /// Names of what a group holds, in order of name.
    std::vector<std::string> members(const char* group) const {
        require_own(group);
        const auto handle = take(H5Gopen2(file_, group, H5P_DEFAULT), H5Gclose);
        H5G_info_t info{};
        if (H5Gget_info(handle, &info) < 0)
            throw_hdf5_error(cannot_read, path_);
        std::vector<std::string> names;
        for (hsize_t n = 0; n < info.nlinks; ++n) {
            const auto length =
                H5Lget_name_by_idx(handle, ".", H5_INDEX_NAME, H5_ITER_INC, n, nullptr, 0, H5P_DEFAULT);
            if (length <= 0)
                throw_hdf5_error(cannot_read, path_);
            std::string name(static_cast<std::size_t>(length), '\0');
            H5Lget_name_by_idx(handle, ".", H5_INDEX_NAME, H5_ITER_INC, n, name.data(), name.size() + 1,
                               H5P_DEFAULT);
            names.push_back(std::move(name));
        }
        return names;
    }

    std::vector<std::pair<std::string, double>> number_attributes(const char* object) const {
        require_own(object);
        const auto owner = take(H5Oopen(file_, object, H5P_DEFAULT), H5Oclose);
        std::vector<std::string> names;
        hsize_t position = 0;
        const auto collect = [](hid_t, const char* name, const H5A_info_t*, void* list) -> herr_t {
            static_cast<std::vector<std::string>*>(list)->emplace_back(name);
            return 0;
        };
        if (H5Aiterate2(owner, H5_INDEX_NAME, H5_ITER_INC, &position, collect, &names) < 0)
            throw_hdf5_error(cannot_read, path_);
        std::vector<std::pair<std::string, double>> values;
        for (const auto& name : names)
            values.emplace_back(name,
                                attribute<double>(object, name.c_str(), H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE));
        return values;
    }

    template <class Value>
    std::vector<Value> array(const std::string& name, hid_t file_type, hid_t memory_type, Dims& dims) {
        const auto set = open_array(name);
        const auto type = take(H5Dget_type(set), H5Tclose);
        if (H5Tequal(type, file_type) <= 0)
            refuse(fmt::format("{} does not hold the type of number expected", name));
        const auto count = count_elements(set, name, sizeof(Value), dims);
        std::vector<Value> values(count);
        if (count > 0 && H5Dread(set, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
            throw_hdf5_error(cannot_read, path_);
        return values;
    }

    std::vector<double> doubles(const std::string& name, Dims& dims) {
        return array<double>(name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, dims);
    }

    std::string text(const std::string& name) {
        const auto set = open_array(name);
        const auto type = take(H5Dget_type(set), H5Tclose);
        if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) != 0 || H5Tget_size(type) == 0)
            refuse(fmt::format("{} is not a text of fixed length", name));
        Dims dims;
        if (count_elements(set, name, H5Tget_size(type), dims) != 1)
            refuse(fmt::format("{} is not one text", name));
        std::string value(H5Tget_size(type), '\0');
        if (H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, value.data()) < 0)
            throw_hdf5_error(cannot_read, path_);
        value.resize(std::min(value.size(), value.find('\0')));
        return value;
    }

  private:
    Hdf5Handle take(hid_t id, Hdf5Handle::Close close) const { return own(id, close, cannot_read, path_); }

    /// Every step of the path must lie in this file: a soft or external link could lead to another.
    void require_own(const std::string& path) const {
        for (std::size_t end = 0; end < path.size();) {
            end = std::min(path.find('/', end + 1), path.size());
            const std::string part = path.substr(0, end);
            H5L_info_t link{};
            if (part.size() < 2) // the root has no link
                continue;
            if (H5Lget_info(file_, part.c_str(), &link, H5P_DEFAULT) < 0)
                refuse(fmt::format("{} is missing", part));
            if (link.type != H5L_TYPE_HARD)
                refuse(fmt::format("{} is a link to elsewhere", part));
        }
    }

    Hdf5Handle open_array(const std::string& name) const {
        require_own(name);
        return take(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), H5Dclose);
    }

    /// Elements of an array, once it is sure that the file holds their bytes.
    std::size_t count_elements(const Hdf5Handle& set, const std::string& name, std::size_t element_size,
                               Dims& dims) {
        const auto space = take(H5Dget_space(set), H5Sclose);
        const int rank = H5Sget_simple_extent_ndims(space);
        if (H5Sget_simple_extent_type(space) != H5S_SIMPLE || rank < 1)
            refuse(fmt::format("{} is not an array", name));
        dims.resize(static_cast<std::size_t>(rank));
        H5Sget_simple_extent_dims(space, dims.data(), nullptr);
        if (std::find(dims.begin(), dims.end(), 0) != dims.end())
            return 0;
        std::size_t room = budget_ / element_size;
        std::size_t count = 1;
        for (const auto dim : dims) {
            if (dim > room)
                refuse(fmt::format("{} claims more values than the file can hold", name));
            room /= dim;
            count *= dim;
        }
        require_checksummed_chunks(set, name);
        if (H5Dget_storage_size(set) < count * element_size)
            refuse(fmt::format("{} lacks some of its values", name));
        budget_ -= count * element_size;
        return count;
    }

    void require_checksummed_chunks(const Hdf5Handle& set, const std::string& name) const {
        const auto properties = take(H5Dget_create_plist(set), H5Pclose);
        bool is_expected = H5Pget_layout(properties) == H5D_CHUNKED && H5Pget_nfilters(properties) == 1;
        if (is_expected) {
            unsigned flags = 0;
            unsigned config = 0;
            std::size_t parameters = 0;
            is_expected = H5Pget_filter2(properties, 0, &flags, &parameters, nullptr, 0, nullptr, &config) ==
                          H5Z_FILTER_FLETCHER32;
        }
        if (!is_expected)
            refuse(fmt::format("{} is not stored in chunks with Fletcher32", name));
    }

    const Hdf5Handle& file_;
    std::size_t budget_; // bytes of the file that no array has claimed yet
    const std::filesystem::path& path_;
};

CheckpointParticles read_particles(Reader& reader) {
    CheckpointParticles particles;
    Dims dims;
    particles.id = reader.array<std::int64_t>("/particles/id", H5T_STD_I64LE, H5T_NATIVE_INT64, dims);
    const Dims one_each{particles.id.size()};
    const Dims three_each{particles.id.size(), 3};
    const auto require_dims = [&](const char* name, const Dims& expected) {
        if (dims != expected)
            reader.refuse(fmt::format("/particles/{} does not fit {} particles", name, one_each[0]));
    };
    require_dims("id", one_each);
    const auto scalar = [&](const char* name) {
        auto values = reader.doubles(fmt::format("/particles/{}", name), dims);
        require_dims(name, one_each);
        return values;
    };
    particles.position = reader.doubles("/particles/position", dims);
    require_dims("position", three_each);
    particles.mass = scalar("mass");
    particles.volume = scalar("volume");
    particles.specific_energy = scalar("specific_energy");
    particles.material =
        reader.array<std::int32_t>("/particles/material", H5T_STD_I32LE, H5T_NATIVE_INT32, dims);
    require_dims("material", one_each);
    for (auto& name : reader.members("/particles")) {
        if (std::find(particle_array_names.begin(), particle_array_names.end(), name) !=
            particle_array_names.end())
            continue;
        auto values = reader.doubles("/particles/" + name, dims);
        if (dims[0] != one_each[0] || dims.size() > 2)
            reader.refuse(fmt::format("/particles/{} does not fit {} particles", name, one_each[0]));
        particles.extra.emplace_back(std::move(name), std::move(values));
    }
    return particles;
}

std::vector<CheckpointGridArray> read_grid(Reader& reader) {
    std::vector<CheckpointGridArray> grid;
    for (auto& name : reader.members("/grid")) {
        Dims dims;
        auto values = reader.doubles("/grid/" + name, dims);
        grid.push_back({std::move(name), {dims.begin(), dims.end()}, std::move(values)});
    }
    return grid;
}

Hdf5Handle open_sealed_file(const std::filesystem::path& path) {
    const auto access = own(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, cannot_read, path);
    if (H5Pset_file_locking(access, false, true) < 0) // finished files do not change any more
        throw_hdf5_error(cannot_read, path);
    return own(H5Fopen(path.c_str(), H5F_ACC_RDONLY, access), H5Fclose, cannot_read, path);
}

} // namespace

CheckpointData read_checkpoint(const std::filesystem::path& path) {
    const auto file_size = verify_seal(path);
    const Hdf5Silence silence;
    const auto file = open_sealed_file(path);
    Reader reader(file, file_size, path);
    CheckpointData data;
    const auto schema =
        reader.attribute<std::int64_t>("/", "schema_version", H5T_STD_I64LE, H5T_NATIVE_INT64);
    if (schema != checkpoint_schema_version)
        reader.refuse(fmt::format("schema {} inside, {} outside", schema, checkpoint_schema_version));
    data.time = reader.attribute<double>("/", "time", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE);
    data.step = reader.attribute<std::int64_t>("/", "step", H5T_STD_I64LE, H5T_NATIVE_INT64);
    data.dt = reader.attribute<double>("/", "dt", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE);
    data.particles = read_particles(reader);
    data.grid = read_grid(reader);
    data.scenario = reader.text("/scenario");
    data.steering = reader.text("/steering/parameters");
    data.journal = reader.text("/steering/journal");
    data.ledger = reader.number_attributes("/ledger");
    return data;
}

} // namespace meltscope
