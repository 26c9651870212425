#pragma once

#include "meltscope/console/console.hpp"

#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>

/// Consoles attached to a run under way through a Unix socket in its folder.
///
/// The client sends `meltscope 1 write|watch prompt|script`, then lines of commands. The server sends lines
/// whose first letter says what they are: `w` what the run has to say first, `r` a line of a reply, `d` the
/// end of the reply to a line of this client, done, `f` the same, failed, `n` news, `q` the last line.
/// Prompts also get `c`, a kind of names and those names, for completion, and `s`, where the run is.
namespace meltscope {

/// A console that cannot be attached; the message says why.
struct AttachError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Longest line that is taken from a client; whoever sends a longer one is cut off.
inline constexpr std::size_t longest_attached_line = 4096;
/// What may wait to be read by a client; whoever lets more come together is cut off.
inline constexpr std::size_t most_unread_bytes = 256 * 1024;
inline constexpr std::size_t most_attached = 16;

/// Listens at FOLDER/console.sock (mode 0600) and lets clients of the same user speak to the console: the
/// first that wants to may change the run, the others watch. Works on a thread of its own; the solver only
/// ever puts text into bounded buffers.
class AttachServer {
  public:
    /// Throws AttachError if the folder is not the user's own or the socket cannot be made. An old socket is
    /// replaced.
    AttachServer(const std::filesystem::path& folder, Console& console);
    /// Says goodbye and removes the socket.
    ~AttachServer();
    AttachServer(const AttachServer&) = delete;
    AttachServer& operator=(const AttachServer&) = delete;

  private:
    class Worker;
    std::unique_ptr<Worker> worker_;
};

/// Connects standard input and output with the run in `folder` until one of them ends. Returns true unless a
/// command of a script or pipe failed. Throws AttachError if there is no such run, it is another user's, or
/// its program is gone.
bool attach(const std::filesystem::path& folder, bool watch);

} // namespace meltscope
