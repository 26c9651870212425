#pragma once

namespace meltscope {

/// Makes SIGINT, SIGTERM and, unless it is ignored (nohup), SIGHUP ask for a stop and SIGUSR1 for a
/// checkpoint, to be noticed at the next step. A second SIGINT or SIGTERM ends the program at once. SIGPIPE
/// is ignored.
void watch_signals();

/// The signal that asked for a stop; 0 if none has.
int stop_signal();

/// True once for every time that a checkpoint was asked for since the last call.
bool take_checkpoint_request();

} // namespace meltscope
