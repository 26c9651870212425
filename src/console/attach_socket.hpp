#pragma once

#include "meltscope/console/attach.hpp"

#include <fmt/format.h>

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>
#include <utility>

namespace meltscope {

/// A descriptor that is closed when it goes.
class Descriptor {
  public:
    explicit Descriptor(int value = -1) : value_(value) {}
    ~Descriptor() {
        if (value_ >= 0)
            ::close(value_);
    }
    Descriptor(Descriptor&& other) noexcept : value_(std::exchange(other.value_, -1)) {}
    Descriptor& operator=(Descriptor&& other) noexcept {
        std::swap(value_, other.value_);
        return *this;
    }
    int get() const { return value_; }
    explicit operator bool() const { return value_ >= 0; }

  private:
    int value_;
};

inline constexpr const char* socket_name = "console.sock";
inline constexpr const char* socket_in_the_making = "console.sock.part";

/// The folder, open, and belonging to this user. Throws AttachError.
inline Descriptor open_own_folder(const std::filesystem::path& folder) {
    Descriptor opened(::open(folder.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
    struct stat status {};
    if (!opened || fstat(opened.get(), &status) != 0)
        throw AttachError(fmt::format("{}: {}", folder.string(), std::strerror(errno)));
    if (status.st_uid != geteuid())
        throw AttachError(fmt::format("{} belongs to another user", folder.string()));
    return opened;
}

/// The socket's address by way of the open folder, so that its length does not matter (a sun_path has 108
/// bytes).
inline sockaddr_un address_in(const Descriptor& folder, const char* name = socket_name) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    const std::string path = fmt::format("/proc/self/fd/{}/{}", folder.get(), name);
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    return address;
}

/// The user at the other end; none can be told: -1.
inline uid_t peer_user(int socket) {
    ucred peer{};
    socklen_t size = sizeof peer;
    return getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &peer, &size) == 0 ? peer.uid : uid_t(-1);
}

} // namespace meltscope
