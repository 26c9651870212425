#include "hdf5_support.hpp"

#include "meltscope/io/checkpoint.hpp"

#include <fmt/format.h>

namespace meltscope {

namespace {

herr_t take_first_description(unsigned depth, const H5E_error2_t* error, void* reason) {
    if (depth == 0 && error->desc != nullptr)
        *static_cast<std::string*>(reason) = error->desc;
    return 0;
}

/// HDF5 writes "..., errno = 28, error message = 'No space left on device', buf = 0x...": the quoted part.
std::string words_of_system(const std::string& description) {
    constexpr std::string_view key = "error message = '";
    const auto start = description.find(key);
    if (start == std::string::npos)
        return description;
    const auto end = description.find('\'', start + key.size());
    return description.substr(start + key.size(), end - start - key.size());
}

} // namespace

Hdf5Silence::Hdf5Silence() {
    H5Eget_auto2(H5E_DEFAULT, &report_, &report_data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

Hdf5Silence::~Hdf5Silence() {
    H5Eset_auto2(H5E_DEFAULT, report_, report_data_);
}

std::string hdf5_reason() {
    std::string reason;
    H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, take_first_description, &reason);
    return reason.empty() ? "HDF5 gives no reason" : words_of_system(reason);
}

void throw_hdf5_error(std::string_view what, const std::filesystem::path& path) {
    throw CheckpointError(fmt::format("{} {}: {}", what, path.string(), hdf5_reason()));
}

Hdf5Handle own(hid_t id, Hdf5Handle::Close close, std::string_view what, const std::filesystem::path& path) {
    if (id < 0)
        throw_hdf5_error(what, path);
    return {id, close};
}

} // namespace meltscope
