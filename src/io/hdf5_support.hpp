#pragma once

#include <hdf5.h>

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

namespace meltscope {

/// An HDF5 identifier that closes itself.
class Hdf5Handle {
  public:
    using Close = herr_t (*)(hid_t);
    Hdf5Handle(hid_t id, Close closer) : id_(id), close_(closer) {}
    Hdf5Handle(Hdf5Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
    Hdf5Handle& operator=(Hdf5Handle&&) = delete;
    ~Hdf5Handle() { close(); }

    operator hid_t() const { return id_; } // NOLINT(google-explicit-constructor): HDF5 takes it everywhere

    /// True if closing went well, or there was nothing to close.
    bool close() { return id_ < 0 || close_(std::exchange(id_, -1)) >= 0; }

  private:
    hid_t id_;
    Close close_;
};

/// Keeps HDF5 from printing its errors while it lives.
class Hdf5Silence {
  public:
    Hdf5Silence();
    ~Hdf5Silence();
    Hdf5Silence(const Hdf5Silence&) = delete;
    Hdf5Silence& operator=(const Hdf5Silence&) = delete;

  private:
    H5E_auto2_t report_ = nullptr;
    void* report_data_ = nullptr;
};

/// The innermost reason on HDF5's error stack.
std::string hdf5_reason();

/// Throws CheckpointError "WHAT FILE: reason".
[[noreturn]] void throw_hdf5_error(std::string_view what, const std::filesystem::path& path);

/// Passes a valid identifier on; throws by throw_hdf5_error for another.
Hdf5Handle own(Hdf5Handle handle, std::string_view what, const std::filesystem::path& path);

/// Takes what an H5?open or H5?create gave; throws by throw_hdf5_error if it is not valid.
Hdf5Handle own(hid_t id, Hdf5Handle::Close close, std::string_view what, const std::filesystem::path& path);

} // namespace meltscope
