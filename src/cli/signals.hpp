#pragma once

namespace hyperiso::cli {

// From now on Ctrl-C, a termination and a hang-up end the program at once, wherever it is, with the exit code
// 128 + signal that shells expect, and leave no unfinished file behind. A broken pipe is no signal but a
// failed write.
void install_signal_handlers();

} // namespace hyperiso::cli
