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
    return reason.empty() ? "HDF5 gives no reason" : reason;
}

void throw_hdf5_error(std::string_view what, const std::filesystem::path& path) {
    throw CheckpointError(fmt::format("{} {}: {}", what, path.string(), hdf5_reason()));
}

Hdf5Handle own(Hdf5Handle handle, std::string_view what, const std::filesystem::path& path) {
    if (handle < 0)
        throw_hdf5_error(what, path);
    return handle;
}

Hdf5Handle own(hid_t id, Hdf5Handle::Close close, std::string_view what, const std::filesystem::path& path) {
    return own(Hdf5Handle(id, close), what, path);
}

} // namespace meltscope
