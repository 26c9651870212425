#include "checkpoint_sink.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>
#include <unistd.h>

namespace meltscope {

namespace {

/// What HDF5 copies into the access properties.
struct SinkReference {
    CheckpointSink* sink;
};

/// HDF5's open file; `base` comes first, as HDF5 knows no more than that.
struct SinkFile {
    H5FD_t base{};
    CheckpointSink* sink = nullptr;
};

CheckpointSink& sink_of(H5FD_t* file) {
    return *reinterpret_cast<SinkFile*>(file)->sink;
}
const CheckpointSink& sink_of(const H5FD_t* file) {
    return *reinterpret_cast<const SinkFile*>(file)->sink;
}

H5FD_t* open_sink(const char*, unsigned, hid_t access, haddr_t) {
    const auto* reference = static_cast<const SinkReference*>(H5Pget_driver_info(access));
    if (reference == nullptr)
        return nullptr;
    auto* file = new (std::nothrow) SinkFile;
    if (file != nullptr)
        file->sink = reference->sink;
    return reinterpret_cast<H5FD_t*>(file);
}

herr_t close_sink(H5FD_t* file) {
    delete reinterpret_cast<SinkFile*>(file);
    return 0;
}

herr_t query_features(const H5FD_t*, unsigned long* features) {
    *features = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
                H5FD_FEAT_AGGREGATE_SMALLDATA;
    return 0;
}

haddr_t get_allocated(const H5FD_t* file, H5FD_mem_t) {
    return sink_of(file).allocated;
}

herr_t set_allocated(H5FD_t* file, H5FD_mem_t, haddr_t address) {
    sink_of(file).allocated = address;
    return 0;
}

haddr_t get_length(const H5FD_t* file, H5FD_mem_t) {
    return sink_of(file).length;
}

/// HDF5 seldom reads what it has written; what never came to the file reads as zeros.
herr_t read_sink(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t address, std::size_t size, void* buffer) {
    auto* bytes = static_cast<char*>(buffer);
    while (size > 0) {
        const ssize_t count = ::pread(sink_of(file).descriptor, bytes, size, static_cast<off_t>(address));
        if (count < 0 && errno == EINTR)
            continue;
        if (count <= 0) {
            std::memset(bytes, 0, size);
            return 0;
        }
        bytes += count;
        address += static_cast<haddr_t>(count);
        size -= static_cast<std::size_t>(count);
    }
    return 0;
}

herr_t write_sink(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t address, std::size_t size, const void* buffer) {
    auto& sink = sink_of(file);
    const auto* bytes = static_cast<const char*>(buffer);
    while (size > 0 && sink.error_number == 0) {
        const ssize_t count = ::pwrite(sink.descriptor, bytes, size, static_cast<off_t>(address));
        if (count < 0) {
            if (errno != EINTR)
                sink.error_number = errno;
            continue;
        }
        bytes += count;
        address += static_cast<haddr_t>(count);
        size -= static_cast<std::size_t>(count);
    }
    sink.length = std::max(sink.length, address + size); // as HDF5 believes
    return 0;
}

herr_t truncate_sink(H5FD_t* file, hid_t, hbool_t) {
    auto& sink = sink_of(file);
    if (sink.error_number == 0 && ::ftruncate(sink.descriptor, static_cast<off_t>(sink.allocated)) != 0)
        sink.error_number = errno;
    sink.length = sink.allocated;
    return 0;
}

H5FD_class_t sink_class() {
    H5FD_class_t driver{};
    driver.name = "meltscope_checkpoint_sink";
    driver.maxaddr = static_cast<haddr_t>(std::numeric_limits<off_t>::max());
    driver.fc_degree = H5F_CLOSE_STRONG;
    driver.fapl_size = sizeof(SinkReference);
    driver.open = open_sink;
    driver.close = close_sink;
    driver.query = query_features;
    driver.get_eoa = get_allocated;
    driver.set_eoa = set_allocated;
    driver.get_eof = get_length;
    driver.read = read_sink;
    driver.write = write_sink;
    driver.truncate = truncate_sink;
    constexpr H5FD_mem_t free_lists[] = H5FD_FLMAP_DICHOTOMY;
    std::copy(std::begin(free_lists), std::end(free_lists), driver.fl_map);
    return driver;
}

} // namespace

Hdf5Handle make_sink_access(CheckpointSink& sink) {
    const auto driver_class = sink_class();
    sink.driver.emplace(H5FDregister(&driver_class), H5FDunregister);
    Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    const SinkReference reference{&sink};
    // Nobody else can reach the file: it needs no lock.
    if (H5Pset_driver(access, *sink.driver, &reference) < 0 || H5Pset_file_locking(access, false, true) < 0)
        return {-1, H5Pclose};
    return access;
}

} // namespace meltscope
